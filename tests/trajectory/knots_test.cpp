// Knots, segments and weights, compared with the recursion of Cox and de Boor in long double.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/message_of.hpp"
#include "trajectory/random_segments.hpp"

namespace slom {
namespace {

using testing::forEachOrder;
using testing::Long;
using testing::messageOf;
using trajectory::Blending;
using trajectory::Knots;

/// B of control point i at t, by the definition. `order` knots after knot i - order + 1 end its support.
Long basis(const Knots& knots, std::int64_t i, int order, Long t) {
  const std::int64_t first = i - order + 1;
  const auto knot = [&](std::int64_t k) { return Long(knots[k]); };
  if (order == 1) return t >= knot(i) && t < knot(i + 1) ? 1 : 0;
  const Long rising = (t - knot(first)) / (knot(first + order - 1) - knot(first));
  const Long falling = (knot(first + order) - t) / (knot(first + order) - knot(first + 1));
  return rising * basis(knots, i - 1, order - 1, t) + falling * basis(knots, i, order - 1, t);
}

TEST(Knots, ContinueBeyondTheirEnds) {
  const Knots uniform(10, 0.5), others({1, 2, 4, 7});
  EXPECT_TRUE(uniform.isUniform());
  EXPECT_FALSE(others.isUniform());
  EXPECT_EQ(uniform[0], 10);
  EXPECT_EQ(uniform[-4], 8);
  EXPECT_EQ(others[2], 4);
  EXPECT_EQ(others[-2], -1);
  EXPECT_EQ(others[5], 13);
}

TEST(Knots, HaveASegmentForEachTime) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    mtk::testing::Random random(seed);
    const Knots knots = testing::randomKnots(random, seed);
    for (std::int64_t i = -40; i < 40; ++i) {
      EXPECT_EQ(knots.segmentAt(knots[i]), i);
      EXPECT_EQ(knots.segmentAt(std::nextafter(knots[i], -1e9)), i - 1);
      EXPECT_EQ(knots.segmentAt(knots[i] + random.uniform(0.01, 0.99) * (knots[i + 1] - knots[i])), i);
    }
  }
}

TEST(Knots, OfEpochTimes) {
  const Knots knots(0, 0.005);
  const double now = 1.75e9 + 0.1234;
  const std::int64_t i = knots.segmentAt(now);
  EXPECT_LE(knots[i], now);
  EXPECT_GT(knots[i + 1], now);
}

TEST(Knots, OfAControlPoint) {
  EXPECT_EQ(Knots(0, 1).timeOfControl(5, 4), 4);    // knots 3, 4, 5
  EXPECT_EQ(Knots(0, 1).timeOfControl(5, 3), 4.5);  // knots 4, 5
  EXPECT_EQ(Knots({0, 1, 3, 7}).timeOfControl(3, 4), 11.0 / 3);
}

TEST(Knots, RefuseBadTimes) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(messageOf([&] { Knots(nan, 1); }),
            "[slom.bad-knots] the first knot is at nan; pass a finite time");
  EXPECT_EQ(messageOf([&] { Knots(0, 0); }),
            "[slom.bad-knots] the spacing of the knots is 0; pass a positive and finite number");
  EXPECT_EQ(messageOf([&] { Knots(0, inf); }),
            "[slom.bad-knots] the spacing of the knots is inf; pass a positive and finite number");
  EXPECT_EQ(messageOf([&] { Knots({1}); }),
            "[slom.bad-knots] the number of knots is 1; pass at least 2, or a start and a spacing");
  EXPECT_EQ(messageOf([&] { Knots({1, 2, nan}); }), "[slom.bad-knots] knot 2 is at nan; pass finite times");
  EXPECT_EQ(messageOf([&] {
              Knots({1, 2, 2});
            }),
            "[slom.bad-knots] knot 2 is at 2, not after knot 1 at 2; sort the knots and remove equal ones");
  EXPECT_EQ(messageOf([&] { Knots(0, 1).segmentAt(nan); }),
            "[slom.bad-time] the time on a spline is nan; pass a finite number");
  EXPECT_EQ(
      messageOf([&] { Knots(0, 1e-9).segmentAt(1e12); }),
      "[slom.bad-time] the time 1e+12 is more than 2^52 knots away from the knot at 0; pass a time near the knots, "
      "in their unit");
}

TEST(Blending, IsTheSumOfTheBasisFunctions) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    mtk::testing::Random random(seed);
    const Knots knots = testing::randomKnots(random, seed);
    forEachOrder([&]<int N>() {
      for (std::int64_t i = -2; i < 14; ++i) {
        const Blending<N> blending(knots, i);
        const Long t = knots[i] + random.uniform(0, 1) * (knots[i + 1] - knots[i]);
        const auto b = blending.at(t);
        Long sum = 0;
        for (int j = N - 1; j >= 0; --j) {
          sum += basis(knots, i + j, N, t);
          EXPECT_NEAR(double(sum), j > 0 ? double(b[static_cast<std::size_t>(j - 1)]) : 1, 1e-14)
              << "order " << N << ", segment " << i << ", weight " << j;
        }
      }
    });
  }
}

TEST(Blending, OfEqualSpacingsIsThatOfUniformKnots) {
  std::vector<double> times;
  for (int i = 0; i < 20; ++i) times.push_back(3 + 0.25 * i);
  forEachOrder([&]<int N>() {
    for (std::int64_t i = -5; i < 25; ++i) {
      const auto a = Blending<N>(Knots(3, 0.25), i).at(3.1 + 0.25 * double(i));
      const auto b = Blending<N>(Knots(times), i).at(3.1 + 0.25 * double(i));
      for (std::size_t j = 0; j < a.size(); ++j) EXPECT_NEAR(a[j], b[j], 1e-15);
    }
  });
}

TEST(Blending, HasTheDerivativesOfItsWeights) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    mtk::testing::Random random(seed);
    const Knots knots = testing::randomKnots(random, seed);
    forEachOrder([&]<int N>() {
      const Blending<N> blending(knots, 4);
      const double t = random.uniform(knots[3], knots[6]);  // also outside the segment
      const auto rate = blending.template at<1>(Long(t)), curvature = blending.template at<2>(Long(t));
      mtk::Dual<double, 1> moving;
      moving.seed(t, 0);
      const auto dual = blending.template at<1>(moving);
      for (std::size_t j = 0; j < rate.size(); ++j) {
        const auto number = [&](Long x) { return mtk::vect<1, Long>(blending.at(x)[j]); };
        const auto slope = [&](Long x) { return mtk::vect<1, Long>(blending.template at<1>(x)[j]); };
        EXPECT_NEAR(double(rate[j]), double(testing::derivativeOf(number, t)[0]),
                    1e-9 * (1 + std::abs(double(rate[j]))));
        EXPECT_NEAR(double(curvature[j]), double(testing::derivativeOf(slope, t)[0]),
                    1e-9 * (1 + std::abs(double(curvature[j]))));
        EXPECT_NEAR(dual[j].value(), double(rate[j]), 1e-12 * (1 + std::abs(double(rate[j]))));
        EXPECT_NEAR(dual[j].partial(0), double(curvature[j]), 1e-11 * (1 + std::abs(double(curvature[j]))));
      }
    });
  }
}

}  // namespace
}  // namespace slom
