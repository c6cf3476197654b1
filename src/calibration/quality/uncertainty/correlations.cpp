#include "calibration/quality/uncertainty/correlations.hpp"

#include <algorithm>
#include <cmath>

namespace slom::calibration {

Correlations correlationsOf(const SharedColumns& columns, const Eigen::MatrixXd& covariance) {
  constexpr double strong = 0.9;
  Correlations result;
  for (const int i : columns.free) result.names.push_back(columns.names[std::size_t(i)]);
  const Eigen::MatrixXd C = covariance(columns.free, columns.free);
  const Eigen::VectorXd scale = C.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd matrix = scale.asDiagonal() * C * scale.asDiagonal();
  const auto by_rows = matrix.reshaped<Eigen::RowMajor>();
  result.matrix.assign(by_rows.begin(), by_rows.end());
  for (Eigen::Index i = 0; i < C.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      if (std::abs(matrix(i, j)) < strong) continue;
      result.strong.push_back({result.names[std::size_t(j)], result.names[std::size_t(i)], matrix(i, j)});
    }
  }
  std::sort(result.strong.begin(), result.strong.end(),
            [](const auto& a, const auto& b) { return std::abs(a.coefficient) > std::abs(b.coefficient); });
  return result;
}

}  // namespace slom::calibration
