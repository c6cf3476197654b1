# Tests of compile-time messages: sources that must not compile, each with a twin that does.
#
#   slom_add_compile_fail_test(<name> <source> <expected>)
#       compiles <source> twice without making code: with -DMUST_FAIL it must be refused and the compiler's
#       message must match the regular expression <expected>; without, it must compile.
#   slom_add_compile_fail_tests(<folder>)
#       one such test, compile_fail.<name>, for each .cpp in the folder; its first line is `// expect: <regex>`.
function(slom_add_compile_fail_test name source expected)
  get_target_property(eigen_dirs Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
  add_test(NAME compile_fail.${name}
           COMMAND "${CMAKE_COMMAND}" "-DCOMPILER=${CMAKE_CXX_COMPILER}" "-DSOURCE=${source}"
                   "-DINCLUDE_DIRS=${PROJECT_SOURCE_DIR}/include;${eigen_dirs}" "-DEXPECTED=${expected}"
                   -P "${PROJECT_SOURCE_DIR}/cmake/compile_fail.cmake")
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
endfunction()
