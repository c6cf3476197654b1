# An overlay port: it builds the checkout that it lies in. A port of a registry would fetch a release here.
get_filename_component(SOURCE_PATH "${CURRENT_PORT_DIR}/../../.." ABSOLUTE)

vcpkg_check_features(OUT_FEATURE_OPTIONS features FEATURES command SLOM_BUILD_APPS)
vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS
    ${features}
    -DSLOM_BUILD_IO=ON
    -DSLOM_BUILD_CALIBRATION=ON
    -DSLOM_BUILD_TESTS=OFF
    -DSLOM_BUILD_EXAMPLES=OFF
    -DSLOM_WITH_OPENCV=OFF
  MAYBE_UNUSED_VARIABLES
    SLOM_WITH_OPENCV
)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/slom)
vcpkg_fixup_pkgconfig()
if("command" IN_LIST FEATURES)
  vcpkg_copy_tools(TOOL_NAMES slom AUTO_CLEAN)
endif()

file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share" "${CURRENT_PACKAGES_DIR}/share/doc")
file(INSTALL "${CURRENT_PORT_DIR}/usage" DESTINATION "${CURRENT_PACKAGES_DIR}/share/${PORT}")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE" "${SOURCE_PATH}/apps/slom/calibrate/html/uplot/LICENSE")
