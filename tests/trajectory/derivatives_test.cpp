// Derivatives of segments by control points and by time: dual numbers compared with differences in long double.
#include <cmath>

#include <gtest/gtest.h>

#include "trajectory/random_segments.hpp"

namespace slom {
namespace {

using testing::forEachOrder;
using testing::Long;
using trajectory::Knots;
using trajectory::PoseSegment;
using trajectory::ScrewSegment;

constexpr int kOutputs = 21;

/// All that a segment of poses returns, the orientation as the rotation from `reference`.
template <class Segment, class Time, class Reference>
auto outputs(const Segment& segment, const Time& t, const Reference& reference) {
  const auto turn = reference.inverse() * segment.orientationAt(t);
  const auto angles = std::remove_cvref_t<decltype(turn)>::log(turn);
  mtk::vect<kOutputs, std::remove_cvref_t<decltype(angles[0])>> all;
  int at = 0;
  const auto append = [&](const auto& v) {
    for (int i = 0; i < 3; ++i) all[at++] = v[i];
  };
  append(segment.poseAt(t).pos);
  append(angles);
  append(segment.velocityAt(t));
  append(segment.accelerationAt(t));
  append(segment.bodyAccelerationAt(t));
  append(segment.angularVelocityAt(t));
  append(segment.angularAccelerationAt(t));
  return all;
}

/// The outputs over dual numbers whose columns are the components of the control points, then the time.
template <class Segment>
auto dualOutputs(const Knots& knots, std::int64_t i, const std::vector<mtk::trafo<mtk::SO3<>>>& controls,
                 double t, const mtk::SO3<>& reference) {
  constexpr int columns = 6 * Segment::order + 1;
  using D = mtk::Dual<double, columns>;
  using Over = typename Segment::template Over<D>;
  typename Over::Controls own;
  for (int j = 0; j < Segment::order; ++j) {
    own[static_cast<std::size_t>(j)] = mtk::detail::seededAs<mtk::trafo<mtk::SO3<D>>>(
        controls[static_cast<std::size_t>(i + j)], 6 * j, columns);
  }
  D time;
  time.seed(t, columns - 1);
  return outputs(Over(trajectory::Blending<Segment::order>(knots, i), own), time, reference);
}

template <class Segment>
void expectExactDerivatives(const Knots& knots, std::int64_t i,
                            const std::vector<mtk::trafo<mtk::SO3<>>>& controls, double t, double tolerance) {
  const mtk::SO3<> reference = testing::segmentOf<Segment>(knots, i, controls).orientationAt(t);
  const auto duals = dualOutputs<Segment>(knots, i, controls, t, reference);
  const auto precise = testing::precise(reference);
  // Column c moved by d, in long double.
  const auto moved = [&](int c, Long d) {
    using Over = typename Segment::template Over<Long>;
    typename Over::Controls own;
    for (int j = 0; j < Segment::order; ++j) {
      auto& control = own[static_cast<std::size_t>(j)];
      control = testing::precise(controls[static_cast<std::size_t>(i + j)]);
      if (c / 6 == j) mtk::boxplus(control, mtk::vect<6, Long>(d * mtk::vect<6, Long>::Unit(c % 6)));
    }
    const bool is_time = c == 6 * Segment::order;
    return outputs(Over(trajectory::Blending<Segment::order>(knots, i), own), is_time ? t + d : Long(t),
                   precise);
  };
  for (int c = 0; c <= 6 * Segment::order; ++c) {
    const auto slope = testing::derivativeOf([&](Long d) { return moved(c, d); }, 0);
    for (int k = 0; k < kOutputs; ++k) {
      EXPECT_NEAR(duals[k].partial(c), double(slope[k]), tolerance * (1 + double(slope.norm())))
          << "output " << k << ", column " << c;
    }
  }
}

TEST(Segments, HaveExactDerivatives) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    mtk::testing::Random random(seed);
    const Knots knots = testing::randomKnots(random, seed);
    const auto poses = testing::randomControls<mtk::trafo<mtk::SO3<>>>(random, 12);
    forEachOrder([&]<int N>() {
      SCOPED_TRACE("order " + std::to_string(N));
      const double t = random.uniform(knots[2], knots[5]);  // also outside segment 3
      expectExactDerivatives<PoseSegment<N>>(knots, 3, poses, t, 1e-8);
      expectExactDerivatives<ScrewSegment<N>>(knots, 3, poses, t, 1e-8);
    });
  }
}

TEST(Segments, HaveExactDerivativesForEqualControlPoints) {
  const Knots knots(0, 1);
  const std::vector<mtk::trafo<mtk::SO3<>>> poses(
      4, {mtk::vect<3>(1, 2, 3), mtk::SO3<>::exp(mtk::vect<3>(1, 0, -1))});
  expectExactDerivatives<PoseSegment<4>>(knots, 0, poses, 0.4, 1e-8);
  expectExactDerivatives<ScrewSegment<4>>(knots, 0, poses, 0.4, 1e-8);
}

}  // namespace
}  // namespace slom
