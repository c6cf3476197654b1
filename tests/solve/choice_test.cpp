// The ways to choose a solver, as docs/solvers.md shows them: all of them find the same fit.
// Pages show code of this file as it stands.
// clang-format off
#include <gtest/gtest.h>

#include <memory>

#include <slom/slom.hpp>

namespace {

/// The line through three points with both coefficients known beforehand.
struct Line {
  slom::Estimator est;
  slom::VarID<mtk::vect<2>> line = est.insertRV(mtk::vect<2>(5, -5), "line");

  Line() {
    for (const double x : {1.0, 2.0, 4.0}) {
      est.insertMeasurement([x](const auto& c) { return c[0] + c[1] * x - (3 + 2 * x); }, line);
    }
  }
  void check() {
    est.reinitRV(line, mtk::vect<2>(5, -5));
    ASSERT_TRUE(est.optimize().converged);
    EXPECT_LT((*line - mtk::vect<2>(3, 2)).norm(), 1e-9);
  }
};

TEST(Solvers, AreChosenAsDocumented) {
  Line fit;
  slom::Estimator& est = fit.est;
  // clang-format off: the lines stand in the documentation as they are here
using Options = slom::BlockSolverOptions;
est.changeSolver(std::make_unique<slom::BlockSolver>(Options{.method = Options::Method::conjugate_gradients,
                                                             .preconditioner = Options::Preconditioner::power_series}));
  fit.check();
// The square root of the information matrix, for ill-conditioned problems.
est.changeSolver(std::make_unique<slom::BlockQR>());
  fit.check();
// Column-pivoted and slow: the reference, for small problems.
est.changeSolver(std::make_unique<slom::DenseQR>());
  fit.check();
// Offered where SLoM was configured with -DSLOM_WITH_CHOLMOD=ON.
if (slom::Cholmod::isAvailable()) est.changeSolver(std::make_unique<slom::Cholmod>());
  fit.check();
// The default.
est.changeSolver(std::make_unique<slom::BlockSolver>());
  fit.check();
  // clang-format on
}

}  // namespace
