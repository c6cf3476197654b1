// The Schur complement of a chosen set: the information of its measurements on the others, without changing the
// estimator.
#include "slom/conditional.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "slom/slom.hpp"
#include "support/message_of.hpp"

namespace slom {
namespace {

using Point = mtk::vect<2>;
using Points = std::vector<VarID<Point>>;

Points insertPoints(Estimator& est, int count) {
  Points points;
  for (int i = 0; i < count; ++i) points.push_back(est.insertRV(Point(i, 0)));
  return points;
}

/// Differences with random data between each of `a` and some of `b`, the first one among them.
void measure(Estimator& est, const Points& a, const Points& b, unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
  for (const auto& p : a) {
    for (const auto& q : b) {
      const double x = uniform(), y = uniform(), sigma = 1.5 + uniform();
      if (p == q || (x > 0.3 && !(q == b.front()))) continue;
      est.insertMeasurement([](const auto& u, const auto& v) { return v - u; }, p, q, measured(Point(x, y)),
                            StandardDeviation(sigma));
    }
  }
}

/// As docs/windows.md shows it.
template <class F>
void joinMaps(const Estimator& submap, const std::vector<AnyVarID>& inner, Estimator& joined,
              const F& counterpartOf) {
  for (const slom::GaussianPrior& prior : slom::conditional(submap, inner)) {
    std::vector<slom::AnyVarID> same;
    for (const slom::AnyVarID& id : prior.variables()) same.push_back(counterpartOf(id));
    joined.insertMeasurement(prior.over(same));
  }
}

/// A submap shares three points with a map. Its information on these points, inserted into the map, gives the map of
/// all measurements.
TEST(Conditional, JoinsMaps) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    Estimator whole, submap, map;
    const Points inner = insertPoints(submap, 8), seen = insertPoints(submap, 3);
    measure(submap, inner, inner, seed);
    measure(submap, inner, seen, seed + 1);
    const Points shared = insertPoints(map, 3), outer = insertPoints(map, 6);
    measure(map, outer, shared, seed + 2);
    map.prior(shared[0], Point(1, 2), 0.1);
    for (const auto& p : shared)
      map.reinitRV(p, *p + Point(3, -2));  // the priors say where they were linearised
    const Points all_inner = insertPoints(whole, 8), all_shared = insertPoints(whole, 3),
                 all_outer = insertPoints(whole, 6);
    measure(whole, all_inner, all_inner, seed);
    measure(whole, all_inner, all_shared, seed + 1);
    measure(whole, all_outer, all_shared, seed + 2);
    whole.prior(all_shared[0], Point(1, 2), 0.1);

    const auto counterpartOf = [&](const AnyVarID& id) {
      return shared.at(std::size_t(std::find(seen.begin(), seen.end(), id) - seen.begin()));
    };
    joinMaps(submap, {inner.begin(), inner.end()}, map, counterpartOf);
    ASSERT_TRUE(whole.optimize().converged);
    ASSERT_TRUE(map.optimize().converged);
    const auto expectSame = [&](const Points& a, const Points& b) {
      for (std::size_t k = 0; k < a.size(); ++k) {
        EXPECT_LT((*a[k] - *b[k]).norm(), 1e-11) << "seed " << seed;
        const Eigen::MatrixXd C = whole.covariance(a[k]);
        EXPECT_LT((C - map.covariance(b[k])).norm(), 1e-11 * C.norm()) << "seed " << seed;
      }
    };
    expectSame(all_shared, shared);
    expectSame(all_outer, outer);
  }
}

TEST(Conditional, ChangesNothingAndIsWhatMarginalizationLeaves) {
  Estimator est;
  const Points inner = insertPoints(est, 6), rest = insertPoints(est, 4);
  measure(est, inner, inner, 1);
  measure(est, inner, rest, 2);
  const std::vector<AnyVarID> ids(inner.begin(), inner.end());
  const int residuals = est.getM();
  const double rss = est.getRSS();
  const std::vector<GaussianPrior> priors = conditional(est, ids);
  EXPECT_EQ(est.getM(), residuals);
  EXPECT_EQ(est.getRSS(), rss);
  const auto left = est.marginalize(ids);
  ASSERT_EQ(left.size(), priors.size());
  double constant = 0;
  for (const GaussianPrior& prior : priors) constant += prior.b().squaredNorm();
  EXPECT_EQ(est.getRSS(), constant);
}

TEST(Conditional, ItsPriorsRefuseOtherVariablesThatDoNotFit) {
  Estimator submap, map;
  const Points inner = insertPoints(submap, 1), seen = insertPoints(submap, 1), own = insertPoints(map, 2);
  measure(submap, inner, seen, 1);
  submap.prior(inner[0], Point(1, 2), 0.1);
  const std::vector<GaussianPrior> priors = conditional(submap, {inner[0]});
  ASSERT_EQ(priors.size(), 1u);
  EXPECT_EQ(testing::messageOf([&] {
              priors[0].over({own[0], own[1]});
            }),
            "[slom.prior-size] the GaussianPrior over 1 variable with 2 degrees of freedom was given 2 other "
            "variables; pass one for each of its variables, in their order");
  EXPECT_EQ(
      testing::messageOf([&] { priors[0].over({map.insertRV(1.0)}); }),
      "[slom.wrong-type] variable 0 of the GaussianPrior over 1 variable with 2 degrees of freedom is a "
      "vect<2>, it was given a double; pass variables of the same types, in their order");
  EXPECT_EQ(priors[0].over({own[0]}).R(), priors[0].R());
}

}  // namespace
}  // namespace slom
