// The Schur complement of a chosen set: what its measurements say about the others, without a change of the estimator.
#include "slom/conditional.hpp"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "slom/slom.hpp"

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

/// What a submap says about the three points that it shares with a map, inserted there, makes the map that of all measurements.
TEST(Conditional, JoinsMaps) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    Estimator whole, submap, map;
    const Points inner = insertPoints(submap, 8), seen = insertPoints(submap, 3);
    measure(submap, inner, inner, seed);
    measure(submap, inner, seen, seed + 1);
    const Points shared = insertPoints(map, 3), outer = insertPoints(map, 6);
    measure(map, outer, shared, seed + 2);
    map.prior(shared[0], Point(1, 2), 0.1);
    const Points all_inner = insertPoints(whole, 8), all_shared = insertPoints(whole, 3),
                 all_outer = insertPoints(whole, 6);
    measure(whole, all_inner, all_inner, seed);
    measure(whole, all_inner, all_shared, seed + 1);
    measure(whole, all_outer, all_shared, seed + 2);
    whole.prior(all_shared[0], Point(1, 2), 0.1);

    const std::vector<GaussianPrior> priors = conditional(submap, {inner.begin(), inner.end()});
    ASSERT_FALSE(priors.empty());
    for (const GaussianPrior& prior : priors) {
      std::vector<AnyVarID> own;
      for (const AnyVarID& id : prior.variables()) {
        for (std::size_t k = 0; k < 3; ++k) {
          if (id == AnyVarID(seen[k])) own.emplace_back(shared[k]);
        }
      }
      ASSERT_EQ(own.size(), prior.variables().size());
      map.insertMeasurement(GaussianPrior(own, prior.R(), prior.b()));
    }
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

}  // namespace
}  // namespace slom
