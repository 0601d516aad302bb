# System packages. All that is missing is named at once, with the command that installs it.
set(missing_packages "")

function(manyhands_find package debian_name)
  find_package(${package} ${ARGN} QUIET)
  if(NOT ${package}_FOUND)
    set(missing_packages "${missing_packages} ${debian_name}" PARENT_SCOPE)
  endif()
endfunction()

find_package(Threads REQUIRED)
manyhands_find(Eigen3 libeigen3-dev 3.4 NO_MODULE)
manyhands_find(pugixml libpugixml-dev)
manyhands_find(Qhull libqhull-dev)
manyhands_find(PNG libpng-dev)
if(MANYHANDS_TESTS)
  manyhands_find(GTest libgtest-dev)
endif()

if(missing_packages)
  message(FATAL_ERROR "System packages are missing. Install them and configure again:\n"
                      "    apt-get update && apt-get install -y${missing_packages}\n")
endif()

# As a shared library, as distributions have it, or as a static one.
set(qhull_library Qhull::qhull_r)
if(NOT TARGET Qhull::qhull_r)
  set(qhull_library Qhull::qhullstatic_r)
endif()
