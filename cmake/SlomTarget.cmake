# slom_own_target(<target>): what every target that is compiled here has in common. Nothing of it is passed on
# to whoever links the target.
function(slom_own_target target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
    target_compile_options(${target} PRIVATE -Wall -Wextra $<$<BOOL:${SLOM_WARNINGS_AS_ERRORS}>:-Werror>)
  endif()
endfunction()

# slom_fuzzed(<target>): counts for the fuzzer which of its branches an input takes, where the fuzzer is built.
function(slom_fuzzed target)
  if(SLOM_BUILD_FUZZERS)
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
endfunction()

# slom_unity(<target>): its sources are compiled several at a time, so that what all of them include is parsed, and what they
# instantiate of templates is compiled, once for several. SLOM_UNITY_BUILD=OFF compiles each alone.
function(slom_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${SLOM_UNITY_BUILD} UNITY_BUILD_BATCH_SIZE ${SLOM_UNITY_BATCH_SIZE})
endfunction()

# For sources that take longer to compile than they run: with less optimisation, without flattening, and by clang, which compiles for
# the sanitizers, with no optimisation at all.
set(slom_unoptimised_by_sanitizers $<$<AND:$<CXX_COMPILER_ID:Clang>,$<CONFIG:Debug>>:-O0>)
set(slom_quick_options $<$<CONFIG:Release,RelWithDebInfo>:-O1> ${slom_unoptimised_by_sanitizers})
set(slom_quick_definitions SLOM_NO_FLATTEN)
