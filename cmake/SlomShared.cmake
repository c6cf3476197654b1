# What the libraries have in common when they are shared: their names, and what they export.
#
# A library exports what the headers in include/ declare, and nothing that src/ declares: its sources are compiled with hidden
# visibility, after the library's public headers, which are included first, with default visibility. So no declaration
# is annotated, and none can be forgotten. A linker version script leaves out what the library compiles of others, of Eigen and of the
# standard library above all, which has default visibility, too. docs/decisions/exported_symbols.md says why.

# The number in the SONAMEs, libslom.so.0. It is raised by each release that breaks programs compiled for the one before,
# whatever the major version.
set(slom_soversion 0)

# slom_exports(<target> <room>...): what the target exports. Without a room it is the library slom, which exports the namespace slom as the public
# headers declare it, but for those of the rooms; with the room `io` it exports slom::io, as slom/io.hpp and the headers in slom/io declare it.
function(slom_exports target)
  set_target_properties(${target} PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${slom_soversion} POSITION_INDEPENDENT_CODE ON)
  get_target_property(type ${target} TYPE)
  if(NOT CMAKE_EXECUTABLE_FORMAT STREQUAL ELF OR NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # clang does not let a class that was declared in there be hidden where it is defined: its shared libraries export everything
    return()
  endif()
  if(NOT type STREQUAL SHARED_LIBRARY AND NOT SLOM_UNITY_BUILD)
    # Each source alone: so includes that are missing in it are found. Nothing is exported, and no class more visible than its members.
    target_compile_options(${target} PRIVATE -fvisibility=hidden)
    return()
  endif()

  file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE "${PROJECT_SOURCE_DIR}/include" "${PROJECT_SOURCE_DIR}/include/*.hpp")
  list(FILTER headers EXCLUDE REGEX "^mtk/testing/")
  set(namespace slom)
  if(ARGN)
    set(namespace "slom::${ARGN}")
    list(FILTER headers INCLUDE REGEX "^slom/(slom|${ARGN}(/.*)?)[.]hpp$")
  else()
    list(FILTER headers EXCLUDE REGEX "^slom/(io|calibration|distributed|filter)(/.*)?[.]hpp$")  # filters are headers alone
  endif()
  list(TRANSFORM headers REPLACE "(.+)" "#include <\\1>")
  list(JOIN headers "\n" headers)
  set(public "${PROJECT_BINARY_DIR}/exports/${target}.hpp")
  file(CONFIGURE OUTPUT "${public}" @ONLY CONTENT
       "#pragma once\n#ifndef SLOM_NO_HEADER_FIRST\n#pragma GCC visibility push(default)\n@headers@\n#pragma GCC visibility pop\n#endif\n")
  set_target_properties(${target} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_compile_options(${target} PRIVATE "SHELL:-include \"${public}\"")

  slom_version_script(script ${namespace})
  file(CONFIGURE OUTPUT "${PROJECT_BINARY_DIR}/exports/${target}.map" CONTENT "${script}")
  if(type STREQUAL SHARED_LIBRARY)
    slom_export_by(${target} ${target})
  endif()
endfunction()

# slom_export_by(<target> <library>): links the target, a shared library, with the version script of the library.
function(slom_export_by target library)
  set(map "${PROJECT_BINARY_DIR}/exports/${library}.map")
  target_link_options(${target} PRIVATE "-Wl,--version-script=${map}")
  set_target_properties(${target} PROPERTIES LINK_DEPENDS "${map}")
endfunction()

# slom_archive(<target>): where SLOM_BUILD_STATIC_TOO is on, a static library of the objects that a shared one was made of.
function(slom_archive target)
  get_target_property(type ${target} TYPE)
  if(type STREQUAL SHARED_LIBRARY AND SLOM_BUILD_STATIC_TOO)
    add_library(${target}_static STATIC $<TARGET_OBJECTS:${target}>)
    set_target_properties(${target}_static PROPERTIES OUTPUT_NAME ${target} LINKER_LANGUAGE CXX)
    slom_own_eigen(${target}_static)
    if(SLOM_INSTALL)
      install(TARGETS ${target}_static ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development)
    endif()
  endif()
endfunction()

# slom_version_script(<variable> <namespace>): the text of a version script that exports what is in the namespace, by the names that
# the Itanium C++ ABI makes of it.
function(slom_version_script result namespace)
  string(REPLACE "::" ";" parts "${namespace}")
  set(mangled "")
  foreach(part IN LISTS parts)
    string(LENGTH "${part}" length)
    string(APPEND mangled "${length}${part}")
  endforeach()
  set(lines "")
  # functions and variables; tables and type information of classes; thunks; static variables of functions, and their guards
  foreach(pattern IN ITEMS _ZN@ _ZNK@ _ZT[ISTV]N@ _ZT[hv]*_N@ _ZT[hv]*_NK@ _ZZN@ _ZZNK@ _ZGVN@ _ZGVZN@ _ZGVZNK@)
    string(REPLACE "@" "${mangled}" pattern "${pattern}")
    string(APPEND lines "    ${pattern}*;\n")
  endforeach()
  if(namespace STREQUAL slom)
    # the exception that all throw, the instances of Eigen's << that slom/analyze/printing.hpp declares, and rotations of recorded numbers
    string(APPEND lines "    _ZT[ISV]N3mtk5ErrorE;\n    _ZN5EigenlsI*;\n    _ZN3mtk3SO3IN4slom4tape6NumberEE*;\n    _ZNK3mtk3SO3IN4slom4tape6NumberEE*;\n")
  endif()
  set(${result} "{\n  global:\n${lines}  local:\n    *;\n};\n" PARENT_SCOPE)
endfunction()
