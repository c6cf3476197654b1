# Install rules: headers, libraries, and the package `slom` that find_package(slom CONFIG) reads. The command
# has its rules beside its target, in apps/.
include(CMakePackageConfigHelpers)
set(slom_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/slom")

set(slom_not_installed "")
foreach(room IN ITEMS calibration distributed)
  if(NOT TARGET slom_${room})
    list(APPEND slom_not_installed REGEX "/slom/${room}(/|[.]hpp$)" EXCLUDE)
  endif()
endforeach()
install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT development
        FILES_MATCHING PATTERN "*.hpp" ${slom_not_installed})
install(TARGETS mtk EXPORT mtk_targets)
install(EXPORT mtk_targets NAMESPACE mtk:: DESTINATION "${slom_package_dir}" COMPONENT development)
foreach(library IN ITEMS slom slom_io slom_calibration slom_distributed)
  if(TARGET ${library})
    install(TARGETS ${library} EXPORT ${library}_targets
            LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT libraries NAMELINK_COMPONENT development
            ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development)
    install(EXPORT ${library}_targets NAMESPACE slom:: DESTINATION "${slom_package_dir}" COMPONENT development)
  endif()
endforeach()

set(slom_is_static ON)
if(BUILD_SHARED_LIBS)
  set(slom_is_static OFF)
endif()
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/slom-config.cmake.in"
                              "${PROJECT_BINARY_DIR}/slom-config.cmake" INSTALL_DESTINATION "${slom_package_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/slom-config-version.cmake"
                                 COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/slom-config.cmake" "${PROJECT_BINARY_DIR}/slom-config-version.cmake"
        DESTINATION "${slom_package_dir}" COMPONENT development)
# Pages, as their links expect them beside the readme; what the command brings of others says so beside its own licence.
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT licences)
install(FILES "${PROJECT_SOURCE_DIR}/README.md" "${PROJECT_SOURCE_DIR}/CHANGELOG.md" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT documents)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT documents PATTERN "docs/site" EXCLUDE)
# The site that scripts/docs makes of them, where it was built.
set(slom_site "${PROJECT_SOURCE_DIR}/build/docs/html")
install(DIRECTORY "${slom_site}" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT documents OPTIONAL)
if(PROJECT_IS_TOP_LEVEL)
  add_custom_target(docs COMMAND "${PROJECT_SOURCE_DIR}/scripts/docs" "${slom_site}" USES_TERMINAL VERBATIM
                    COMMENT "Building the documentation as a site")
endif()

# For builds that know pkg-config instead of CMake: mtk.pc and slom.pc. A static library names what it stands on itself.
set(slom_pc_libraries "")
foreach(library IN LISTS slom_solve_libraries)
  string(APPEND slom_pc_libraries " -l${library}")
endforeach()
if(SLOM_WITH_TBB)
  string(APPEND slom_pc_libraries " -ltbb")
endif()
set(slom_pc_private "")
if(BUILD_SHARED_LIBS)
  set(slom_pc_private "${slom_pc_libraries}")
  set(slom_pc_libraries "")
endif()
# As for CMake's package, the prefix is found from where the file lies.
file(RELATIVE_PATH slom_pc_to_prefix "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
string(REGEX REPLACE "/$" "" slom_pc_to_prefix "${slom_pc_to_prefix}")
foreach(name IN ITEMS mtk slom)
  configure_file("${CMAKE_CURRENT_LIST_DIR}/${name}.pc.in" "${PROJECT_BINARY_DIR}/${name}.pc" @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/${name}.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT development)
endforeach()
