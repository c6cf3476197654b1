# What takes longer to compile than to run, as most test programs: where g++ builds, clang compiles it unoptimised, in a third of the time, and g++
# links what it makes with its own libraries. For the build of tests and, if there are tests, of examples.
find_program(SLOM_CLANG NAMES clang++-14 clang++ DOC "The second compiler that the sources must pass")
option(SLOM_TESTS_BY_CLANG "Where g++ builds, compile most test programs by clang: in a third of the time" ON)
set(slom_quick_by_clang OFF)
if(SLOM_TESTS_BY_CLANG AND SLOM_CLANG AND CMAKE_CXX_COMPILER_ID STREQUAL GNU AND NOT CMAKE_INTERPROCEDURAL_OPTIMIZATION)
  # A clang that knows all flags and finds a standard library, whose objects the first compiler links.
  set(probe "${PROJECT_BINARY_DIR}/by_clang_probe")
  file(CONFIGURE OUTPUT "${probe}.cpp" CONTENT "#include <string>\nint main(int n, char**) { return n - int(std::string(1, 'a').size()); }\n")
  string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
  separate_arguments(flags UNIX_COMMAND "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${type}}")
  execute_process(COMMAND "${SLOM_CLANG}" ${flags} -std=c++20 -Werror -c "${probe}.cpp" -o "${probe}.o"
                  RESULT_VARIABLE compiled OUTPUT_QUIET ERROR_QUIET)
  execute_process(COMMAND "${CMAKE_CXX_COMPILER}" ${flags} "${probe}.o" -o "${probe}"
                  RESULT_VARIABLE linked OUTPUT_QUIET ERROR_QUIET)
  if(compiled EQUAL 0 AND linked EQUAL 0)
    set(slom_quick_by_clang ON)
  else()
    message(STATUS "slom: g++ compiles all test programs, because ${SLOM_CLANG} cannot compile with the same flags for it to link")
  endif()
endif()

# slom_quick_target(<target>): it is compiled in the least time; by slom_quick_by_clang one can ask by whom.
function(slom_quick_target target)
  if(slom_quick_by_clang)
    set_target_properties(${target} PROPERTIES CXX_COMPILER_LAUNCHER "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/by_clang;${SLOM_CLANG}")
    target_compile_options(${target} PRIVATE -O0)
  else()
    target_compile_options(${target} PRIVATE ${slom_quick_options})
  endif()
  target_compile_definitions(${target} PRIVATE ${slom_quick_definitions})
endfunction()
