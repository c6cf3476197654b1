// Minimum degree by SuiteSparse's AMD, which is faster and finds better orders than Eigen's.
#include <amd.h>
#include <new>
#include <numeric>

#include "ordering.hpp"

namespace slom {

std::vector<int> orderByMinimumDegree(const BlockGraph& graph) {
  std::vector<int> order(graph.dof.size());
  std::iota(order.begin(), order.end(),
            0);  // any order will do without edges; AMD does not accept that
  if (graph.neighbour.empty()) return order;
  const int status =
      amd_order(graph.size(), graph.start.data(), graph.neighbour.data(), order.data(), nullptr, nullptr);
  if (status != AMD_OK) throw std::bad_alloc();  // the only other outcome for a well-formed graph
  return order;
}

}  // namespace slom
