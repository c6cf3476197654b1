// Noise in continuous time against its closed forms.
#include <gtest/gtest.h>

#include <slom/filter.hpp>
#include <slom/trajectory.hpp>

#include "random_matrices.hpp"
#include "support/fresh_seed.hpp"

namespace slom::testing {

template <int K>
struct Derivatives {  // a number with its derivatives, all constant but the last
  auto operator()(const auto& x, double dt) const {
    auto y = x;
    double factor = 1;
    for (int order = 1; order < K; ++order) {
      factor *= dt / order;
      for (int i = 0; i + order < K; ++i) y[i] += x[i + order] * factor;
    }
    return y;
  }
};

template <int K, trajectory::WhiteNoise W>
void expectProcessNoise(double dt, double density) {
  mtk::vect<K> densities;
  densities[K - 1] = density;
  const auto Q = trajectory::processNoise<W, 1>(dt, mtk::vect<1>(density));
  const auto check = [&](auto filter) {
    ASSERT_TRUE(filter.predict(Derivatives<K>(), SpectralDensity(densities), Duration(dt)));
    EXPECT_LT((filter.covariance() - Q).norm(), 1e-13 * Q.norm()) << filter.covariance() << "\n\n" << Q;
    for (int i = 0; i < K; ++i) EXPECT_NEAR(filter.covariance()(i, i), Q(i, i), 1e-13 * Q(i, i));
  };
  check(ErrorStateFilter(mtk::vect<K>(), Covariance(0)));
  check(ErrorStateFilter(mtk::vect<K>(), Covariance(0), square_root));
  check(UnscentedFilter(mtk::vect<K>(), Covariance(0)));
}

TEST(SpectralDensity, IsIntegratedExactly) {
  RandomMatrices random(freshSeed());
  for (int i = 0; i < 20; ++i) {
    const double dt = random.uniform(0.001, 10), density = random.uniform(0.1, 10);
    expectProcessNoise<2, trajectory::WhiteNoise::on_acceleration>(dt, density);
    expectProcessNoise<3, trajectory::WhiteNoise::on_jerk>(dt, density);
  }
}

TEST(SpectralDensity, OfAnInputIsThatOfItsMean) {
  const double dt = 0.2, q = 3;
  ErrorStateFilter filter(mtk::vect<1>(0), Covariance(0));
  const auto integrate = [](const auto& x, const auto& w, double rate, double h) {
    auto y = x;
    y[0] += (w[0] + rate) * h;
    return y;
  };
  ASSERT_TRUE(filter.predict(integrate, noiseArgument<1>(SpectralDensity(q)), 1.0, Duration(dt)));
  EXPECT_NEAR(filter.covariance()(0, 0), q * dt, 1e-15);  // a random walk
}

TEST(SpectralDensity, OfACorrelatedBiasGivesItsStationaryVariance) {
  const double sigma = 0.3, tau = 5;
  ErrorStateFilter filter(mtk::vect<1>(0), Covariance(0));
  for (int k = 0; k < 400; ++k) {
    ASSERT_TRUE(
        filter.predict([&](const auto& x, double h) { return mtk::vect(x * filter::correlation(tau, h)); },
                       Covariance(filter::correlatedVariance(sigma, tau, 0.5)), 0.5));
  }
  EXPECT_NEAR(filter.covariance()(0, 0), sigma * sigma, 1e-12);
  EXPECT_NEAR(filter::correlatedVariance(sigma, tau, 1e-15), 2 * sigma * sigma / tau * 1e-15, 1e-30);
}

}  // namespace slom::testing
