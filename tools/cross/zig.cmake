# CMake's toolchain file for tools/cross/zig: nothing is looked for in the system but header files of Eigen.
foreach(tool IN ITEMS C_COMPILER=cc CXX_COMPILER=c++ AR=ar RANLIB=ranlib)
  string(REPLACE "=" ";" pair ${tool})
  list(GET pair 0 variable)
  list(GET pair 1 program)
  set(CMAKE_${variable} "${CMAKE_CURRENT_LIST_DIR}/${program}" CACHE FILEPATH "")
endforeach()
set(CMAKE_FIND_USE_CMAKE_SYSTEM_PATH OFF)
set(CMAKE_FIND_USE_SYSTEM_ENVIRONMENT_PATH OFF)
set(Eigen3_DIR /usr/share/eigen3/cmake CACHE PATH "")
# Nothing but the modules' own functions is seen from outside, and what nobody calls is left out.
set(CMAKE_CXX_FLAGS_INIT "-fvisibility=hidden -ffunction-sections -fdata-sections")
# Thread-local storage as loaders of every age know it.
set(NB_HAS_MTLS_GNU2 OFF CACHE BOOL "" FORCE)
