# The body of a compile_fail test, see SlomCompileFail.cmake.
#   cmake -DCOMPILER=... -DSOURCE=... -DPRECOMPILED=... -DINCLUDE_DIRS=<list> -DEXPECTED=<regex> -P compile_fail.cmake
list(TRANSFORM INCLUDE_DIRS PREPEND -I)
set(compile "${COMPILER}" -std=c++20 -fsyntax-only ${INCLUDE_DIRS} -include "${PRECOMPILED}" "${SOURCE}")

execute_process(COMMAND ${compile} -DMUST_FAIL RESULT_VARIABLE status ERROR_VARIABLE errors OUTPUT_QUIET)
if(status EQUAL 0)
  message(FATAL_ERROR "${SOURCE}: compiles with MUST_FAIL, but must not")
endif()
if(NOT errors MATCHES "${EXPECTED}")
  message(FATAL_ERROR "${SOURCE}: is refused with MUST_FAIL, as it must be, but the message does not match\n"
                      "  ${EXPECTED}\nThe compiler says:\n${errors}")
endif()
