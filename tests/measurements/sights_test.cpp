// Ranges, bearings, a surveyor's angles: residuals and derivatives at easy and at hard points.
#include "measurements/formulas.hpp"
#include "support/message_of.hpp"

namespace slom::testing {
namespace {

template <class V>
auto pointPairs() {
  Random random(21);
  std::vector<std::tuple<double, V, V>> samples;
  for (int i = 0; i < 9; ++i)
    samples.emplace_back(random.number(0, 9), random.vector<V>(), random.vector<V>(i == 4 ? 1e6 : 9));
  return samples;
}
constexpr auto distance = [](Real z, const auto& a, const auto& b) {
  Real sum = 0;
  for (int i = 0; i < a.size(); ++i) sum += std::pow(b[i] - a[i], 2);
  return column(std::sqrt(sum) - z);
};
TEST(Range, BetweenPoints) {
  checkKind<Range>(distance, pointPairs<Vec2>());
  checkKind<Range>(distance, pointPairs<Vec3>());
}
TEST(Range, BetweenPointsThatAreClose) {
  Random random(22);
  std::vector<std::tuple<double, Vec3, Vec3>> samples;
  for (int i = 0; i < 6; ++i) {
    samples.emplace_back(1e-6, Vec3(), random.vector<Vec3>(1e-6));
    samples.emplace_back(1e-12, Vec3(), random.vector<Vec3>(1e-6));
  }
  checkKind<Range>(distance, samples, 0, 1e-10L);
}
TEST(Range, WithPosesAndAnOffset) {
  Random random(23);
  std::vector<std::tuple<double, SE2, Vec2, double>> samples;
  for (int i = 0; i < 9; ++i) {
    samples.emplace_back(random.number(), random.pose<SE2>(), random.vector<Vec2>(9), random.number());
  }
  checkKind<Range>([](Real z, const auto& pose, const auto& point,
                      Real offset) { return LongVector(distance(z, pose.pos, point).array() + offset); },
                   samples);
}
/// Residual and derivatives of one measurement.
template <class F, class Z, class... X>
std::pair<Eigen::VectorXd, Eigen::MatrixXd> linearized(F, const Z& z, const X&... x) {
  using M = CallableMeasurement<F, VarID<X>..., Measured<Z>>;
  Estimator owner;
  const M m(F(), owner.insertRV(x)..., measured(z));
  Eigen::VectorXd r(M::residual_dim);
  Eigen::MatrixXd J(M::residual_dim, (mtk::DOF_v<X> + ...));
  M::evaluateMany(&m, 1, r.data(), J.data());
  return {r, J};
}
TEST(Range, OfAPointToItselfHasTheDerivativeAlongTheFirstAxis) {
  const auto [r, J] = linearized(Range(), 2.0, Vec3(1, 2, 3), Vec3(1, 2, 3));
  EXPECT_EQ(r[0], -2);
  EXPECT_EQ(J, (Eigen::MatrixXd(1, 6) << -1, 0, 0, 1, 0, 0).finished()) << J;
}

// Bearings.

constexpr double kAngles[] = {0, 1e-12, 1, 2, kPi - 1e-9, -kPi + 1e-9, kPi, -1e-300, -2};

TEST(Bearing, InThePlane) {
  Random random(24);
  std::vector<std::tuple<SO2, SE2, Vec2>> samples;
  for (const double angle : kAngles) {
    const SE2 pose = samples.empty() ? SE2() : random.pose<SE2>();
    // The angle is seen, and the datum is 0.3 away, over the seam for some.
    samples.emplace_back(SO2(angle + 0.3), pose, pose * Vec2(4 * std::cos(angle), 4 * std::sin(angle)));
  }
  checkKind<Bearing>(
      [](const auto& z, const auto& pose, const auto& point) {
        const Long2 seen = matrix(pose.orient).transpose() * (point - pose.pos);
        return column(wrapped(std::atan2(seen[1], seen[0]) - z.angle()));
      },
      samples, 1);
}
TEST(Bearing, InSpace) {
  Random random(25);
  std::vector<std::tuple<S2, SE3, Vec3>> samples{{S2(0, 0, -1), SE3(), Vec3(0, 0, -3)}};
  for (int i = 0; i < 8; ++i) {
    const SE3 pose = random.pose<SE3>();
    const Vec3 point = random.vector<Vec3>(20);
    samples.emplace_back(
        mtk::moved(S2(pose.inverse() * point), random.vector<Vec2>(i < 3 ? std::pow(10, -4 * i) : 2)), pose,
        point);
  }
  checkKind<Bearing>(
      [](const auto& z, const auto& pose, const auto& point) {
        return directionResidual(matrix(pose.orient).transpose() * (point - pose.pos), z);
      },
      samples, 0, 1e-4L);
}
TEST(Bearing, OfTheSensorsOwnPosition) {
  const auto [r, J] = linearized(Bearing(), SO2(0.5), SE2(Vec2(1, 2)), Vec2(1, 2));
  EXPECT_EQ(r[0], -0.5);
  EXPECT_TRUE(J.isZero(0)) << J;
  EXPECT_EQ(
      messageOf([] { linearized(Bearing(), S2(0, 0, 1), SE3(Vec3(1, 2, 3)), Vec3(1, 2, 3)); }),
      "[mtk.no-direction] a direction (S2) cannot be made of the vector (0, 0, 0), which is zero or not finite; pass "
      "a finite vector "
      "of any positive length");
}

// Surveying.

TEST(Azimuth, IsClockwiseFromNorth) {
  EXPECT_DOUBLE_EQ(Azimuth()(Vec2(1, 1), Vec2(1, 5)).angle(), 0);
  EXPECT_DOUBLE_EQ(Azimuth()(Vec2(1, 1), Vec2(5, 1)).angle(), kPi / 2);
  EXPECT_DOUBLE_EQ(ZenithAngle()(Vec3(0, 0, 0), Vec3(3, 0, 0)).angle(), kPi / 2);
  EXPECT_DOUBLE_EQ(ZenithAngle()(Vec3(0, 0, 0), Vec3(0, 3, 3)).angle(), kPi / 4);
}
TEST(Surveying, Angles) {
  Random random(26);
  std::vector<std::tuple<SO2, Vec2, Vec2>> azimuths;
  std::vector<std::tuple<SO2, Vec3, Vec3, SO2>> directions;
  std::vector<std::tuple<SO2, Vec3, Vec3>> zeniths;
  for (const double angle : kAngles) {
    const Vec3 station = random.vector<Vec3>(1000);
    const Vec3 target = station + Vec3(30 * std::sin(angle), 30 * std::cos(angle), random.number(-5, 5));
    const SO2 orientation = random.rotation<SO2>();
    azimuths.emplace_back(SO2(angle + 0.3), Vec2(station[0], station[1]), Vec2(target[0], target[1]));
    directions.emplace_back(SO2(angle - orientation.angle() - 0.1), station, target, orientation);
    zeniths.emplace_back(SO2(random.number(0, kPi)), station, target);
  }
  const auto azimuth = [](const auto& a, const auto& b) { return std::atan2(b[0] - a[0], b[1] - a[1]); };
  checkKind<Azimuth>(
      [&](const auto& z, const auto& a, const auto& b) { return column(wrapped(azimuth(a, b) - z.angle())); },
      azimuths, 1);
  checkKind<HorizontalDirection>(
      [&](const auto& z, const auto& a, const auto& b, const auto& o) {
        return column(wrapped(azimuth(a, b) - o.angle() - z.angle()));
      },
      directions, 1);
  checkKind<ZenithAngle>(
      [](const auto& z, const auto& a, const auto& b) {
        const Long3 way = b - a;
        return column(wrapped(std::acos(way[2] / way.norm()) - z.angle()));
      },
      zeniths, 1);
}

}  // namespace
}  // namespace slom::testing
