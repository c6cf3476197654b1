// An estimator that was moved from throws, whatever is asked of it, and takes another one by assignment.
#include <sstream>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <slom/archive.hpp>
#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace {

using slom::testing::messageOf;
using vec2 = mtk::vect<2>;

TEST(MovedFrom, EveryCallThrowsASentence) {
  slom::Estimator est;
  const auto x = est.insertRV(vec2(1, 2), "x");
  const auto m = est.insertMeasurement([](const auto& v) { return v[0] + v[1] - 1.0; }, x);
  est.prior(x, vec2(), 1);
  slom::Estimator other = std::move(est);
  const auto level = [](const auto& v) { return v[0]; };
  const std::vector<std::function<void()>> calls{
      [&] { est.insertRV(1.0); },
      [&] { est.insertRV(vec2(), "y"); },
      [&] { est.reinitRV(x, vec2()); },
      [&] { est.optimizeRV(x, false); },
      [&] { est.fix(x); },
      [&] { est.fix(x, "x"); },
      [&] { est.free(x); },
      [&] { est.free(x, "x"); },
      [&] { est.bound(x, "x", 0, 1); },
      [&] { est.prior(x, vec2(), 1); },
      [&] { est.removeRV(x); },
      [&] { est.nameOf(x); },
      [&] { est.insertMeasurement(level, x); },
      [&] { est.removeMeasurement(m); },
      [&] { est.optimizeStep(); },
      [&] { est.optimize(); },
      [&] { est.changeAlgorithm(slom::DogLeg()); },
      [&] { est.changeSolver(std::make_unique<slom::BlockSolver>()); },
      [&] { est.setThreads(1); },
      [&] { est.getRSS(); },
      [&] { est.getRSS(m); },
      [&] { est.getRSS(x); },
      [&] { est.weight(m); },
      [&] { est.getRMS(); },
      [&] { est.getM(); },
      [&] { est.getN(); },
      [&] { est.residual(m); },
      [&] { est.whitenedResidual(m); },
      [&] { est.residuals(); },
      [&] { est.covariance(x); },
      [&] { est.standardDeviation(x); },
      [&] { est.correlation(x, x); },
      [&] { est.marginals(); },
      [&] { est.propagate(level, x); },
      [&] { est.setSigma(slom::Sigma::estimated); },
      [&] { est.sigma(); },
      [&] { est.setFreeGauge(slom::FreeGauge::error); },
      [&] { est.freeGauge(); },
      [&] { est.componentNames(x); },
      [&] { slom::diagnose(est); },
      [&] { slom::preflight(est); },
      [&] { slom::profile(est, x, "x"); },
      [&] { slom::outliers(est); },
      [&] { slom::checkDerivatives(est); },
      [&] { est.warnings(); },
      [&] {
        std::ostringstream os;
        slom::Archive().save(est, os);
      },
  };
  for (std::size_t i = 0; i < calls.size(); ++i) {
    EXPECT_EQ(
        messageOf(calls[i]),
        "[slom.moved-from] the estimator has been moved from and holds nothing; use the one that it was moved "
        "to, or assign another one to it")
        << "call " << i;
  }
  EXPECT_TRUE(other.optimize().converged);
  EXPECT_EQ(other.getRSS(m), std::pow((*x)[0] + (*x)[1] - 1, 2));
}

TEST(MovedFrom, TakesAnotherEstimator) {
  slom::Estimator est, spare;
  est.insertRV(1.0);
  spare.insertRV(vec2());
  slom::Estimator other = std::move(est);
  est = slom::Estimator();
  EXPECT_EQ(est.getN(), 0);
  est = std::move(other);
  EXPECT_EQ(est.getN(), 1);
  spare = std::move(est);  // what it constrained is gone, and not in the one that was moved from
  EXPECT_EQ(spare.getN(), 1);
  EXPECT_NE(messageOf([&] { est.getN(); }).find("[slom.moved-from]"), std::string::npos);
  slom::Estimator& same = spare;
  spare = std::move(same);
  EXPECT_EQ(spare.getN(), 1);
}

}  // namespace
