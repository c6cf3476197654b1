// Nested dissection by METIS.
#include <metis.h>

#include "ordering.hpp"

namespace slom {

std::vector<int> orderByNestedDissection(const BlockGraph& graph) {
  idx_t n = graph.size();
  if (n == 0) return {};
  std::vector<idx_t> start(graph.start.begin(), graph.start.end());
  std::vector<idx_t> neighbour(graph.neighbour.begin(), graph.neighbour.end());
  std::vector<idx_t> weight(graph.dof.begin(), graph.dof.end());
  std::vector<idx_t> order(graph.dof.size()), position(graph.dof.size());
  const int status =
      METIS_NodeND(&n, start.data(), neighbour.data(), weight.data(), nullptr, order.data(), position.data());
  return status == METIS_OK ? std::vector<int>(order.begin(), order.end()) : std::vector<int>{};
}

}  // namespace slom
