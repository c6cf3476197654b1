# What a header costs whoever includes it: the lines that are left after the preprocessor, without empty ones and line
# markers, compared with those of another header. Fails above PERCENT percent of them.
#   cmake -DCOMPILER=... -DFLAGS=<list> -DHEADER=<name> -DREFERENCE=<name> -DPERCENT=<number> -DFOLDER=<to write to>
#         -P line_budget.cmake
function(count_lines header result)
  string(MAKE_C_IDENTIFIER "${header}" name)
  set(source "${FOLDER}/lines_of_${name}.cpp")
  file(WRITE "${source}" "#include <${header}>\n")
  execute_process(COMMAND "${COMPILER}" -std=c++20 -E ${FLAGS} "${source}" -o "${source}.i" RESULT_VARIABLE status
                  ERROR_VARIABLE errors)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${header}: the preprocessor ended with ${status}\n${errors}")
  endif()
  execute_process(COMMAND grep --count "^[[:space:]]*[^#[:space:]]" "${source}.i" OUTPUT_VARIABLE count
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
  set(${result} ${count} PARENT_SCOPE)
endfunction()

count_lines("${HEADER}" lines)
count_lines("${REFERENCE}" reference_lines)
math(EXPR percent "100 * ${lines} / ${reference_lines}")
message(STATUS "<${HEADER}> has ${lines} lines, ${percent} % of the ${reference_lines} lines of <${REFERENCE}>")
if(reference_lines LESS 1000)
  message(FATAL_ERROR "<${REFERENCE}> has only ${reference_lines} lines; they cannot have been counted rightly")
endif()
if(percent GREATER PERCENT)
  message(FATAL_ERROR "the budget is ${PERCENT} %; `${COMPILER} -H` shows what brings the others")
endif()
