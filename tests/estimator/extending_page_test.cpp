// The code of docs/extending.md and docs/extending_solvers.md, unchanged: a user's own manifold, kind of measurement,
// loss, algorithm and linear solver. Each is compared with a known answer.
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <mtk/testing/axioms.hpp>
#include <slom/optimize/evaluator.hpp>
#include <slom/slom.hpp>
#include <slom/solve/dense_qr.hpp>

namespace {

using Vec3 = mtk::vect<3>;

/// A number above 0 whose error is relative: a scale, a gain.
///   state    value > 0
///   tangent  change of its logarithm, DOF = 1
struct Positive {
  using scalar = double;
  static constexpr int DOF = 1;
  double value = 1;
  void boxplus(mtk::vectview<const double, 1> d, double scale = 1) { value *= std::exp(scale * d[0]); }
  void boxminus(mtk::vectview<double, 1> out, const Positive& y) const { out[0] = std::log(value / y.value); }
  friend std::ostream& operator<<(std::ostream& os, const Positive& x) { return os << x.value; }
};
static_assert(mtk::Manifold<Positive>);

/// Geometric levelling.
///   variables  a, b  points, z upwards [m]
///   datum      a number [m]
///   residual   (b_z - a_z) - z
struct HeightDifference {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& a, const auto& b) const { return b[2] - a[2]; }
};

/// Gauss-Newton with a line search: the step is halved until the RSS falls by a ten-thousandth of what its slope promises.
class LineSearch final : public slom::Algorithm {
 public:
  std::string name() const override { return "line search"; }
  std::unique_ptr<slom::Algorithm> clone() const override { return std::make_unique<LineSearch>(*this); }
  slom::StepOutcome step(slom::Evaluator& evaluator, const slom::Options& options) override {
    slom::StepOutcome outcome;
    outcome.rss_before = outcome.rss_after = evaluator.linearize();
    Eigen::VectorXd full;
    outcome.status = evaluator.solveUndamped(full);
    outcome.kind = slom::StepOutcome::Kind::singular;
    if (!outcome.status.ok) return outcome;
    const double slope = 2 * evaluator.solver().gradient().dot(full);  // slope of the RSS
    for (double length = 1; length > 1e-10 && !evaluator.mustStop(); length /= 2) {
      ++outcome.trials;
      outcome.step = length * full;
      outcome.is_undamped = length == 1;
      outcome.predicted_decrease = evaluator.predictedDecrease(outcome.step, {});
      const double rss = evaluator.tryStep(outcome.step);  // NaN where a residual is not finite
      const bool is_last =
          evaluator.isNearlyNothing(outcome.predicted_decrease, options) && std::isfinite(rss);
      if (is_last || rss <= outcome.rss_before + 1e-4 * length * slope) {
        outcome.kind = slom::StepOutcome::Kind::taken;
        outcome.rss_after = rss;
        return outcome;
      }
      evaluator.undo();
    }
    outcome.kind = evaluator.mustStop() ? slom::StepOutcome::Kind::stopped : slom::StepOutcome::Kind::stuck;
    return outcome;
  }
};

/// A dense Cholesky decomposition of J^T J, with columns of J scaled to length 1.
class DenseCholesky final : public slom::LinearSolver {
 public:
  void analyze(const slom::BlockStructure& structure) override {
    structure_ = structure;
    ++counts_.analyses;
  }
  void beginLinearization() override {
    H_.setZero(structure_.unknowns(), structure_.unknowns());
    gradient_.setZero(structure_.unknowns());
  }
  void add(const slom::JacobianBatch& batch) override {
    const slom::MeasurementGroup& group = structure_.groups[std::size_t(batch.group)];
    const double *J = batch.J, *r = batch.r;
    const int* dof = batch.dof;
    for (int m = 0; m < batch.count; ++m) {
      const int rows = batch.rows[m];
      Eigen::MatrixXd wide = Eigen::MatrixXd::Zero(rows, structure_.unknowns());
      for (int k = 0; k < group.arity; ++k, ++dof) {
        const int block = group.blocks[std::size_t((batch.first + m) * group.arity + k)];
        if (block >= 0)  // otherwise the variable is fixed
          wide.middleCols(structure_.offset[std::size_t(block)], *dof) +=
              Eigen::Map<const Eigen::MatrixXd>(J, rows, *dof);
        J += rows * *dof;
      }
      H_ += wide.transpose() * wide;
      gradient_ += wide.transpose() * Eigen::Map<const Eigen::VectorXd>(r, rows);
      r += rows;
    }
  }
  void endLinearization() override { diagonal_ = H_.diagonal(); }

