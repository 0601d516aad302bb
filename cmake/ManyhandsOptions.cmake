# Options, compiler flags and the helpers that give every target the same ones.
set(developing ${PROJECT_IS_TOP_LEVEL})
if(SKBUILD)  # a wheel is being made
  set(developing OFF)
endif()
option(MANYHANDS_TESTS "Build the C++ tests" ${developing})
option(MANYHANDS_BENCHMARKS "Build the benchmarks" ${developing})
option(MANYHANDS_EXAMPLES "Build the C++ examples" ${developing})
option(MANYHANDS_INSTALL "Install the C++ package" ${developing})
option(MANYHANDS_PYTHON "Build the Python extension" OFF)

set(MANYHANDS_ISA native CACHE STRING "Instruction set the library is built for")
set_property(CACHE MANYHANDS_ISA PROPERTY STRINGS native x86-64-v3 x86-64-v4 armv8)
set(in_checkout OFF)
if(PROJECT_IS_TOP_LEVEL AND EXISTS "${PROJECT_SOURCE_DIR}/.git")
  set(in_checkout ON)
endif()
option(MANYHANDS_WERROR "Warnings are errors: for who works on the library, not for who uses it" ${in_checkout})
option(MANYHANDS_UNITY "Compile the files of a folder together: half the work of a first build, more of a second" OFF)
set(MANYHANDS_TEST_FILES "" CACHE STRING "Regular expression: only the C++ tests in these files")
set(MANYHANDS_TEST_FILES_LEFT_OUT "" CACHE STRING "Regular expression: not the C++ tests in these files")
set(MANYHANDS_SANITIZE "" CACHE STRING "Sanitizers for every target, for example address,undefined")

if(PROJECT_IS_TOP_LEVEL)
  if(NOT CMAKE_BUILD_TYPE)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
  endif()
  set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
  find_program(CCACHE_PROGRAM ccache)
  if(CCACHE_PROGRAM AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER "${CCACHE_PROGRAM}")
  endif()
endif()

set(isa_flags_native -march=native)
set(isa_flags_x86-64-v3 -march=x86-64-v3)
set(isa_flags_x86-64-v4 -march=x86-64-v4)
set(isa_flags_armv8 -march=armv8-a)
if(NOT DEFINED isa_flags_${MANYHANDS_ISA})
  message(FATAL_ERROR "MANYHANDS_ISA=${MANYHANDS_ISA} is not known: use native, x86-64-v3, x86-64-v4 or armv8")
endif()

# What every program that includes our headers must be compiled with: the lane width follows from the instruction set,
# and the promise of equal bits from the rounding flags. Exported with the library.
add_library(manyhands_flags INTERFACE)
target_compile_features(manyhands_flags INTERFACE cxx_std_20)
target_compile_options(manyhands_flags INTERFACE ${isa_flags_${MANYHANDS_ISA}} -ffp-contract=off -fno-math-errno)

# The lane width of that instruction set, as in math/instantiate.h.
include(CheckCXXSymbolExists)
set(CMAKE_REQUIRED_FLAGS ${isa_flags_${MANYHANDS_ISA}})
check_cxx_symbol_exists(__AVX512F__ "cstddef" MANYHANDS_AVX512)
check_cxx_symbol_exists(__AVX__ "cstddef" MANYHANDS_AVX)
unset(CMAKE_REQUIRED_FLAGS)
if(MANYHANDS_AVX512)
  set(native_lanes 16)
elseif(MANYHANDS_AVX)
  set(native_lanes 8)
else()
  set(native_lanes 4)
endif()

