# Configures, builds and runs the project CONSUMER in the folder BUILD: fast to compile, unoptimised and without debug
# information. PREFIX is where the package is installed, SOURCES the source tree of slom, for those that want one or the other.
include("${CMAKE_CURRENT_LIST_DIR}/step.cmake")
file(REMOVE_RECURSE "${BUILD}")
step("configure" "${CMAKE_COMMAND}" -S "${CONSUMER}" -B "${BUILD}" "-DCMAKE_CXX_COMPILER=${COMPILER}"
     -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0 "-DCMAKE_PREFIX_PATH=${PREFIX}" "-DSLOM_SOURCES=${SOURCES}"
     "-DSLOM_EXPECTED_VERSION=${VERSION}")
step("build" "${CMAKE_COMMAND}" --build "${BUILD}" --parallel 2)
step("run" "${BUILD}/consumer")
