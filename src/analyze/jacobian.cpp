#include "analyze/jacobian.hpp"

namespace slom {

StoredJacobian::StoredJacobian(Problem& problem, Linearizer& linearizer, const BlockStructure& structure)
    : structure_(structure) {
  rows_.analyze(structure);
  linearizer.linearize(problem, *this);
}

Eigen::MatrixXd StoredJacobian::times(const Eigen::MatrixXd& V) const {
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(rows_.rows(), V.cols());
  Eigen::Index row = 0;
  for (std::size_t g = 0; g < structure_.groups.size(); ++g) {
    for (int m = 0; m < structure_.groups[g].size(); ++m) {
      const Eigen::Index count = rows_.residual(g, m).size();
      rows_.forEachPart(g, m, [&](int block, const JacobianRows::Part& J) {
        product.middleRows(row, count).noalias() +=
            J * V.middleRows(structure_.offset[static_cast<std::size_t>(block)], J.cols());
      });
      row += count;
    }
  }
  return product;
}

}  // namespace slom
