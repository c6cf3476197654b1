// Derivatives of functions of states of many kinds, in double and float.
#include <numbers>

#include <gtest/gtest.h>

#include <mtk/build_manifold.hpp>
#include <slom/filter.hpp>

#include "differences.hpp"
#include "random_matrices.hpp"
#include "support/fresh_seed.hpp"

namespace slom::testing {

MTK_BUILD_MANIFOLD(MacroBody, ((mtk::trafo<mtk::SO3<> >, pose))((mtk::vect<3>, velocity))((mtk::S2<>, up)))

template <class S>
struct ManyOf {  // 60 degrees of freedom: two windows and more
  std::array<mtk::trafo<mtk::SO3<S>>, 10> poses;
};

/// A rotation that is stored in another way than mtk's, without other number types.
struct OwnAngle {
  using scalar = double;
  static constexpr int DOF = 1;
  double degrees = 0;
  void boxplus(mtk::vectview<const double, 1> d, double scale = 1) {
    degrees += scale * d[0] * 180 / std::numbers::pi;
  }
  void boxminus(mtk::vectview<double, 1> out, const OwnAngle& y) const {
    out[0] = (degrees - y.degrees) * std::numbers::pi / 180;
  }
};

template <class State, class F>
void expectDerivative(const State& x, const F& f, double tolerance) {
  constexpr int n = mtk::DOF_v<State>;
  const State y = f(x);
  detail::SquareMatrix<double, n> exact;
  detail::linearizeMotion(exact, f, y, std::tuple<const State&>(x));
  const auto numeric =
      byDifferences<n>(x, [&](const State& moved) { return mtk::difference<State>(f(moved), y); });
  EXPECT_LT((exact - numeric).norm(), tolerance * (1 + exact.norm()));
}

TEST(FilterDerivatives, AreThoseOfDifferences) {
  RandomMatrices random(freshSeed());
  for (int i = 0; i < 10; ++i) {
    MacroBody body;
    body.pose = mtk::trafo<mtk::SO3<>>(mtk::SO3<>::exp(random.vector<3>()), random.vector<3>());
    body.velocity = random.vector<3>();
    body.up = mtk::S2<>(random.vector<3>());
    const mtk::SO3<> turn = mtk::SO3<>::exp(random.vector<3>());
    expectDerivative(
        body,
        [&](const auto& x) {
          auto y = x;
          y.pose.pos = x.pose.pos + x.pose.orient * x.velocity;
          y.pose.orient = x.pose.orient * turn;
          y.up = x.pose.orient * x.up;
          return y;
        },
        1e-9);
    ManyOf<double> many;
    for (auto& pose : many.poses)
      pose = mtk::trafo<mtk::SO3<>>(mtk::SO3<>::exp(random.vector<3>()), random.vector<3>());
    expectDerivative(
        many,
        [](const auto& x) {
          auto y = x;
          for (std::size_t k = 1; k < x.poses.size(); ++k) y.poses[k] = x.poses[k - 1] * x.poses[k];
          return y;
        },
        1e-8);
    expectDerivative(
        OwnAngle{random.normal()}, [](const OwnAngle& x) { return OwnAngle{x.degrees * x.degrees / 30}; },
        1e-9);
  }
}

TEST(FilterDerivatives, OfRotationsByHalfATurn) {
  const mtk::SO3<> half = mtk::SO3<>::exp(mtk::vect<3>(std::numbers::pi, 0, 0));
  ErrorStateFilter filter(half, StandardDeviation(0.1));
  const auto turn = [&](const auto& x) { return x * half; };
  ASSERT_TRUE(filter.predict(turn, Covariance(0)));
  EXPECT_LT((filter.covariance() - 0.01 * Eigen::Matrix3d::Identity()).norm(), 1e-15);
}

/// A filter in float follows the one in double.
template <class S>
auto run() {
  using Pair = filter::AttitudeState<S>;
  ErrorStateFilter filter(Pair{}, StandardDeviation(0.1));
  for (int k = 0; k < 100; ++k) {
    const mtk::vect<3, S> gyro(S(0.1), S(-0.2), S(0.3)), force(S(0.1), S(0.2), S(9.8)),
        field(S(1), S(14), S(-38));
    EXPECT_TRUE(filter.predict(filter::AttitudeMotion(), Covariance(1e-4), gyro, force, S(9.81), S(0.01)));
    EXPECT_TRUE(filter.update(filter::EarthField(), field, StandardDeviation(10)));
    EXPECT_TRUE(filter.update([](const auto& x) { return x.velocity; },
                              measured(mtk::vect<3, S>(S(0), S(0), S(0))), StandardDeviation(1)));
  }
  return filter;
}
TEST(FilterDerivatives, InFloatAreThoseInDouble) {
  const auto d = run<double>();
  const auto f = run<float>();
  static_assert(std::is_same_v<decltype(f)::scalar, float>);
  const auto P = d.covariance();
  for (int i = 0; i < 11; ++i) {
    for (int j = 0; j < 11; ++j)
      EXPECT_NEAR(f.covariance()(i, j), P(i, j), 1e-4 * std::sqrt(P(i, i) * P(j, j)));
  }
  EXPECT_NEAR(f.state().orient.x(), d.state().orient.x(), 1e-5);
}

}  // namespace slom::testing
