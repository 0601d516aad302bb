# The extension module manyhands._core, its type stubs, and the files that go into the wheel with it.
find_package(Python 3.10 REQUIRED COMPONENTS Interpreter Development.Module)
execute_process(COMMAND "${Python_EXECUTABLE}" -m nanobind --cmake_dir OUTPUT_STRIP_TRAILING_WHITESPACE
                OUTPUT_VARIABLE nanobind_ROOT RESULT_VARIABLE nanobind_result ERROR_QUIET)
if(nanobind_result)
  message(FATAL_ERROR "nanobind is missing. Install it: ${Python_EXECUTABLE} -m pip install nanobind==3.1.0")
endif()
find_package(nanobind CONFIG REQUIRED)

file(GLOB_RECURSE binding_sources CONFIGURE_DEPENDS bindings/*.cpp)
if(binding_sources)
  nanobind_add_module(_core NB_STATIC NB_DOMAIN manyhands ${binding_sources})
  # In a package of that name, so that the stubs refer to each other as manyhands._core. With its empty __init__ it comes
  # before an older manyhands that is installed already.
  file(WRITE "${PROJECT_BINARY_DIR}/package/manyhands/__init__.py" "")
  set_target_properties(_core PROPERTIES LIBRARY_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/package/manyhands")
  target_include_directories(_core SYSTEM PRIVATE "${NB_DIR}/include")
  target_link_libraries(_core PRIVATE manyhands_learn manyhands_options)
  manyhands_unite(_core)
  set_target_properties(nanobind-static PROPERTIES UNITY_BUILD ${MANYHANDS_UNITY} UNITY_BUILD_BATCH_SIZE 0)
  install(TARGETS _core LIBRARY DESTINATION manyhands COMPONENT python EXCLUDE_FROM_ALL)

  nanobind_add_stub(core_stub MODULE manyhands._core RECURSIVE OUTPUT_PATH "${PROJECT_BINARY_DIR}/stubs"
                    MARKER_FILE "${PROJECT_BINARY_DIR}/stubs.stamp"
                    PYTHON_PATH "${PROJECT_BINARY_DIR}/package" DEPENDS _core
                    PATTERN_FILE "${PROJECT_SOURCE_DIR}/cmake/stubs.pattern")
  install(DIRECTORY "${PROJECT_BINARY_DIR}/stubs/" DESTINATION manyhands COMPONENT python EXCLUDE_FROM_ALL
          FILES_MATCHING PATTERN "*.pyi")
endif()
install(DIRECTORY assets DESTINATION manyhands COMPONENT python EXCLUDE_FROM_ALL)
