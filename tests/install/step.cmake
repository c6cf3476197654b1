# step(<what> <command>...): runs the command and ends the script with all that it said when it fails.
function(step what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " line)
    message(FATAL_ERROR "${what} failed with ${status}: ${line}\n${output}")
  endif()
endfunction()
