// All analyses at the same values share one linearisation, one symbolic analysis and one factorisation, and change
// nothing.
#include <memory>
#include <random>
#include <sstream>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include <slom/archive.hpp>
#include <slom/slom.hpp>

namespace {

using vec2 = mtk::vect<2>;

int evaluations_with_derivatives = 0;

/// y = a exp(b t) + c of a point of a curve; counts how often its derivatives are computed.
struct Curve {
  template <class V>
  auto operator()(const V& p, double t) const {
    using std::exp;
    if constexpr (!std::is_same_v<V, mtk::vect<3>>) ++evaluations_with_derivatives;
    return p[0] * exp(p[1] * t) + p[2];
  }
};

struct Fit {
  slom::Estimator est;
  slom::BlockSolver* solver = nullptr;
  slom::VarID<mtk::vect<3>> curve = est.insertRV(mtk::vect<3>(1, -1, 0), "curve");
  slom::VarID<double> level = est.insertRV(0.0, "level");

  explicit Fit(const slom::Loss& loss = {}) {
    auto owned = std::make_unique<slom::BlockSolver>();
    solver = owned.get();
    est.changeSolver(std::move(owned));
    est.setThreads(1);
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, 0.01);
    for (int i = 0; i < 40; ++i) {
      const double t = 0.1 * i;
      est.insertMeasurement(Curve(), curve, t, slom::measured(2 * std::exp(-0.7 * t) + 0.3 + noise(random)),
                            slom::StandardDeviation(0.01), loss);
    }
    est.insertMeasurement([](const auto& p, const auto& l) { return p[2] - l; }, curve, level,
                          slom::StandardDeviation(0.1));
  }

  /// Everything that looks at a linearisation.
  void askEverything() {
    static_cast<void>(est.covariance(curve));
    static_cast<void>(est.correlation(curve, level));
    static_cast<void>(est.standardDeviation(level));
    static_cast<void>(est.marginals());
    static_cast<void>(
        est.propagate([](const auto& p, const auto& l) { return p[0] + p[2] * l; }, curve, level));
    static_cast<void>(slom::diagnose(est));
    static_cast<void>(slom::outliers(est));
  }
};

class OneLinearization : public ::testing::TestWithParam<bool> {
 protected:
  slom::Loss loss() const { return GetParam() ? slom::Loss(slom::Huber(2)) : slom::Loss(); }
};

TEST_P(OneLinearization, ServesAllAnalyses) {
  Fit fit(loss());
  const slom::Summary summary = fit.est.optimize();
  ASSERT_TRUE(summary.converged) << summary;
  // The table of parameters has asked already.
  const slom::SolverCounts before = fit.solver->counts();
  evaluations_with_derivatives = 0;
  fit.askEverything();
  fit.askEverything();
  EXPECT_EQ(evaluations_with_derivatives, 0);
  EXPECT_EQ(fit.solver->counts().analyses, before.analyses);
  EXPECT_EQ(fit.solver->counts().factorizations, before.factorizations);
}

TEST_P(OneLinearization, IsMadeOnceForNewValues) {
  Fit fit(loss());
  ASSERT_TRUE(fit.est.optimize().converged);
  const auto ask = [&](const mtk::vect<3>& value, const auto& what) {
    fit.est.reinitRV(fit.curve, value);
    evaluations_with_derivatives = 0;
    what();
    return evaluations_with_derivatives;
  };
  const mtk::vect<3> value = *fit.curve;
  const slom::SolverCounts before = fit.solver->counts();
  const int of_one = ask(value, [&] { static_cast<void>(fit.est.covariance(fit.curve)); });
  EXPECT_GT(of_one, 0);
  EXPECT_EQ(ask(value, [&] { fit.askEverything(); }), of_one);
  EXPECT_EQ(fit.solver->counts().analyses, before.analyses);
  EXPECT_EQ(fit.solver->counts().factorizations, before.factorizations + 2);
}

TEST_P(OneLinearization, LeavesTheFitAsItWouldBe) {
  Fit plain(loss()), asked(loss());
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(plain.est.optimizeStep(), asked.est.optimizeStep());
    asked.askEverything();
    EXPECT_EQ((*plain.curve - *asked.curve).norm(), 0);
    EXPECT_EQ(plain.est.getRSS(), asked.est.getRSS());
  }
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutLosses, OneLinearization, ::testing::Bool());

int differentiated = 0;

struct Between {
  template <class V>
  auto operator()(const V& a, const V& b) const {
    if constexpr (!std::is_same_v<V, vec2>) ++differentiated;
    return b - a;
  }
};

TEST(FreeGauge, IsServedByOneLinearization) {
  slom::Estimator est;
  est.setThreads(1);
  est.setFreeGauge(slom::FreeGauge::inner_constraints);
  est.changeAlgorithm(slom::LevenbergMarquardt());
  std::vector<slom::VarID<vec2>> points;
  for (int i = 0; i < 5; ++i) points.push_back(est.insertRV(vec2(i, 0)));
  for (int i = 1; i < 5; ++i) {
    est.insertMeasurement(Between(), points[std::size_t(i - 1)], points[std::size_t(i)],
                          slom::measured(vec2(1.1, 0.1)), slom::StandardDeviation(0.1));
  }
  est.insertMeasurement(Between(), points[0], points[4], slom::measured(vec2(4, 0)),
                        slom::StandardDeviation(0.1));
  ASSERT_TRUE(est.optimize().converged);
  est.reinitRV(points[0], *points[0]);
  const auto ask = [&] {
    differentiated = 0;
    static_cast<void>(est.covariance(points[1]));
    static_cast<void>(est.standardDeviation(points[2]));
    static_cast<void>(est.jointCovariance(points[0], points[3]));
    static_cast<void>(est.marginals());
    static_cast<void>(slom::diagnose(est));
    static_cast<void>(slom::outliers(est));
    return differentiated;
  };
  EXPECT_EQ(ask(), 5);
  EXPECT_EQ(ask(), 0);
}

/// A query about a component at its bound does not state that the fit holds it there.
TEST(ConstQueries, LeaveTheActiveSetAsItIs) {
  const auto make = [](slom::Estimator& est) {
    const auto x = est.insertRV(1.0, "x");
    const auto y = est.insertRV(0.0, "y");
    est.bound(x, -1, 1);
    est.insertMeasurement([](const auto& a, const auto& b) { return a + b; }, x, y, slom::measured(3.0));
    est.insertMeasurement([](const auto& b) { return b; }, y, slom::measured(0.5));
    return std::pair(x, y);
  };
  slom::Estimator est;
  const auto [x, y] = make(est);
  const slom::Estimator& constant = est;
  EXPECT_EQ(constant.standardDeviation(x)[0], 0);  // at its bound, beyond which the RSS falls
  EXPECT_EQ(slom::diagnose(constant).unknowns, 1);
  // Were the bound active by now, the column of x would be 0 and its derivatives not compared.
  EXPECT_EQ(constant.getN(), 2);
  slom::Estimator fresh;
  const auto [u, v] = make(fresh);
  EXPECT_EQ(est.optimize().iterations, fresh.optimize().iterations);
  EXPECT_EQ(*x, *u);
  EXPECT_EQ(*y, *v);
}

}  // namespace
