# What the solver is built with: SuiteSparse's AMD (BSD licence) and METIS (Apache licence) where they are found, and one
# set of dense kernels for each instruction set, chosen at run time.
# Takes the sources that are not to be compiled out of slom_sources, and sets slom_solve_includes and slom_solve_libraries.
find_path(SLOM_AMD_INCLUDE_DIR amd.h PATH_SUFFIXES suitesparse DOC "Folder of AMD's amd.h")
find_library(SLOM_AMD_LIBRARY amd DOC "SuiteSparse's AMD, orders of elimination")
find_path(SLOM_METIS_INCLUDE_DIR metis.h DOC "Folder of METIS' metis.h")
find_library(SLOM_METIS_LIBRARY metis DOC "METIS, nested dissection")
mark_as_advanced(SLOM_AMD_INCLUDE_DIR SLOM_AMD_LIBRARY SLOM_METIS_INCLUDE_DIR SLOM_METIS_LIBRARY)

set(slom_solve_includes "")
set(slom_solve_libraries "")
# Libraries are linked by their short names, which hold on the machine that an installed package is used on, too.
macro(slom_use_ordering name with without debian)
  string(TOUPPER ${name} upper)
  if(SLOM_${upper}_INCLUDE_DIR AND SLOM_${upper}_LIBRARY)
    list(FILTER slom_sources EXCLUDE REGEX "/${without}$")
    list(APPEND slom_solve_includes "${SLOM_${upper}_INCLUDE_DIR}")
    list(APPEND slom_solve_libraries ${name})
  else()
    list(FILTER slom_sources EXCLUDE REGEX "/${with}$")
    message(STATUS "slom: without ${upper}, so large problems are solved more slowly (Debian: ${debian})")
  endif()
endmacro()
slom_use_ordering(amd "minimum_degree_amd\\.cpp" "minimum_degree_eigen\\.cpp" libsuitesparse-dev)
slom_use_ordering(metis "nested_dissection_metis\\.cpp" "nested_dissection_absent\\.cpp" libmetis-dev)

if(SLOM_WITH_CHOLMOD)
  find_path(SLOM_CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse DOC "Folder of CHOLMOD's cholmod.h")
  find_library(SLOM_CHOLMOD_LIBRARY cholmod DOC "SuiteSparse's CHOLMOD")
  if(NOT SLOM_CHOLMOD_INCLUDE_DIR OR NOT SLOM_CHOLMOD_LIBRARY)
    message(FATAL_ERROR "SLOM_WITH_CHOLMOD is on, but CHOLMOD was not found; install it (Debian: libsuitesparse-dev)")
  endif()
  list(FILTER slom_sources EXCLUDE REGEX "/cholmod_absent\\.cpp$")
  list(APPEND slom_solve_includes "${SLOM_CHOLMOD_INCLUDE_DIR}")
  list(APPEND slom_solve_libraries cholmod)
else()
  list(FILTER slom_sources EXCLUDE REGEX "/cholmod_present\\.cpp$")
endif()

if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
  foreach(folder IN ITEMS solve/dense tape)  # for factorisations and for tapes
    foreach(set IN ITEMS avx2 avx512 portable)
      list(APPEND ${set}_kernels "${PROJECT_SOURCE_DIR}/src/${folder}/kernels_${set}.cpp")
    endforeach()
  endforeach()
  set(kernel_sources ${avx2_kernels} ${avx512_kernels} ${portable_kernels})
  set_property(SOURCE ${kernel_sources} APPEND PROPERTY COMPILE_OPTIONS -O3 -fno-math-errno)
  # Nothing but the kernels may be compiled with other instructions, so no header is put before them: cmake/SlomShared.cmake.
  set_property(SOURCE ${kernel_sources} APPEND PROPERTY COMPILE_DEFINITIONS SLOM_NO_HEADER_FIRST)
  # Its vectors are passed among its own functions alone, so nobody else need know how.
  set_property(SOURCE ${portable_kernels} APPEND PROPERTY COMPILE_OPTIONS -Wno-psabi)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    # Multiply-adds are written out: the same bits from every compiler and instruction set with FMA.
    set_property(SOURCE ${kernel_sources} APPEND PROPERTY COMPILE_OPTIONS -ffp-contract=off)
    set_property(SOURCE ${avx2_kernels} APPEND PROPERTY COMPILE_OPTIONS -mavx2 -mfma)
    set_property(SOURCE ${avx512_kernels}
                 APPEND PROPERTY COMPILE_OPTIONS -mavx2 -mfma -mavx512f -mavx512vl -mavx512dq)
  else()
    list(FILTER slom_sources EXCLUDE REGEX "/kernels_avx(2|512)\\.cpp$")
  endif()
endif()
