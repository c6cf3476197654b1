# A public header compiles alone, and can be included twice.
#   cmake -DHEADER=<as included> -DINCLUDE_DIR=<where from> -DPREFIXES=<headers, precompiled in PRECOMPILED/<header>.gch or .pch>
#         -DPRECOMPILED=<folder> -DSOURCE=<includes HEADER twice> "-DCOMPILE=<compiler and flags>" -P header_alone.cmake
#
# What most headers begin with is parsed once for all: a prefix P is put before HEADER where HEADER includes P, directly or by others,
# and P does not include HEADER. Whatever HEADER lacks is then still missing, unless P or what P includes brings it, and that it has: P
# from its own includes, which stand before all of its code. Every header that HEADER includes has a test of its own. P is
# compiled alone as well, when it is precompiled.
cmake_minimum_required(VERSION 3.22)

function(slom_included_by header result)
  set(found "")
  set(unread "${header}")
  while(unread)
    list(POP_FRONT unread next)
    set(lines "")
    if(EXISTS "${INCLUDE_DIR}/${next}")
      file(STRINGS "${INCLUDE_DIR}/${next}" lines REGEX "^#include [<\"]")
    endif()
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^#include [<\"]([^>\"]+).*" "\\1" name "${line}")
      if(NOT name IN_LIST found)
        list(APPEND found "${name}")
        list(APPEND unread "${name}")
      endif()
    endforeach()
  endwhile()
  set(${result} "${found}" PARENT_SCOPE)
endfunction()

slom_included_by("${HEADER}" included)
set(prefix "")
foreach(candidate IN LISTS PREFIXES)
  if(candidate IN_LIST included)
    slom_included_by("${candidate}" included_by_candidate)
    if(NOT HEADER IN_LIST included_by_candidate)
      set(prefix -include "${PRECOMPILED}/${candidate}")
      break()
    endif()
  endif()
endforeach()
message(STATUS "${HEADER}: ${prefix}")
execute_process(COMMAND ${COMPILE} ${prefix} -fsyntax-only "${SOURCE}" RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "${HEADER} does not compile alone")
endif()
