# slom_own_target(<target>): what every target that is compiled here has in common. Nothing of it is passed on
# to whoever links the target.
function(slom_own_target target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
    target_compile_options(${target} PRIVATE -Wall -Wextra $<$<BOOL:${SLOM_WARNINGS_AS_ERRORS}>:-Werror>)
  endif()
endfunction()
