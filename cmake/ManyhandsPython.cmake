# The extension module manyhands._core, its type stubs, and the files that go into the wheel with it.
find_package(Python 3.10 REQUIRED COMPONENTS Interpreter Development.Module ${SKBUILD_SABI_COMPONENT})
execute_process(COMMAND "${Python_EXECUTABLE}" -m nanobind --cmake_dir OUTPUT_STRIP_TRAILING_WHITESPACE
                OUTPUT_VARIABLE nanobind_ROOT RESULT_VARIABLE nanobind_result ERROR_QUIET)
if(nanobind_result)
  message(FATAL_ERROR "nanobind is missing. Install it: ${Python_EXECUTABLE} -m pip install nanobind==3.1.0")
endif()
find_package(nanobind CONFIG REQUIRED)

# An installation may have _core for several instruction sets, each in a folder of its own: manyhands/isa.py chooses.
set(core_folder manyhands)
if(NOT MANYHANDS_ISA STREQUAL "native")
  set(core_folder manyhands/${MANYHANDS_ISA})
endif()

file(GLOB_RECURSE binding_sources CONFIGURE_DEPENDS bindings/*.cpp)
list(FILTER binding_sources EXCLUDE REGEX "/bindings/processor/")
nanobind_add_module(_core NB_STATIC STABLE_ABI NB_DOMAIN manyhands ${binding_sources})
# In a package of that name, so that the stubs refer to each other as manyhands._core. With its empty __init__ it comes
# before an older manyhands that is installed already.
set(package "${PROJECT_BINARY_DIR}/package/manyhands")
file(WRITE "${package}/__init__.py" "")
target_include_directories(_core SYSTEM PRIVATE "${NB_DIR}/include")
target_link_libraries(_core PRIVATE manyhands_learn manyhands_options)
target_compile_definitions(_core PRIVATE MANYHANDS_ISA="${MANYHANDS_ISA}")
manyhands_unite(_core)
install(TARGETS _core LIBRARY DESTINATION ${core_folder} COMPONENT python EXCLUDE_FROM_ALL)

# Without the flags of the instruction set.
nanobind_add_module(_processor NB_STATIC STABLE_ABI NB_DOMAIN manyhands bindings/processor/module.cpp)
target_include_directories(_processor SYSTEM PRIVATE "${NB_DIR}/include")
target_compile_features(_processor PRIVATE cxx_std_20)
install(TARGETS _processor LIBRARY DESTINATION manyhands COMPONENT python EXCLUDE_FROM_ALL)

foreach(module _core _processor)
  set_target_properties(${module} PROPERTIES LIBRARY_OUTPUT_DIRECTORY "${package}")
  nanobind_add_stub(stub${module} MODULE manyhands.${module} RECURSIVE OUTPUT_PATH "${PROJECT_BINARY_DIR}/stubs"
                    MARKER_FILE "${PROJECT_BINARY_DIR}/stub${module}.stamp"
                    PYTHON_PATH "${PROJECT_BINARY_DIR}/package" DEPENDS ${module}
                    PATTERN_FILE "${PROJECT_SOURCE_DIR}/cmake/stubs.pattern")
endforeach()
foreach(library nanobind-static nanobind-static-abi3)
  if(TARGET ${library})
    # nanobind's headers print, and leave it to others to include what they need for it: libc++ does not.
    target_compile_options(${library} PUBLIC "SHELL:-include cstdio")
    set_target_properties(${library} PROPERTIES UNITY_BUILD ${MANYHANDS_UNITY} UNITY_BUILD_BATCH_SIZE 0)
  endif()
endforeach()
install(DIRECTORY "${PROJECT_BINARY_DIR}/stubs/" DESTINATION manyhands COMPONENT python EXCLUDE_FROM_ALL
        FILES_MATCHING PATTERN "*.pyi")
install(DIRECTORY assets DESTINATION manyhands COMPONENT python EXCLUDE_FROM_ALL)
