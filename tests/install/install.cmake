# Installs the build tree BUILD into the empty folder PREFIX and checks that all of it has arrived.
include("${CMAKE_CURRENT_LIST_DIR}/step.cmake")
file(REMOVE_RECURSE "${PREFIX}")
step("install" "${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${PREFIX}" --config "${CONFIG}")

foreach(file IN ITEMS include/mtk/mtk.hpp include/slom/slom.hpp bin/slom share/bash-completion/completions/slom
                      share/man/man1/slom.1 share/man/man1/slom-calibrate.1 share/doc/slom/README.md
                      share/slom/opencv_stereo/left_corners.csv share/doc/slom/docs/calibrate.md share/doc/slom/LICENSE
                      share/doc/slom/LICENSE.uPlot)
  if(NOT EXISTS "${PREFIX}/${file}")
    message(FATAL_ERROR "not installed: ${file}")
  endif()
endforeach()
if(EXISTS "${CMAKE_CURRENT_LIST_DIR}/../../build/docs/html/index.html" AND NOT EXISTS "${PREFIX}/share/doc/slom/html/index.html")
  message(FATAL_ERROR "not installed: the site that scripts/docs has built")
endif()
step("run the installed command" "${PREFIX}/bin/slom" --help)
