# Debian packages, made by `cpack -G DEB` of a build with shared libraries that was configured for /usr; scripts/package does all of it.
#
#   slom         the command, its manual pages, completion and data       (component command)
#   libslom0     the shared libraries                                     (libraries)
#   libslom-dev  headers, static libraries, files for CMake, pkg-config   (development)
#   slom-doc     pages and, where scripts/docs has built it, the site     (documents)
#
# What Debian's policy asks for beyond what is installed, packaging/debian/finish.cmake and triggers.cmake add.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME slom)
set(CPACK_PACKAGE_VENDOR "The SLoM authors")
set(CPACK_PACKAGE_CONTACT "The SLoM authors <maintainers@slom.example>")
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_BINARY_DIR}/packages")
set(CPACK_COMPONENTS_ALL command libraries development documents)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS "${PROJECT_SOURCE_DIR}/packaging/debian/finish.cmake")
set(CPACK_POST_BUILD_SCRIPTS "${PROJECT_SOURCE_DIR}/packaging/debian/triggers.cmake")

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SOURCE slom)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)

set(debian_version "${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}")
set(about "SLoM fits models to measurements: camera and IMU calibration, mapping,
surveying, curves. A program gives a function that predicts a measurement;
SLoM finds the values, and says how accurate they are and which data
disagree.")

# slom_debian_package(<component> <name> <section> <summary> <text>)
macro(slom_debian_package component name section summary text)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section})
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${summary}\n${about}\n\n${text}")
endmacro()
slom_debian_package(command slom science "sparse least squares on manifolds: the command"
                    "This package has the command: slom calibrate, graph, bundle, replay and\nsimulate.")
slom_debian_package(libraries libslom${slom_soversion} libs "sparse least squares on manifolds: shared libraries"
                    "This package has the shared libraries.")
slom_debian_package(development libslom-dev libdevel "sparse least squares on manifolds: headers"
                    "This package has what programs are compiled with.")
slom_debian_package(documents slom-doc doc "sparse least squares on manifolds: documentation" "This package has the documentation.")

foreach(upper IN ITEMS COMMAND LIBRARIES)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SHLIBDEPS ON)
endforeach()
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${PROJECT_BINARY_DIR}")
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(CPACK_DEBIAN_COMMAND_PACKAGE_DEPENDS "libslom${slom_soversion} (= ${debian_version})")
set(CPACK_DEBIAN_COMMAND_PACKAGE_SUGGESTS slom-doc)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libslom${slom_soversion} (= ${debian_version}), libeigen3-dev (>= 3.4)")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS slom-doc)
set(CPACK_DEBIAN_DOCUMENTS_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOCUMENTS_PACKAGE_DEPENDS libjs-sphinxdoc)
include(CPack)
