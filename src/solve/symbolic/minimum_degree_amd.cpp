// Minimum degree by SuiteSparse's AMD, which is faster and finds better orders than Eigen's.
#include <amd.h>
#include <new>
#include <numeric>

#include "ordering.hpp"

namespace slom {

std::vector<int> orderByMinimumDegree(const BlockGraph& graph) {
  std::vector<int> order(graph.dof.size());
  std::iota(order.begin(), order.end(),
            0);  // as good as any where there are no edges, which AMD does not take
  if (graph.neighbour.empty()) return order;
  const int status =
      amd_order(graph.size(), graph.start.data(), graph.neighbour.data(), order.data(), nullptr, nullptr);
  if (status != AMD_OK) throw std::bad_alloc();  // the only other outcome for a graph that is well formed
  return order;
}

}  // namespace slom
