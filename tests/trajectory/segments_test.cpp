// Values, velocities and accelerations of segments, compared with differences in long double, and with curves that
// splines reproduce exactly.
#include <cmath>

#include <gtest/gtest.h>

#include "trajectory/random_segments.hpp"

namespace slom {
namespace {

using testing::derivativeOf;
using testing::forEachOrder;
using testing::Long;
using testing::preciseSegment;
using testing::segmentOf;
using trajectory::Knots;
using trajectory::PoseSegment;
using trajectory::RotationSegment;
using trajectory::ScrewSegment;
using trajectory::VectorSegment;

template <class A, class B>
void expectNear(const A& a, const B& b, double tolerance, const char* what) {
  const Long error = (a.template cast<Long>() - b.template cast<Long>()).norm();
  EXPECT_LE(double(error), tolerance * (1 + double(b.template cast<Long>().norm()))) << what;
}

template <class Segment>
void expectRatesOfARotation(const Segment& segment, double t, double tolerance) {
  const auto R = [&](Long x) { return segment.orientationAt(x); };
  const auto w = [&](Long x) { return segment.angularVelocityAt(x); };
  const auto world = [&](Long x) { return segment.worldAngularVelocityAt(x); };
  expectNear(w(t), derivativeOf(R, t), tolerance, "angular velocity");
  expectNear(segment.angularAccelerationAt(Long(t)), derivativeOf(w, t), tolerance, "angular acceleration");
  expectNear(world(t), segment.orientationAt(Long(t)) * derivativeOf(R, t), tolerance, "in the world");
  expectNear(segment.worldAngularAccelerationAt(Long(t)), derivativeOf(world, t), tolerance, "in the world");
}

template <class Segment>
void expectRatesOfAPose(const Segment& segment, double t, double tolerance) {
  expectRatesOfARotation(segment, t, tolerance);
  const auto p = [&](Long x) { return segment.positionAt(x); };
  const auto v = [&](Long x) { return segment.velocityAt(x); };
  const auto back = segment.orientationAt(Long(t)).inverse();
  expectNear(segment.poseAt(Long(t)).pos, p(t), 0, "position");
  expectNear(v(t), derivativeOf(p, t), tolerance, "velocity");
  expectNear(segment.accelerationAt(Long(t)), derivativeOf(v, t), tolerance, "acceleration");
  expectNear(segment.bodyVelocityAt(Long(t)), back * v(t), tolerance, "body velocity");
  expectNear(segment.bodyAccelerationAt(Long(t)), back * segment.accelerationAt(Long(t)), tolerance,
             "body acceleration");
}

TEST(Segments, HaveTheRatesOfTheirCurves) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    mtk::testing::Random random(seed);
    const Knots knots = testing::randomKnots(random, seed);
    const auto poses = testing::randomControls<mtk::trafo<mtk::SO3<>>>(random, 12);
    const auto rotations = testing::randomControls<mtk::SO3<>>(random, 12);
    forEachOrder([&]<int N>() {
      SCOPED_TRACE("order " + std::to_string(N));
      const double t = random.uniform(knots[2], knots[5]);  // also outside segment 3
      expectRatesOfARotation(preciseSegment<RotationSegment<N>>(knots, 3, rotations), t, 2e-8);
      expectRatesOfAPose(preciseSegment<PoseSegment<N>>(knots, 3, poses), t, 2e-8);
      expectRatesOfAPose(preciseSegment<ScrewSegment<N>>(knots, 3, poses), t, 2e-8);
    });
  }
}

