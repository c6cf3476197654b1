# The library slom::distributed: one fit on several processes, by MPI and PETSc. It is built where SLOM_WITH_PETSC is on. Debian's PETSc also
# links parts of SuiteSparse and FFTW that are under the GPL, so it is off unless asked for.
find_package(PkgConfig REQUIRED)
pkg_check_modules(SLOM_PETSC IMPORTED_TARGET PETSc>=3.15)
find_package(MPI COMPONENTS CXX)  # of its functions for C; so programs need no other language than C++
if(NOT SLOM_PETSC_FOUND OR NOT MPI_CXX_FOUND)
  message(FATAL_ERROR "slom: SLOM_WITH_PETSC is on, but PETSc or MPI was not found; install them (Debian: libpetsc-real-dev, libopenmpi-dev)")
endif()

file(GLOB_RECURSE slom_distributed_sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/distributed/*.cpp")
add_library(slom_distributed ${slom_distributed_sources})
add_library(slom::distributed ALIAS slom_distributed)
slom_own_target(slom_distributed)
slom_unity(slom_distributed)
slom_own_eigen(slom_distributed)
set_target_properties(slom_distributed PROPERTIES EXPORT_NAME distributed)
target_include_directories(slom_distributed PRIVATE "${PROJECT_SOURCE_DIR}/src")
target_compile_definitions(slom_distributed PRIVATE OMPI_SKIP_MPICXX MPICH_SKIP_MPICXX)
target_link_libraries(slom_distributed PUBLIC slom PRIVATE slom_io fmt::fmt PkgConfig::SLOM_PETSC MPI::MPI_CXX)
slom_exports(slom_distributed distributed)
slom_archive(slom_distributed)