  slom::SolveStatus solve(const Eigen::VectorXd& damping, Eigen::VectorXd& step) override {
    Eigen::MatrixXd X;
    const slom::SolveStatus status = solveWith(damping, -gradient_, X);
    if (status.ok) step = X.col(0);
    return status;
  }
  slom::SolveStatus solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) override {
    return solveWith({}, B, X);
  }
  const Eigen::VectorXd& gradient() const override { return gradient_; }
  const Eigen::VectorXd& diagonal() const override { return diagonal_; }
  double squaredNormOfJd(const Eigen::VectorXd& d) const override { return d.dot(H_ * d); }
  std::string description() const override { return "dense Cholesky"; }

 private:
  slom::SolveStatus solveWith(const Eigen::VectorXd& damping, const Eigen::MatrixXd& B, Eigen::MatrixXd& X) {
    ++counts_.factorizations;
    Eigen::MatrixXd H = H_;
    if (damping.size() > 0) H.diagonal() += damping;
    Eigen::VectorXd scale = H.diagonal().cwiseSqrt();
    for (double& s : scale) s = s > 0 ? 1 / s : 1;
    const Eigen::LDLT<Eigen::MatrixXd> ldlt(scale.asDiagonal() * H * scale.asDiagonal());
    const Eigen::VectorXi order =
        ldlt.transpositionsP() * Eigen::VectorXi::LinSpaced(H.rows(), 0, int(H.rows()) - 1);
    for (int i = 0; i < int(H.rows()); ++i) {
      const double pivot = ldlt.vectorD()[i];
      if (!(pivot > 1e-12)) return {false, order[i], pivot};
    }
    X = scale.asDiagonal() * ldlt.solve(scale.asDiagonal() * B);
    return {};
  }

  slom::BlockStructure structure_;
  Eigen::MatrixXd H_;
  Eigen::VectorXd gradient_, diagonal_;
};

TEST(ExtendingPage, AManifold) {
  const Positive start{2.5};
  const auto report = mtk::testing::checkAxioms(start);
  EXPECT_TRUE(report.ok()) << report.text();

  // Distances measured by a tape with a wrong scale: the estimate is the mean of the logarithms.
  slom::Estimator est;
  const slom::VarID<Positive> scale = est.insertRV(start, "scale");
  double mean = 0;
  for (const double ratio : {1.02, 1.04, 1.03}) {
    est.insertMeasurement([](const Positive& s) { return s; }, scale, slom::measured(Positive{ratio}),
                          slom::StandardDeviation(0.01));
    mean += std::log(ratio) / 3;
  }
  const slom::Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged) << summary;
  EXPECT_NEAR(std::log(scale->value), mean, 1e-12);
}

TEST(ExtendingPage, AMeasurement) {
  slom::Estimator est;
  const auto a = est.insertRV(Vec3(0, 0, 10), "a"), b = est.insertRV(Vec3(5, 0, 0), "b");
  est.optimizeRV(a, false);
  est.insertMeasurement([](const auto& p) { return mtk::vector(p[0], p[1]); }, b,
                        slom::measured(mtk::vect<2>(5, 0)), slom::StandardDeviation(0.01));
  est.insertMeasurement(HeightDifference(), a, b, slom::measured(1.5), slom::StandardDeviation(0.002));
  est.insertMeasurement(HeightDifference(), b, a, slom::measured(-1.7), slom::StandardDeviation(0.002));
  const slom::DerivativeCheck check = slom::checkDerivatives(est);
  EXPECT_TRUE(check.ok()) << check;
  EXPECT_TRUE(est.optimize().converged);
  EXPECT_NEAR((*b)[2], 11.6, 1e-12);
}

