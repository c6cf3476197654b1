# Tests of compile-time messages: sources that must not compile, each with a twin that does.
#
#   slom_add_compile_fail_test(<name> <source> <expected>)
#       compiles <source> with -DMUST_FAIL, without making code: it must be refused, and the compiler's message must match
#       the regular expression <expected>. <slom/slom.hpp> is compiled once for all of them, by the test compile_fail.precompile.
#   slom_add_compile_fail_tests(<folder>)
#       one such test, compile_fail.<name>, for each .cpp in the folder; its first line is `// expect: <regex>`; and their twins.
#   slom_add_compile_fail_twins(<name> <source>...)
#       without MUST_FAIL they must compile: the test compile_fail.<name> compiles them as one, each in a namespace of its own.
get_target_property(eigen_dirs Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
set(slom_compile_fail_dirs "${PROJECT_SOURCE_DIR}/include;${eigen_dirs}")

# g++ takes the .gch in place of the header beside it.
set(slom_compile_fail_precompiled "${CMAKE_CURRENT_BINARY_DIR}/compile_fail_precompiled.hpp")
file(CONFIGURE OUTPUT "${slom_compile_fail_precompiled}" CONTENT "#include <slom/slom.hpp>\n")
list(TRANSFORM slom_compile_fail_dirs PREPEND -I OUTPUT_VARIABLE include_flags)
add_test(NAME compile_fail.precompile COMMAND "${CMAKE_CXX_COMPILER}" -std=c++20 ${include_flags} -w -x c++-header
                                              "${slom_compile_fail_precompiled}" -o "${slom_compile_fail_precompiled}.gch")
set_tests_properties(compile_fail.precompile PROPERTIES LABELS "compile_fail;without_sanitizers"
                                                        FIXTURES_SETUP compile_fail_precompiled)

function(slom_add_compile_fail_test name source expected)
  add_test(NAME compile_fail.${name}
           COMMAND "${CMAKE_COMMAND}" "-DCOMPILER=${CMAKE_CXX_COMPILER}" "-DSOURCE=${source}"
                   "-DPRECOMPILED=${slom_compile_fail_precompiled}" "-DINCLUDE_DIRS=${slom_compile_fail_dirs}" "-DEXPECTED=${expected}"
                   -P "${PROJECT_SOURCE_DIR}/cmake/compile_fail.cmake")
  set_tests_properties(compile_fail.${name} PROPERTIES LABELS "compile_fail;without_sanitizers"
                                                     FIXTURES_REQUIRED compile_fail_precompiled)
endfunction()

# What they include stands before the namespaces, in which it is then skipped, as each header is included once.
function(slom_add_compile_fail_twins name)
  set(all_includes "")
  set(namespaces "")
  foreach(source IN LISTS ARGN)
    file(STRINGS "${source}" includes REGEX "^#include ")
    list(APPEND all_includes ${includes})
    get_filename_component(stem "${source}" NAME_WE)
    string(APPEND namespaces "namespace ${stem} {\n#include \"${source}\"\n}\n")
  endforeach()
  list(REMOVE_DUPLICATES all_includes)
  list(JOIN all_includes "\n" all_includes)
  set(twins "${CMAKE_CURRENT_BINARY_DIR}/compile_fail_${name}.cpp")
  file(CONFIGURE OUTPUT "${twins}" CONTENT "${all_includes}\n${namespaces}" @ONLY)
  add_test(NAME compile_fail.${name} COMMAND "${CMAKE_CXX_COMPILER}" -std=c++20 ${include_flags} -fsyntax-only "${twins}")
  set_tests_properties(compile_fail.${name} PROPERTIES LABELS "compile_fail;without_sanitizers")
endfunction()

function(slom_add_compile_fail_tests folder)
  file(GLOB sources CONFIGURE_DEPENDS "${folder}/*.cpp")
  foreach(source IN LISTS sources)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${source}")
    file(STRINGS "${source}" first_line LIMIT_COUNT 1)
    if(NOT first_line MATCHES "^// expect: (.+)$")
      message(FATAL_ERROR "${source}:1: the first line must be `// expect: <regular expression>`, "
                          "the message that the compiler is to give; it is `${first_line}`")
    endif()
    set(expected "${CMAKE_MATCH_1}")
    get_filename_component(name "${source}" NAME_WE)
    slom_add_compile_fail_test(${name} "${source}" "${expected}")
  endforeach()
  slom_add_compile_fail_twins(twins ${sources})
endfunction()
