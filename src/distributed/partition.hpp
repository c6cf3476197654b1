/// Partition of a graph among the processes, by PETSc's MatPartitioning.
#pragma once

#include <cstdint>
#include <vector>

#include "slom/distributed/processes.hpp"

namespace slom::distributed {

/// What makes two vertices stay together, such as an edge or common points. A link of a vertex with itself is work at
/// the vertex.
struct Link {
  std::int64_t a = 0, b = 0;  ///< vertices, numbered across all processes
  std::int64_t weight = 1;
};

/// Returns the process of each own vertex, such that processes get about the same work and few links are cut. `count`:
/// number of own vertices; the numbers of those of a process follow one another. Each link is in one process, any of
/// them. The result depends on vertices, links and the number of processes alone. PETSc's options
/// (-mat_partitioning_type average, ...) change the method. Throws [slom.petsc].
std::vector<int> partitioned(const Processes& processes, std::int64_t count, const std::vector<Link>& links);

}  // namespace slom::distributed
