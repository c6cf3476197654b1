# Compiles each of HEADERS by COMPILE as C++17: the first error names C++20, and at most one other follows.
foreach(header IN LISTS HEADERS)
  if(header STREQUAL slom/version.hpp)  # macros alone, for any language
    continue()
  endif()
  file(WRITE "${SOURCE}" "#include <${header}>\n")
  execute_process(COMMAND ${COMPILE} -std=c++17 -fsyntax-only "${SOURCE}" RESULT_VARIABLE status ERROR_VARIABLE text
                  OUTPUT_QUIET)
  string(REGEX MATCHALL "error:[^\n]*" errors "${text}")
  list(LENGTH errors count)
  if(status EQUAL 0 OR count GREATER 2 OR NOT errors MATCHES "^error: #error \"SLoM needs C\\+\\+20")
    message(SEND_ERROR "${header} as C++17: ${count} errors\n${errors}")
  endif()
endforeach()
