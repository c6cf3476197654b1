// Messages about a problem before it is solved, word for word.
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

namespace {

using Texts = std::vector<std::string>;
using vec2 = mtk::vect<2>;

TEST(Preflight, OfASoundProblem) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0, "x");
  for (const double z : {1.0, 2.0, 4.0})
    est.insertMeasurement([z](const auto& v) { return v - z; }, x, slom::named("sample"));
  const slom::Preflight preflight = slom::preflight(est);
  EXPECT_TRUE(preflight.ok());
  EXPECT_EQ(
      preflight.text(),
      "ready to be solved\n  sample: 3 measurements, RSS 10; the worst is sample #3 with 3 standard deviations\n");
  EXPECT_EQ(*x, 1);
}

TEST(Preflight, NamesWhatCannotBeEvaluated) {
  slom::Estimator est;
  const auto x = est.insertRV(-1.0, "x");
  for (const double z : {1.0, std::nan(""), 2.0})
    est.insertMeasurement([z](const auto& v) { return v - z; }, x, slom::named("datum"));
  using std::log;
  est.insertMeasurement([](const auto& v) { return log(v); }, x, slom::named("logarithm"));
  est.insertMeasurement([](double v) -> double { return v < 0 ? throw std::runtime_error("negative") : v; },
                        x, slom::named("guard"));
  EXPECT_EQ(
      slom::preflight(est).faults,
      (Texts{
          "the residual of datum #2 is not finite at x = (-1); check data, start values, and where the function divides, takes "
          "roots or logarithms",
          "the residual of logarithm #1 is not finite at x = (-1); check data, start values, and where the function divides, "
          "takes roots or logarithms",
          "the residual of guard #1 cannot be evaluated, because its function throws at x = (-1); check data, start values, "
          "and where the function divides, takes roots or logarithms"}));
}

struct WrongSign {
  double operator()(double x) const { return 3 * x; }
  void jacobian(double, auto& by_x) const { by_x(0, 0) = -3; }
};

TEST(Preflight, FindsWrongDerivativesAndMissingMeasurements) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0, "x");
  const auto p = est.insertRV(vec2(1, 2), "p");
  est.insertMeasurement([](const auto& v) { return v[0] + v[1]; }, p);
  est.insertMeasurement([](const auto& v) { return v - 1; }, x);
  EXPECT_EQ(
      slom::preflight(est).faults,
      (Texts{
          "there are 2 residuals for 3 unknowns: add measurements or priors, or fix variables",
          "fewer residuals than unknowns depend on p (1 for 2): add measurements or a prior, or fix what they lack",
          "p.x and p.y cannot be told apart: moving them by +1 and -1 changes no residual, to first order; fix one of them, or add a prior or "
          "measurements that depend on them in another way"}));
  est.insertRV(0.0, "idle");
  EXPECT_EQ(
      slom::preflight(est).faults[0],
      "no measurement depends on variable idle, so nothing determines it; add measurements or fix it with fix(id)");
}

TEST(Preflight, ChecksTheUsersDerivatives) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0, "x");
  est.insertMeasurement(WrongSign(), x);
  EXPECT_EQ(
      slom::preflight(est).faults,
      Texts{
          "the given derivative of residual 0 of WrongSign #1 by x is -3, differences give 3: the sign is wrong"});
}

}  // namespace
