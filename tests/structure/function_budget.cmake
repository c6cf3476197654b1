# What a program costs to compile: how many functions the compiler makes of it without optimisation. Time depends on the
# machine, this number does not, and it shows at once when a header begins to make each program compile more. Fails above MOST.
#   cmake -DCOMPILER=... -DFLAGS=<list> -DSOURCE=<file> -DMOST=<number> -DFOLDER=<to write to> -P function_budget.cmake
set(object "${FOLDER}/function_budget.o")
execute_process(COMMAND "${COMPILER}" -std=c++20 -O0 ${FLAGS} -c "${SOURCE}" -o "${object}" COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND nm "${object}" OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL " [tTW] " functions "${symbols}")
list(LENGTH functions count)
message(STATUS "${count} functions, of at most ${MOST}")
if(count LESS 100)
  message(FATAL_ERROR "so few cannot have been counted rightly")
endif()
if(count GREATER MOST)
  message(FATAL_ERROR "`nm -C --size-sort ${object}` shows which they are")
endif()
