# Embree 3 or 4, whichever the distribution has: the target Embree::embree. Its own package file also asks for the
# headers of TBB, which nobody needs who only calls Embree.
foreach(version 4 3)
  find_path(Embree_INCLUDE_DIR embree${version}/rtcore.h)
  find_library(Embree_LIBRARY embree${version})
  if(Embree_INCLUDE_DIR AND Embree_LIBRARY)
    set(Embree_VERSION ${version})
    break()
  endif()
  unset(Embree_INCLUDE_DIR CACHE)
  unset(Embree_LIBRARY CACHE)
endforeach()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Embree REQUIRED_VARS Embree_LIBRARY Embree_INCLUDE_DIR VERSION_VAR Embree_VERSION)
mark_as_advanced(Embree_INCLUDE_DIR Embree_LIBRARY)
if(Embree_FOUND AND NOT TARGET Embree::embree)
  add_library(Embree::embree UNKNOWN IMPORTED)
  set_target_properties(Embree::embree PROPERTIES IMPORTED_LOCATION "${Embree_LIBRARY}"
                                                  INTERFACE_INCLUDE_DIRECTORIES "${Embree_INCLUDE_DIR}")
  if(Embree_LIBRARY MATCHES "[.]a$")  # comes in parts
    cmake_path(GET Embree_LIBRARY PARENT_PATH folder)
    set(parts embree_avx2 lexers tasking simd math sys)
    list(TRANSFORM parts REPLACE "(.+)" "${folder}/lib\\1.a")
    set_target_properties(Embree::embree PROPERTIES INTERFACE_LINK_LIBRARIES "${parts}")
  endif()
endif()
