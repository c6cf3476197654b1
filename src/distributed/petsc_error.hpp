/// Error codes of PETSc and MPI as exceptions.
#pragma once

namespace slom::distributed {

/// Throws [slom.petsc] for an error code of PETSc.
void require(int petsc_code);

}  // namespace slom::distributed