TEST(Segments, OfDoublesAreThoseOfLongDoubles) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    mtk::testing::Random random(seed);
    const Knots knots = testing::randomKnots(random, seed);
    const auto poses = testing::randomControls<mtk::trafo<mtk::SO3<>>>(random, 12);
    forEachOrder([&]<int N>() {
      const double t = random.uniform(knots[3], knots[4]);
      const auto compare = [&](const auto& a, const auto& b) {
        expectNear(a.poseAt(t).pos, b.poseAt(t).pos, 1e-13, "position");
        expectNear(a.orientationAt(t).coeffs(), b.orientationAt(t).coeffs(), 1e-13, "orientation");
        expectNear(a.accelerationAt(t), b.accelerationAt(t), 1e-12, "acceleration");
        expectNear(a.angularAccelerationAt(t), b.angularAccelerationAt(t), 1e-12, "angular acceleration");
      };
      compare(segmentOf<PoseSegment<N>>(knots, 3, poses), preciseSegment<PoseSegment<N>>(knots, 3, poses));
      compare(segmentOf<ScrewSegment<N>>(knots, 3, poses), preciseSegment<ScrewSegment<N>>(knots, 3, poses));
    });
  }
}

/// N - 2 derivatives are continuous at knots, of which up to the second are compared.
template <class Segment, class Control>
void expectContinuity(const Knots& knots, const std::vector<Control>& controls) {
  constexpr int N = Segment::order;
  const double t = knots[4];
  const auto a = segmentOf<Segment>(knots, 3, controls), b = segmentOf<Segment>(knots, 4, controls);
  expectNear(a.positionAt(t), b.positionAt(t), 1e-12, "position");
  expectNear(mtk::difference(a.orientationAt(t), b.orientationAt(t)), mtk::vect<3>(), 1e-12, "orientation");
  if (N >= 3) expectNear(a.velocityAt(t), b.velocityAt(t), 1e-11, "velocity");
  if (N >= 3) expectNear(a.angularVelocityAt(t), b.angularVelocityAt(t), 1e-11, "angular velocity");
  if (N >= 4) expectNear(a.accelerationAt(t), b.accelerationAt(t), 1e-10, "acceleration");
  if (N >= 4)
    expectNear(a.angularAccelerationAt(t), b.angularAccelerationAt(t), 1e-10, "angular acceleration");
  const double jump = (a.accelerationAt(t) - b.accelerationAt(t)).norm();
  if (N == 3) {
    EXPECT_GT(jump, 1e-3);
  }
}

TEST(Segments, JoinAtTheirKnots) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    mtk::testing::Random random(seed);
    const Knots knots = testing::randomKnots(random, seed);
    const auto poses = testing::randomControls<mtk::trafo<mtk::SO3<>>>(random, 12);
    forEachOrder([&]<int N>() {
      SCOPED_TRACE("order " + std::to_string(N));
      expectContinuity<PoseSegment<N>>(knots, poses);
      expectContinuity<ScrewSegment<N>>(knots, poses);
    });
  }
}

/// The control point i of (t - a)^(N - 1): the polar form at its knots (blossom).
double controlOfPower(const Knots& knots, std::int64_t i, int order, double a) {
  double product = 1;
  for (int k = 0; k + 1 < order; ++k) product *= knots[i - k] - a;
  return product;
}

TEST(VectorSegment, ReproducesPolynomials) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    mtk::testing::Random random(seed);
    const Knots knots = testing::randomKnots(random, seed);
    forEachOrder([&]<int N>() {
      const double roots[] = {random.uniform(-5, 5), random.uniform(-5, 5)};
      std::vector<mtk::vect<2>> controls;
      for (int i = 0; i < 12; ++i) {
        controls.emplace_back(controlOfPower(knots, i, N, roots[0]), controlOfPower(knots, i, N, roots[1]));
      }
      const double t = random.uniform(knots[2], knots[5]);
      const auto segment = segmentOf<VectorSegment<2, N>>(knots, 3, controls);
      const double scale = std::pow(15, N - 1) * 1e-12;
      for (int k = 0; k < 2; ++k) {
        const double x = t - roots[k];
        EXPECT_NEAR(segment.at(t)[k], std::pow(x, N - 1), scale);
        EXPECT_NEAR(segment.velocityAt(t)[k], (N - 1) * std::pow(x, N - 2), 10 * scale);
        EXPECT_NEAR(segment.accelerationAt(t)[k], N > 2 ? (N - 1) * (N - 2) * std::pow(x, N - 3) : 0,
                    100 * scale);
      }
    });
  }
}

