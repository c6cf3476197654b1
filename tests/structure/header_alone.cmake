# A public header compiles alone. Where its own source file includes it before all else, and the build compiles that without
# precompiled headers and with warnings as errors, the build has shown so already; then it remains that it can be included
# twice. Any other is compiled here.
#   cmake -DHEADER=<path> -DNAME=<as included> -DSOURCE=<its source, compiled by the build; may be absent>
#         "-DCOMPILE=<command that compiles it, included twice>" -P header_alone.cmake
if(EXISTS "${SOURCE}")
  file(STRINGS "${SOURCE}" code REGEX "^[^/]")  # the first line that is neither empty nor a comment
  list(GET code 0 first)
  file(STRINGS "${HEADER}" once REGEX "^#pragma once$")
  if(first STREQUAL "#include \"${NAME}\"" AND once)
    message(STATUS "compiled by the build, as the first of ${SOURCE}")
    return()
  endif()
endif()
execute_process(COMMAND ${COMPILE} RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "${HEADER} does not compile alone")
endif()
