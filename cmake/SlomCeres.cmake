# slom_ceres: Ceres as a shared library, where it is installed. Debian's target Ceres::ceres is the static one, whose copies of Eigen's
# functions, compiled for any x86-64, the linker would mix with those of this build, which align memory differently. The target is known
# in the folder that includes this file.
find_package(Ceres QUIET)
find_library(SLOM_CERES_SHARED_LIBRARY NAMES libceres${CMAKE_SHARED_LIBRARY_SUFFIX})
mark_as_advanced(SLOM_CERES_SHARED_LIBRARY)
if(TARGET Ceres::ceres AND SLOM_CERES_SHARED_LIBRARY)
  add_library(slom_ceres SHARED IMPORTED)
  get_target_property(includes Ceres::ceres INTERFACE_INCLUDE_DIRECTORIES)
  set_target_properties(slom_ceres PROPERTIES IMPORTED_LOCATION "${SLOM_CERES_SHARED_LIBRARY}"
                                              INTERFACE_INCLUDE_DIRECTORIES "${includes}")
  target_link_libraries(slom_ceres INTERFACE glog::glog)
endif()