TEST(Segments, ReproduceMotionsOfConstantRate) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    mtk::testing::Random random(seed);
    const Knots knots = testing::randomKnots(random, seed);
    const trajectory::Twist<double> twist{testing::randomVector(random, 1), testing::randomVector(random, 1)};
    forEachOrder([&]<int N>() {
      const auto truth = [&](double t) { return trajectory::detail::screwExp<double>(twist.times(t)); };
      std::vector<mtk::trafo<mtk::SO3<>>> controls;
      for (int i = 0; i < 12; ++i) controls.push_back(truth(knots.timeOfControl(i, N)));
      const double t = random.uniform(knots[3], knots[4]);
      const auto screw = segmentOf<ScrewSegment<N>>(knots, 3, controls);
      const auto pose = segmentOf<PoseSegment<N>>(knots, 3, controls);
      expectNear(mtk::difference(screw.poseAt(t), truth(t)), mtk::vect<6>(), 2e-12, "pose");
      expectNear(screw.bodyVelocityAt(t), twist.linear, 2e-12, "velocity");
      expectNear(screw.angularVelocityAt(t), twist.angular, 2e-12, "angular velocity");
      expectNear(screw.angularAccelerationAt(t), mtk::vect<3>(), 2e-11, "angular acceleration");
      expectNear(mtk::difference(pose.orientationAt(t), truth(t).orient), mtk::vect<3>(), 2e-12,
                 "orientation");
      expectNear(pose.angularVelocityAt(t), twist.angular, 2e-12, "angular velocity");
      expectNear(pose.angularAccelerationAt(t), mtk::vect<3>(), 2e-11, "angular acceleration");
    });
  }
}

TEST(Segments, AreFiniteForStepsOfZeroAndNearlyPi) {
  const Knots knots(0, 1);
  for (const double angle :
       {0.0, 1e-300, 1e-160, 1e-20, 1e-8, 0.4999, 0.5001, 3.0, M_PI - 1e-6, M_PI - 1e-12}) {
    const mtk::vect<3> step = angle * mtk::vect<3>(0.6, 0, 0.8);
    std::vector<mtk::trafo<mtk::SO3<>>> controls;
    for (int i = 0; i < 4; ++i)
      controls.emplace_back(mtk::vect<3>(i, 0, 1), mtk::SO3<>::exp(double(i) * step));
    const auto pose = segmentOf<PoseSegment<4>>(knots, 0, controls);
    const auto screw = segmentOf<ScrewSegment<4>>(knots, 0, controls);
    expectNear(pose.angularVelocityAt(0.3), step, 1e-9, "angular velocity");
    expectNear(screw.angularVelocityAt(0.3), step, 1e-9, "angular velocity");
    EXPECT_TRUE(screw.accelerationAt(0.3).allFinite()) << angle;
    const auto precise = preciseSegment<ScrewSegment<4>>(knots, 0, controls);
    expectNear(screw.accelerationAt(0.3), precise.accelerationAt(0.3), 1e-8, "acceleration");
  }
}

TEST(Screw, ExpAndLogAreInverse) {
  mtk::testing::Random random(5);
  for (const double angle : {0.0, 1e-10, 1e-3, 0.49, 0.51, 1.0, 3.0, 3.14159}) {
    const mtk::vect<3> axis = testing::randomVector(random, 1);
    const trajectory::Twist<double> twist{testing::randomVector(random, 2), angle / axis.norm() * axis};
    const auto back = trajectory::detail::screwLog<double>(trajectory::detail::screwExp<double>(twist));
    expectNear(back.linear, twist.linear, 1e-13, "linear");
    expectNear(back.angular, twist.angular, 1e-13, "angular");
  }
}

}  // namespace
}  // namespace slom