TEST(ExtendingPage, ALoss) {
  const slom::Loss loss = slom::ownLoss("Welsch", 3, [](double t) {
    return slom::LossValue{-std::expm1(-t), std::exp(-t), -std::exp(-t)};  // value and two derivatives
  });
  slom::Estimator est;
  const slom::VarID<double> level = est.insertRV(1.0, "level");
  for (const double z : {1.1, 0.9, 1.0, 9.0}) {
    est.insertMeasurement([](const auto& x) { return x; }, level, slom::measured(z),
                          slom::StandardDeviation(0.1), loss);
  }
  EXPECT_TRUE(est.optimize().converged);
  EXPECT_NEAR(*level, 1, 1e-6);  // the gross error counts for nothing
}

/// atan(x - 1) = 0 and 0.1 x = 0.1, from where a full step leads away.
TEST(ExtendingPage, AnAlgorithm) {
  slom::Estimator est;
  const slom::VarID<double> x = est.insertRV(4.0, "x");
  const auto arc = [](const auto& v) {
    using std::atan;
    return atan(v - 1.0);
  };
  est.insertMeasurement(arc, x);
  est.insertMeasurement([](const auto& v) { return 0.1 * v - 0.1; }, x);
  est.changeAlgorithm(LineSearch());
  const slom::Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged) << summary;
  EXPECT_NEAR(*x, 1, 1e-9);
  EXPECT_GT(summary.trace[1].trials, 1);
  for (std::size_t i = 1; i < summary.trace.size(); ++i)
    EXPECT_LE(summary.trace[i].rss, summary.trace[i - 1].rss);
}

/// Fits a loop of levelled points, and returns the results of each step.
slom::Summary fitLoop(std::unique_ptr<slom::LinearSolver> solver, std::vector<double>& heights) {
  slom::Estimator est;
  std::vector<slom::VarID<double>> points;
  for (int i = 0; i < 6; ++i) points.push_back(est.insertRV(0.3 * i, "point " + std::to_string(i)));
  est.optimizeRV(points[0], false);
  for (int i = 0; i < 6; ++i) {
    est.insertMeasurement([](const auto& a, const auto& b) { return b - a; }, points[std::size_t(i)],
                          points[std::size_t((i + 1) % 6)], slom::measured(i == 5 ? -5.1 : 1.0),
                          slom::StandardDeviation(0.01 * (i + 1)));
  }
  est.changeSolver(std::move(solver));
  const slom::Summary summary = est.optimize();
  for (const auto& point : points) {
    heights.push_back(*point);
    heights.push_back(est.standardDeviation(point)[0]);
  }
  return summary;
}

TEST(ExtendingPage, ASolver) {
  std::vector<double> own, oracle;
  const slom::Summary summary = fitLoop(std::make_unique<DenseCholesky>(), own);
  fitLoop(std::make_unique<slom::DenseQR>(), oracle);
  EXPECT_TRUE(summary.converged) << summary;
  EXPECT_EQ(summary.solver, "dense Cholesky");
  for (std::size_t i = 0; i < own.size(); ++i) EXPECT_NEAR(own[i], oracle[i], 1e-12);
}

/// Undetermined unknowns are detected and named.
TEST(ExtendingPage, ASolverThatFindsNoRank) {
  slom::Estimator est;
  const auto a = est.insertRV(1.0, "a"), b = est.insertRV(2.0, "b");
  est.insertMeasurement([](const auto& x, const auto& y) { return y - x; }, a, b);
  est.changeSolver(std::make_unique<DenseCholesky>());
  const slom::Summary summary = est.optimize();
  EXPECT_EQ(summary.stop_reason, slom::StopReason::rank_deficient) << summary;
}

}  // namespace
