// Minimum degree by Eigen, for builds without SuiteSparse's AMD.
#include <algorithm>

#include <Eigen/OrderingMethods>

#include "ordering.hpp"

namespace slom {

std::vector<int> orderByMinimumDegree(const BlockGraph& graph) {
  const int n = graph.size();
  Eigen::SparseMatrix<char, Eigen::ColMajor, int> pattern(n, n);
  pattern.resizeNonZeros(static_cast<Eigen::Index>(graph.neighbour.size()) + n);
  int* next = pattern.innerIndexPtr();
  for (int b = 0; b < n; ++b) {  // Eigen puts nodes without a diagonal entry last
    const auto begin = graph.neighbour.begin();
    *next++ = b;
    next = std::copy(begin + graph.start[static_cast<std::size_t>(b)],
                     begin + graph.start[static_cast<std::size_t>(b) + 1], next);
    pattern.outerIndexPtr()[b + 1] = static_cast<int>(next - pattern.innerIndexPtr());
  }
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::internal::minimum_degree_ordering(pattern, order);  // order.indices()[new] = old
  return {order.indices().data(), order.indices().data() + n};
}

}  // namespace slom
