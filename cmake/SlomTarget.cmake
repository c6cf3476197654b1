# slom_own_target(<target>): what every target that is compiled here has in common. Nothing of it is passed on
# to whoever links the target.
function(slom_own_target target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  if(NOT PROJECT_IS_TOP_LEVEL)
    target_compile_options(${target} PRIVATE -w)  # warnings that a parent asks for, and makes errors of, are about its own sources
  elseif(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
    target_compile_options(${target} PRIVATE -Wall -Wextra $<$<BOOL:${SLOM_WARNINGS_AS_ERRORS}>:-Werror>)
  endif()
endfunction()

# slom_fuzzed(<target>): counts for the fuzzer which of its branches an input takes, where the fuzzer is built. Readers and the command are
# counted. Algorithms branch by numbers, which say little about the kind of an input.
function(slom_fuzzed target)
  if(SLOM_BUILD_FUZZERS)
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
endfunction()

# slom_compile_quickly(): the targets of this folder are compiled with little optimisation and without flattening, because they take longer to
# compile than to run. The libraries that they link are compiled as users get them.
macro(slom_compile_quickly)
  add_compile_options($<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU,Clang>>:-O1>)
  add_compile_definitions(SLOM_NO_FLATTEN)
endmacro()

# slom_unity(<target>): compiles its sources in groups, unless SLOM_UNITY_BUILD is off. So a group parses the headers and instantiates the templates
# that its sources share only once.
function(slom_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${SLOM_UNITY_BUILD} UNITY_BUILD_BATCH_SIZE ${SLOM_UNITY_BATCH_SIZE})
endfunction()
