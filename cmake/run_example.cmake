# Runs one example and compares its standard output with what its folder says it prints.
#   cmake -DPROGRAM=<executable> [-DARGUMENT=<word>] -DEXPECTED=<text file, may be absent> -DACTUAL=<file to write> -P run_example.cmake
# A changed output that is right: copy the file named in the message over the expected one.
execute_process(COMMAND "${PROGRAM}" ${ARGUMENT} OUTPUT_FILE "${ACTUAL}" ERROR_VARIABLE errors RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  file(READ "${ACTUAL}" printed)
  message(FATAL_ERROR "${PROGRAM} ended with ${status}\n${printed}\n${errors}")
endif()
if(EXISTS "${EXPECTED}")
  file(READ "${EXPECTED}" expected)
  file(READ "${ACTUAL}" printed)
  if(NOT printed STREQUAL expected)
    execute_process(COMMAND diff -u "${EXPECTED}" "${ACTUAL}" OUTPUT_VARIABLE difference ERROR_QUIET)
    message(FATAL_ERROR "${PROGRAM} printed ${ACTUAL}, which differs from ${EXPECTED}:\n${difference}")
  endif()
endif()