# What our own targets are compiled with besides.
add_library(manyhands_options INTERFACE)
target_link_libraries(manyhands_options INTERFACE manyhands_flags)
target_compile_options(manyhands_options INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow
                                                   $<$<BOOL:${MANYHANDS_WERROR}>:-Werror>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Lanes wider than the processor's registers go to inlined functions only: no calling convention is at stake.
  target_compile_options(manyhands_options INTERFACE -Wno-psabi)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # False alarms on "text" + std::string (GCC bug 105651).
  target_compile_options(manyhands_options INTERFACE -Wno-restrict)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  # Masks of one lane are booleans, and kernels join them as those of many lanes: with & and |, which do not branch.
  target_compile_options(manyhands_options INTERFACE -Wno-bitwise-instead-of-logical)
endif()
if(MANYHANDS_SANITIZE)
  set(sanitize -fsanitize=${MANYHANDS_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_compile_options(manyhands_options INTERFACE ${sanitize})
  target_link_options(manyhands_options INTERFACE ${sanitize})
  if(MANYHANDS_SANITIZE MATCHES "address")
    # These double the time of compiling, and a bad address ends the program without them.
    target_compile_options(manyhands_options INTERFACE -fno-sanitize=null,alignment,object-size,vptr)
  endif()
  # For lanes and tests, which instantiate once more what the library has in double and float: without checks of
  # arithmetic and of the stack. With them a kernel in 16 lanes takes eight minutes to compile, without them 16 s.
  set(sanitize_lightly -fno-sanitize=undefined)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    list(APPEND sanitize_lightly --param=asan-stack=0)
  endif()
endif()

# Tests, benchmarks and examples also know where the source tree lies.
add_library(manyhands_developer INTERFACE)
target_link_libraries(manyhands_developer INTERFACE manyhands_options)
target_compile_definitions(manyhands_developer INTERFACE MANYHANDS_SOURCE_DIR="${PROJECT_SOURCE_DIR}")

# manyhands_add_library(name sources...): a static library, fit for the Python extension.
function(manyhands_add_library name)
  if(NOT ARGN)
    file(WRITE "${PROJECT_BINARY_DIR}/empty.cpp" "")
    set(ARGN "${PROJECT_BINARY_DIR}/empty.cpp")
  endif()
  add_library(${name} STATIC ${ARGN})
  add_library(manyhands::${name} ALIAS ${name})
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_EXTENSIONS OFF)
  target_include_directories(${name} PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>" "$<INSTALL_INTERFACE:include>")
  target_link_libraries(${name} PUBLIC manyhands_flags PRIVATE "$<BUILD_INTERFACE:manyhands_options>")
endfunction()

# manyhands_unite(target): with MANYHANDS_UNITY, the files of a folder are compiled as one. Kernels stay apart, each to
# be optimised alone: those folders, and files named after a number type.
function(manyhands_unite target)
  if(NOT MANYHANDS_UNITY)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources EXCLUDE REGEX "_(scalar|double|float|lanes[0-9]+)[.]cpp$")
  list(FILTER sources EXCLUDE REGEX "/manyhands/(physics/(dynamics|collision|contact)|render|kinematics|control|learn/mlp)")
  foreach(source IN LISTS sources)
    cmake_path(RELATIVE_PATH source BASE_DIRECTORY "${PROJECT_SOURCE_DIR}" OUTPUT_VARIABLE group)
    cmake_path(REMOVE_FILENAME group)
    string(MAKE_C_IDENTIFIER "${group}" group)
    set_property(SOURCE ${source} PROPERTY UNITY_GROUP ${group})
  endforeach()
endfunction()

# manyhands_add_programs(folder libraries...): each .cpp that lies directly in the folder becomes a program of its name.
# The target of the folder's name builds them all.
function(manyhands_add_programs folder)
  add_custom_target(${folder})
  file(GLOB sources CONFIGURE_DEPENDS ${folder}/*.cpp)
  foreach(source IN LISTS sources)
    cmake_path(GET source STEM name)
    add_executable(${name} ${source})
    target_link_libraries(${name} PRIVATE manyhands_learn ${ARGN} manyhands_developer)
    add_dependencies(${folder} ${name})
    set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/${folder}")
  endforeach()
endfunction()
