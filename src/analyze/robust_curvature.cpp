#include "analyze/robust_curvature.hpp"

#include "base/index.hpp"

namespace slom {

namespace {
constexpr double kLeastBend = 0.25;  // D of src/linearize/reweight.hpp, below which H omits the bend
constexpr double kPrecision = 1e-8;  // relative, of the columns
constexpr int kMostIterations = 100;
}  // namespace

RobustCurvature::RobustCurvature(const LinearizedProblem& linearized) : linearized_(linearized) {
  const auto& pools = linearized.problem().pools();
  for (std::size_t p = 0; p < pools.size(); ++p) {
    if (pools[p]->lossCount() == 0) continue;
    for (int i = 0; i < pools[p]->size(); ++i) {
      const Loss* const loss = pools[p]->lossOf(i);
      if (loss == nullptr) continue;
      const double s = linearized.unweightedRows().residual(p, i).squaredNorm();
      const LossValue value = loss->evaluate(s);
      if (value.second < 0 && !(value.first + 2 * s * value.second >= kLeastBend * value.first))
        terms_.push_back({p, i, -2 * value.second});
    }
  }
}

Eigen::MatrixXd RobustCurvature::times(const Eigen::MatrixXd& X) const {
  const JacobianRows& rows = linearized_.unweightedRows();
  const std::vector<int>& offset = linearized_.structure().system.offset;
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(X.rows(), X.cols());
  for (const Term& term : terms_) {
    const auto r = rows.residual(term.pool, term.measurement);
    Eigen::RowVectorXd along = Eigen::RowVectorXd::Zero(X.cols());
    rows.forEachPart(term.pool, term.measurement, [&](int block, const JacobianRows::Part& J) {
      along += (J.transpose() * r).transpose() * X.middleRows(offset[at(block)], J.cols());
    });
    rows.forEachPart(term.pool, term.measurement, [&](int block, const JacobianRows::Part& J) {
      result.middleRows(offset[at(block)], J.cols()) += term.curvature * (J.transpose() * r) * along;
    });
  }
  return result;
}

/// Iterates X = Z + H^-1 E X. Converges if H - E is positive definite.
bool RobustCurvature::correct(FreeGauge gauge, Eigen::MatrixXd& Z) const {
  if (isZero()) return true;
  const Eigen::VectorXd scale = linearized_.diagonal().cwiseSqrt();
  Eigen::MatrixXd X = Z;
  for (int i = 0; i < kMostIterations; ++i) {
    const Eigen::MatrixXd next = Z + linearized_.covarianceTimes(gauge, times(X));
    const double change = (scale.asDiagonal() * (next - X)).norm(), size = (scale.asDiagonal() * next).norm();
    X = next;
    if (!(size < 1e100)) return false;
    if (change <= kPrecision * size) {
      Z = X;
      return true;
    }
  }
  return false;
}

}  // namespace slom
