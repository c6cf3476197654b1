# slom_own_eigen(<target>): the target, a library, keeps its own copies of what it compiles of Eigen.
#
# How Eigen aligns and frees memory depends on flags such as -march. Functions of Eigen that were not inlined are weak
# symbols, and a linker takes one of all that have the same name: with a program of other flags, the library would get memory
# from one Eigen and give it back to another. In a static library these symbols get names of their own; a shared one calls its own.
# With other tools than GNU's, programs and library are to be compiled with the same flags.
function(slom_own_eigen target)
  if(NOT CMAKE_EXECUTABLE_FORMAT STREQUAL ELF)
    return()
  endif()
  get_target_property(type ${target} TYPE)
  if(type STREQUAL SHARED_LIBRARY)
    target_link_options(${target} PRIVATE -Wl,-Bsymbolic-functions)
  elseif(CMAKE_NM AND CMAKE_OBJCOPY)
    add_custom_command(
      TARGET ${target} POST_BUILD VERBATIM
      COMMAND "${CMAKE_COMMAND}" "-DLIBRARY=$<TARGET_FILE:${target}>" "-DNM=${CMAKE_NM}" "-DOBJCOPY=${CMAKE_OBJCOPY}"
              -P "${CMAKE_CURRENT_FUNCTION_LIST_FILE}")
  endif()
endfunction()

# ---- as a script: renames the weak symbols of LIBRARY that have Eigen in their names --------------------------------------
if(CMAKE_SCRIPT_MODE_FILE STREQUAL CMAKE_CURRENT_LIST_FILE)
  execute_process(COMMAND "${NM}" --defined-only --format=posix "${LIBRARY}" OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
  # functions, tables, and the names of groups of constructors and destructors
  string(REGEX MATCHALL "[^ \n]*5Eigen[^ \n]* [WVn] " symbols "${symbols}")
  list(REMOVE_DUPLICATES symbols)
  list(FILTER symbols EXCLUDE REGEX "^_ZN(4slom17makeVariableStore|5Eigenls)I")  # instances that programs take from here
  # All at once: there are 50 000 in a library that is not optimised, for which a loop takes a minute.
  list(TRANSFORM symbols REPLACE "^([^ ]+) .*$" "\\1 \\1.slom_own\n")
  list(JOIN symbols "" renamed)
  file(WRITE "${LIBRARY}.own_eigen" "${renamed}")
  execute_process(COMMAND "${OBJCOPY}" "--redefine-syms=${LIBRARY}.own_eigen" "${LIBRARY}" COMMAND_ERROR_IS_FATAL ANY)
endif()
