/// One fit on several processes, by MPI and PETSc. docs/scale.md shows how.
#pragma once

#include "slom/distributed/checkpoint.hpp"
#include "slom/distributed/covariances.hpp"
#include "slom/distributed/petsc_solver.hpp"
#include "slom/distributed/pieces.hpp"
#include "slom/distributed/pose_graph.hpp"
#include "slom/distributed/processes.hpp"
#include "slom/distributed/scene.hpp"
#include "slom/distributed/session.hpp"
