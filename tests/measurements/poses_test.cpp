// Relative poses and rotations, landmarks, priors, gravity: residuals and derivatives at easy and at hard
// points.
#include "measurements/formulas.hpp"

namespace slom::testing {
namespace {

/// Number of rotations from a datum to its prediction: none, tiny, random, close to half a turn; then everything at the
/// origin.
constexpr int kTurns = 9;
template <class R>
R turn(int i, Random& random) {
  const double angles[] = {0, 1e-300, 1e-12, 1e-7, 0.01, 2.0, kPi - 1e-4, kPi - 1e-9, -kPi + 1e-9};
  if constexpr (R::DIM == 2) {
    return R(angles[i]);
  } else {
    return R::exp(Vec3(random.axis() * angles[i]));
  }
}
/// The matrix of a pose and its inverse, applied.
template <class T>
LongVector moved(const T& pose, const LongVector& p) {
  return matrix(pose.orient) * p + pose.pos;
}
template <class T>
LongVector movedBack(const T& pose, const LongVector& p) {
  return matrix(pose.orient).transpose() * (p - pose.pos);
}

/// z^-1 (a^-1 b)
constexpr auto relative_pose = [](const auto& z, const auto& a, const auto& b) {
  return stacked(movedBack(z, movedBack(a, b.pos)), rotationResidual(a.orient, b.orient, z.orient));
};
constexpr auto relative_pose_from_a = [](const auto& z, const auto& a, const auto& b) {
  return stacked(movedBack(a, b.pos) - z.pos, rotationResidual(a.orient, b.orient, z.orient));
};
template <class T>
std::vector<std::tuple<T, T, T>> posePairs() {
  Random random(1);
  std::vector<std::tuple<T, T, T>> samples;
  for (int i = 0; i < kTurns; ++i) {
    const T a = i == 0 ? T() : random.pose<T>(), b = i == 0 ? T() : random.pose<T>();
    T z = a.inverse() * b;
    z = T(z.orient * turn<typename T::Rotation>(i, random),
          i % 2 ? z.pos : random.vector<typename T::Vector>());
    samples.emplace_back(z, a, b);
  }
  return samples;
}
TEST(RelativePose, InThePlane) { checkKind<RelativePose>(relative_pose, posePairs<SE2>(), 1); }
TEST(RelativePose, InSpace) { checkKind<RelativePose>(relative_pose, posePairs<SE3>(), 3); }
TEST(RelativePoseInFrameOfA, InThePlane) {
  checkKind<RelativePoseInFrameOfA>(relative_pose_from_a, posePairs<SE2>(), 1);
}
TEST(RelativePoseInFrameOfA, InSpace) {
  checkKind<RelativePoseInFrameOfA>(relative_pose_from_a, posePairs<SE3>(), 3);
}
TEST(RelativePose, IsMeasuredFromWhereTheDatumPutsB) {
  Estimator est;
  const auto a = est.insertRV(SE2(), false);
  const auto b = est.insertRV(SE2(SO2(kPi / 2), Vec2(2, 1)), false);
  const SE2 z(SO2(kPi / 2), Vec2(2, 0));  // b lies 1 to the left of a, which is ahead of z
  const auto from_z = est.insertMeasurement(RelativePose(), a, b, measured(z));
  const auto from_a = est.insertMeasurement(RelativePoseInFrameOfA(), a, b, measured(z));
  const auto numeric = est.insertMeasurement(slom::numeric(RelativePose()), a, b, measured(z));
  EXPECT_LT((est.residual(from_z) - Vec3(1, 0, 0)).norm(), 1e-15) << est.residual(from_z);
  EXPECT_LT((est.residual(from_a) - Vec3(0, 1, 0)).norm(), 1e-15) << est.residual(from_a);
  EXPECT_LT((est.residual(numeric) - Vec3(1, 0, 0)).norm(), 1e-15) << est.residual(numeric);
}

constexpr auto relative_rotation = [](const auto& z, const auto& a, const auto& b) {
  return rotationResidual(a, b, z);
};
template <class R>
std::vector<std::tuple<R, R, R>> rotationPairs() {
  Random random(2);
  std::vector<std::tuple<R, R, R>> samples;
  for (int i = 0; i < kTurns; ++i) {
    const R a = i == 0 ? R() : random.rotation<R>(), b = i == 0 ? R() : random.rotation<R>();
    samples.emplace_back(a.inverse() * b * turn<R>(i, random), a, b);
  }
  return samples;
}
TEST(RelativeRotation, InThePlane) {
  checkKind<RelativeRotation>(relative_rotation, rotationPairs<SO2>(), 1);
}
TEST(RelativeRotation, InSpace) { checkKind<RelativeRotation>(relative_rotation, rotationPairs<SO3>(), 3); }
TEST(RelativeRotation, TakesTheOrientationOfAPose) {
  std::vector<std::tuple<SO3, SE3, SO3>> samples;
  Random random(3);
  for (int i = 0; i < 5; ++i)
    samples.emplace_back(random.rotation<SO3>(), random.pose<SE3>(), random.rotation<SO3>());
  checkKind<RelativeRotation>(
      [](const auto& z, const auto& a, const auto& b) { return rotationResidual(a.orient, b, z); }, samples,
      3);
}

constexpr auto landmark = [](const auto& z, const auto& pose, const auto& point) -> LongVector {
  return movedBack(pose, point) - LongVector(z);
};
template <class T>
auto landmarks() {
  using V = typename T::Vector;
  Random random(4);
  std::vector<std::tuple<V, T, V>> samples{{V(), T(), V()}};
  for (int i = 0; i < 8; ++i)
    samples.emplace_back(random.vector<V>(), random.pose<T>(), random.vector<V>(i == 3 ? 1e6 : 5));
  return samples;
}
TEST(Landmark, InThePlane) { checkKind<Landmark>(landmark, landmarks<SE2>()); }
TEST(Landmark, InSpace) { checkKind<Landmark>(landmark, landmarks<SE3>()); }
TEST(Landmark, MayBeAPose) {
  Random random(5);
  std::vector<std::tuple<Vec3, SE3, SE3>> samples;
  for (int i = 0; i < 5; ++i)
    samples.emplace_back(random.vector<Vec3>(), random.pose<SE3>(), random.pose<SE3>());
  checkKind<Landmark>([](const auto& z, const auto& a,
                         const auto& b) -> LongVector { return movedBack(a, b.pos) - LongVector(z); },
                      samples);
}

// Priors.

TEST(Prior, OfVectorsAndNumbers) {
  Random random(6);
  std::vector<std::tuple<Vec3, Vec3>> vectors;
  std::vector<std::tuple<double, double>> numbers;
  std::vector<std::tuple<mtk::Scalar<>, mtk::Scalar<>>> scalars;
  for (int i = 0; i < 9; ++i) {
    vectors.emplace_back(random.vector<Vec3>(), random.vector<Vec3>(100));
    numbers.emplace_back(random.number(), random.number());
    scalars.emplace_back(random.number(), random.number());
  }
  checkKind<Prior>([](const auto& z, const auto& x) { return LongVector(x - z); }, vectors);
  checkKind<Prior>([](Real z, Real x) { return column(x - z); }, numbers);
  checkKind<Prior>([](const auto& z, const auto& x) { return column(x.value() - z.value()); }, scalars);
}
TEST(Prior, OfMoreNumbersThanPacksTellApart) {
  const auto check = []<int N>(std::integral_constant<int, N>) {
    Estimator est;
    const auto x = est.insertRV(mtk::vect<N>());
    mtk::vect<N> z;
    for (int i = 0; i < N; ++i) z[i] = 0.5 * i;
    est.insertMeasurement(Prior(), x, measured(z));
    EXPECT_TRUE(est.optimize().converged) << N;
    for (int i = 0; i < N; ++i) EXPECT_NEAR((*x)[i], z[i], 1e-12) << N;
  };
  check(std::integral_constant<int, 60>());
  check(std::integral_constant<int, 61>());
  check(std::integral_constant<int, 70>());
}

TEST(Prior, OfRotationsAndPoses) {
  Random random(7);
  std::vector<std::tuple<SO3, SO3>> rotations;
  std::vector<std::tuple<SE2, SE2>> poses;
  for (int i = 0; i < kTurns; ++i) {
    const SO3 R = random.rotation<SO3>();
    rotations.emplace_back(R * turn<SO3>(i, random), R);
    const SE2 T = random.pose<SE2>();
    poses.emplace_back(SE2(T.orient * turn<SO2>(i, random), random.vector<Vec2>()), T);
  }
  checkKind<Prior>([](const auto& z, const auto& x) { return rotationResidual({}, x, z); }, rotations, 3);
  checkKind<Prior>(
      [](const auto& z, const auto& x) {
        return stacked(x.pos - z.pos, rotationResidual({}, x.orient, z.orient));
      },
      poses, 1);
}
TEST(Prior, OfDirections) {
  Random random(8);
  std::vector<std::tuple<S2, S2>> samples{{S2(0, 0, -1), S2(0, 0, -1)}, {S2(1, 0, 0), S2(-1, 1e-3, 0)}};
  for (int i = 0; i < 7; ++i) {
    const S2 z(random.vector<Vec3>());
    samples.emplace_back(z, mtk::moved(z, random.vector<Vec2>(i < 3 ? std::pow(10, -4 * i) : 2)));
  }
  checkKind<Prior>([](const auto& z, const auto& x) { return directionResidual(x.vector(), z); }, samples, 0,
                   1e-5L);
}
MTK_BUILD_MANIFOLD(Robot, ((SE2, pose))((Vec3, calibration)))
template <class S>
struct Rig {
  mtk::SO3<S> orient;
  std::array<mtk::vect<2, S>, 2> points;
};
TEST(Prior, OfCompounds) {
  Random random(9);
  std::vector<std::tuple<Robot, Robot>> robots;
  std::vector<std::tuple<Rig<double>, Rig<double>>> rigs;
  const auto rig = [&] {
    return Rig<double>{random.rotation<SO3>(), {random.vector<Vec2>(), random.vector<Vec2>()}};
  };
  for (int i = 0; i < 9; ++i) {
    robots.emplace_back(Robot(random.pose<SE2>(), random.vector<Vec3>()),
                        Robot(random.pose<SE2>(), random.vector<Vec3>()));
    rigs.emplace_back(rig(), rig());
  }
  checkKind<Prior>(
      [](const auto& z, const auto& x) {
        return stacked(stacked(x.pose.pos - z.pose.pos, rotationResidual({}, x.pose.orient, z.pose.orient)),
                       x.calibration - z.calibration);
      },
      robots);
  checkKind<Prior>(
      [](const auto& z, const auto& x) {
        return stacked(rotationResidual({}, x.orient, z.orient),
                       stacked(x.points[0] - z.points[0], x.points[1] - z.points[1]));
      },
      rigs);
}

/// A user's own manifold, over doubles only.
struct Heading {
  using scalar = double;
  static constexpr int DOF = 1;
  double degrees = 0;
  void boxplus(mtk::vectview<const double, 1> d, double scale = 1) { degrees += scale * d[0] * 180 / kPi; }
  void boxminus(mtk::vectview<double, 1> out, const Heading& y) const {
    out[0] = std::remainder(degrees - y.degrees, 360.0) * kPi / 180;
  }
};
struct Plain {
  Vec2 position;
  SO2 heading;
};
template <class X>
void expectPriorFinds(const X& truth, const X& start) {
  Estimator est;
  const auto x = est.insertRV(start);
  est.insertMeasurement(Prior(), x, measured(truth), StandardDeviation(0.1));
  EXPECT_TRUE(est.optimize().converged);
  EXPECT_LT(mtk::difference(*x, truth).norm(), 1e-12);
  EXPECT_EQ(est.getM(), est.getN());
}
TEST(Prior, FallsBackToOneByOne) {
  using Dynamic = mtk::vect<mtk::Dynamic>;
  using Long = mtk::vect<65>;  // more unknowns than a sparse dual number has columns
  static_assert(!CallableMeasurement<Prior, VarID<Dynamic>, Measured<Dynamic>>::vectorized);
  static_assert(!CallableMeasurement<Prior, VarID<Eigen::VectorXd>, Measured<Eigen::VectorXd>>::vectorized);
  static_assert(!CallableMeasurement<Prior, VarID<Heading>, Measured<Heading>>::vectorized);
  static_assert(!CallableMeasurement<Prior, VarID<Plain>, Measured<Plain>>::vectorized);
  static_assert(!CallableMeasurement<Prior, VarID<Long>, Measured<Long>>::vectorized);
  expectPriorFinds(Dynamic{1, 2, 3}, Dynamic{-1, 0, 5});
  expectPriorFinds<Eigen::VectorXd>(Eigen::VectorXd::Ones(20), Eigen::VectorXd::Zero(20));
  expectPriorFinds(Heading{179}, Heading{-170});
  expectPriorFinds(Plain{Vec2(1, 2), SO2(3.1)}, Plain{Vec2(0, 0), SO2(-3.1)});
  expectPriorFinds(Long(Long::Ones()), Long());
}
TEST(Prior, FindsTheDatumOnEveryManifold) {
  Random random(10);
  expectPriorFinds(2.5, 0.0);
  expectPriorFinds(Vec3(1, 2, 3), Vec3());
  expectPriorFinds(random.rotation<SO3>(), random.rotation<SO3>());
  expectPriorFinds(random.pose<SE3>(), random.pose<SE3>());
  expectPriorFinds(S2(0, 0, 1), S2(0.9, 0, -0.4));
  expectPriorFinds(Robot(random.pose<SE2>(), random.vector<Vec3>()), Robot());
}

// Gravity.

TEST(GravityDirection, IsTheRotatedDirection) {
  Random random(11);
  std::vector<std::tuple<S2, SO3, S2>> samples{{S2(0, 0, 1), SO3(), S2(0, 0, 1)}};
  for (int i = 0; i < 8; ++i) {
    const SO3 R = random.rotation<SO3>();
    const S2 up(random.vector<Vec3>());
    samples.emplace_back(mtk::moved(R.inverse() * up, random.vector<Vec2>(i < 3 ? std::pow(10, -4 * i) : 2)),
                         R, up);
  }
  checkKind<GravityDirection>(
      [](const auto& z, const auto& R, const auto& up) {
        return directionResidual(matrix(R).transpose() * Long3(up.vector()), z);
      },
      samples, 0, 1e-4L);
}
TEST(Accelerometer, ShowsGravityUpwards) {
  Random random(12);
  std::vector<std::tuple<Vec3, SO3, S2, double>> plain;
  std::vector<std::tuple<Vec3, SE3, S2, mtk::Scalar<>, Vec3>> with_bias;
  std::vector<std::tuple<Vec3, SE3, SO3, S2, double, Vec3>> mounted;
  for (int i = 0; i < 9; ++i) {
    const SO3 R = i == 0 ? SO3() : random.rotation<SO3>(), mounting = random.rotation<SO3>();
    const S2 up = i == 0 ? S2(0, 0, 1) : S2(random.vector<Vec3>());
    const Vec3 z = random.vector<Vec3>(10), bias = random.vector<Vec3>();
    plain.emplace_back(z, R, up, 9.81);
    with_bias.emplace_back(z, SE3(R, random.vector<Vec3>(9)), up, random.number(9, 10), bias);
    mounted.emplace_back(z, SE3(R), mounting, up, random.number(9, 10), bias);
  }
  const auto shown = [](const auto& R, const auto& up, Real g) {
    return LongVector(matrix(R).transpose() * up.vector() * g);
  };
  checkKind<Accelerometer>([&](const auto& z, const auto& R, const auto& up,
                               Real g) -> LongVector { return shown(R, up, g) - LongVector(z); },
                           plain);
  checkKind<Accelerometer>(
      [&](const auto& z, const auto& T, const auto& up, const auto& g, const auto& bias) -> LongVector {
        return shown(T.orient, up, g.value()) + LongVector(bias) - LongVector(z);
      },
      with_bias);
  checkKind<Accelerometer>(
      [&](const auto& z, const auto& T, const auto& mounting, const auto& up, Real g,
          const auto& bias) -> LongVector {
        return matrix(mounting) * shown(T.orient, up, g) + LongVector(bias) - LongVector(z);
      },
      mounted);
}

}  // namespace
}  // namespace slom::testing
