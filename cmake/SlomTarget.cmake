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

# slom_fuzzed(<target>): counts for the fuzzer which of its branches an input takes, where the fuzzer is built.
function(slom_fuzzed target)
  if(SLOM_BUILD_FUZZERS)
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
endfunction()

# slom_unity(<target> [MOST <n>] [TOGETHER <source>...]): its sources are compiled several at a time, so that what all of them include is
# parsed, and what they instantiate of templates is compiled, once for several: SLOM_UNITY_BATCH_SIZE of them at most, and all groups of one
# size. With MOST, g++ compiles n at most: a part of its time grows with the square of the types of Eigen's expressions in a group. Sources after
# TOGETHER, as the target names them, include something large that the others do not, and are a group of their own. SLOM_UNITY_BUILD=OFF
# compiles each source alone.
function(slom_unity target)
  cmake_parse_arguments(unity "" "MOST" "TOGETHER" ${ARGN})
  if(NOT unity_MOST OR unity_MOST GREATER SLOM_UNITY_BATCH_SIZE OR NOT CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    set(unity_MOST ${SLOM_UNITY_BATCH_SIZE})
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${SLOM_UNITY_BUILD} UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  if(unity_TOGETHER)
    list(REMOVE_ITEM sources ${unity_TOGETHER})
    set_property(SOURCE ${unity_TOGETHER} PROPERTY UNITY_GROUP ${target}_together)
  endif()
  list(LENGTH sources count)
  math(EXPR groups "(${count} + ${unity_MOST} - 1) / ${unity_MOST}")
  set(at 0)
  foreach(source IN LISTS sources)
    math(EXPR group "${at} * ${groups} / ${count}")
    set_property(SOURCE "${source}" PROPERTY UNITY_GROUP ${target}_${group})
    math(EXPR at "${at} + 1")
  endforeach()
endfunction()

# slom_optimise(<target> <level>): what builds of type Release and RelWithDebInfo optimise it with, instead of the -O3 and -O2 that are for
# sources of whose speed users notice something.
function(slom_optimise target level)
  if(NOT PROJECT_IS_TOP_LEVEL)
    target_compile_options(${target} PRIVATE -w)  # warnings that a parent asks for, and makes errors of, are about its own sources
  elseif(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release,RelWithDebInfo>:${level}>)
  endif()
endfunction()

# For sources that take longer to compile than they run: with less optimisation, without flattening, and by clang, which compiles for
# the sanitizers, with no optimisation at all.
set(slom_unoptimised_by_sanitizers $<$<AND:$<CXX_COMPILER_ID:Clang>,$<CONFIG:Debug>>:-O0>)
set(slom_quick_options $<$<CONFIG:Release,RelWithDebInfo>:-O1> ${slom_unoptimised_by_sanitizers})
set(slom_quick_definitions SLOM_NO_FLATTEN)
