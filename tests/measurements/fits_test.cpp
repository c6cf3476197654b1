// A small problem for each kind, with exact data and starts off the truth. The fit finds the truth.
#include "measurements/kind.hpp"

namespace slom::testing {
namespace {

void expectFit(Estimator& est) {
  const Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged) << summary;
  EXPECT_LT(est.getRSS(), 1e-14) << summary;
}
template <class T>
void expectNear(const T& got, const T& truth, double tolerance = 1e-7) {
  EXPECT_LT(mtk::difference(got, truth).norm(), tolerance) << got << "\nin place of\n" << truth;
}
template <class T>
T perturbed(const T& x, Random& random, double size) {
  return mtk::moved(x, random.vector<mtk::tangent_t<T>>(size));
}
/// Inserts each value, off by up to `size` except for the first `fixed` of them.
template <class T>
std::vector<VarID<T>> insert(Estimator& est, const std::vector<T>& truth, std::size_t fixed, double size) {
  Random random(51);
  std::vector<VarID<T>> ids;
  for (const T& x : truth) {
    ids.push_back(ids.size() < fixed ? est.insertRV(x, false) : est.insertRV(perturbed(x, random, size)));
  }
  return ids;
}
template <class T>
void expectAllNear(const std::vector<VarID<T>>& got, const std::vector<T>& truth) {
  for (std::size_t i = 0; i < truth.size(); ++i) expectNear(*got[i], truth[i]);
}

template <class T>
void fitPoseGraph() {
  Random random(41);
  std::vector<T> truth;
  for (int i = 0; i < 7; ++i) truth.push_back(random.pose<T>());
  Estimator est;
  const auto pose = insert(est, truth, 1, 0.3);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (const std::size_t j : {i + 1, i + 3}) {
      if (j < truth.size())
        est.insertMeasurement(RelativePose(), pose[i], pose[j], measured(truth[i].inverse() * truth[j]));
    }
  }
  expectFit(est);
  expectAllNear(pose, truth);
}
TEST(Fit, RelativePose) {
  fitPoseGraph<SE2>();
  fitPoseGraph<SE3>();
}

template <class R>
void fitRotations() {
  Random random(42);
  std::vector<R> truth;
  for (int i = 0; i < 6; ++i) truth.push_back(random.rotation<R>());
  Estimator est;
  const auto rotation = insert(est, truth, 1, 0.5);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      est.insertMeasurement(RelativeRotation(), rotation[i], rotation[j],
                            measured(truth[i].inverse() * truth[j]));
    }
  }
  expectFit(est);
  expectAllNear(rotation, truth);
}
TEST(Fit, RotationAveraging) {
  fitRotations<SO2>();
  fitRotations<SO3>();
}

template <class T>
void fitLandmarks() {
  using V = typename T::Vector;
  Random random(43);
  std::vector<T> poses{T()};
  std::vector<V> points;
  for (int i = 0; i < 3; ++i) poses.push_back(random.pose<T>());
  for (int i = 0; i < 5; ++i) points.push_back(random.vector<V>(9));
  Estimator est;
  const auto pose = insert(est, poses, 1, 0.3);
  const auto point = insert(est, points, 0, 1);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (std::size_t j = 0; j < points.size(); ++j) {
      est.insertMeasurement(Landmark(), pose[i], point[j], measured(V(poses[i].inverse() * points[j])),
                            StandardDeviation(0.1));
    }
  }
  expectFit(est);
  expectAllNear(pose, poses);
  expectAllNear(point, points);
}
TEST(Fit, Landmark) {
  fitLandmarks<SE2>();
  fitLandmarks<SE3>();
}

TEST(Fit, RangeWithOffset) {
  const std::vector<Vec3> beacons{{0, 0, 0}, {50, 0, 5}, {0, 50, 3}, {50, 50, -5}, {20, 30, 20}};
  const Vec3 truth(17, 12, 4);
  Estimator est;
  const auto beacon = insert(est, beacons, beacons.size(), 0);
  const auto receiver = est.insertRV(Vec3(25, 25, 0));
  const auto offset = est.insertRV(0.0);
  for (std::size_t i = 0; i < beacons.size(); ++i) {
    est.insertMeasurement(Range(), beacon[i], receiver, offset, measured((truth - beacons[i]).norm() + 2.5));
  }
  expectFit(est);
  expectNear(*receiver, truth);
  EXPECT_NEAR(*offset, 2.5, 1e-7);
}

TEST(Fit, BearingInThePlane) {
  const std::vector<Vec2> landmarks{{10, 0}, {-8, 3}, {1, 9}, {-2, -7}};
  const SE2 truth(SO2(2.9), Vec2(0.5, -0.3));
  Estimator est;
  const auto landmark = insert(est, landmarks, landmarks.size(), 0);
  const auto pose = est.insertRV(SE2(SO2(-2.9), Vec2(0, 0)));
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Vec2 seen = truth.inverse() * landmarks[i];
    est.insertMeasurement(Bearing(), pose, landmark[i], measured(SO2(std::atan2(seen[1], seen[0]))),
                          StandardDeviation(0.01));
  }
  expectFit(est);
  expectNear(*pose, truth);
}
TEST(Fit, BearingInSpace) {
  Random random(44);
  const Vec3 truth(1, 2, 3);
  Estimator est;
  const auto point = est.insertRV(Vec3(2, 1, 0));
  for (int i = 0; i < 3; ++i) {
    const SE3 pose = random.pose<SE3>(20);
    est.insertMeasurement(Bearing(), pose, point, measured(S2(pose.inverse() * truth)),
                          StandardDeviation(0.01));
  }
  expectFit(est);
  expectNear(*point, truth);
}

TEST(Fit, SurveyorsFreeStation) {
  const std::vector<Vec3> targets{{100, 0, 5}, {-80, 60, 2}, {10, -90, -7}, {30, 110, 4}};
  const Vec3 truth(12, -8, 1.5);
  const SO2 zero(1.1);
  Estimator est;
  const auto station = est.insertRV(Vec3(0, 0, 0), "station");
  const auto orientation = est.insertRV(SO2(0.5), "orientation");
  for (const Vec3& target : targets) {
    const Vec3 way = target - truth;
    est.insertMeasurement(HorizontalDirection(), station, target, orientation,
                          measured(SO2(std::atan2(way[0], way[1]) - zero.angle())), StandardDeviation(1e-5));
    est.insertMeasurement(ZenithAngle(), station, target, measured(SO2(std::acos(way[2] / way.norm()))),
                          StandardDeviation(1e-5));
    est.insertMeasurement(Range(), station, target, measured(way.norm()), StandardDeviation(1e-3));
  }
  expectFit(est);
  expectNear(*station, truth);
  expectNear(*orientation, zero);
}
TEST(Fit, Azimuths) {
  const Vec2 truth(40, 30);
  Estimator est;
  const auto target = est.insertRV(Vec2(10, 10));
  for (const Vec2& station : {Vec2(0, 0), Vec2(100, 0), Vec2(50, 90)}) {
    const Vec2 way = truth - station;
    est.insertMeasurement(Azimuth(), station, target, measured(SO2(std::atan2(way[0], way[1]))));
  }
  expectFit(est);
  expectNear(*target, truth);
}

template <class Lens>
std::vector<Vec3> cube(double forward) {
  std::vector<Vec3> points;
  for (int i = 0; i < 27; ++i) points.emplace_back(i % 3 - 1.0, i / 3 % 3 - 1.0, forward * (i / 9 + 3.0));
  return points;
}
/// One lens, four poses, known points.
template <class Lens>
void calibrate(const Lens& truth, double forward) {
  Random random(45);
  const auto points = cube<Lens>(forward);
  Estimator est;
  Lens start(truth);
  for (auto& x : start) x *= random.number(0.95, 1.05);
  const auto lens = est.insertRV(start, "lens");
  std::vector<SE3> poses;
  for (int i = 0; i < 4; ++i) poses.push_back(perturbed(SE3(), random, 0.4));
  const auto pose = insert(est, poses, 0, 0.05);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (const Vec3& p : points) {
      est.insertMeasurement(Reprojection(), pose[i], lens, p, measured(Vec2(truth.project(poses[i] * p))),
                            StandardDeviation(0.2));
    }
  }
  expectFit(est);
  expectNear<mtk::vect<Lens::DOF>>(*lens, truth, 1e-6);
  expectAllNear(pose, poses);
}
TEST(Fit, SharedIntrinsics) {
  calibrate(PinholeIntrinsics<>(700, 710, 320, 240), 1);
  calibrate(OpenCv5Intrinsics<>(700, 710, 320, 240, -0.3, 0.12, 1e-3, -2e-3, 0.05), 1);
  calibrate(FisheyeIntrinsics<>(300, 310, 320, 240, 0.05, -0.01, 3e-3, -4e-4), 1);
  calibrate(SnavelyIntrinsics<>(600, -0.1, 0.02), -1);
}

/// Bundle adjustment of cameras that have their own lens; two of them are known.
template <class Camera, class Lens>
void adjustBundle(const Lens& lens, double forward) {
  Random random(46);
  const auto points = cube<Lens>(forward);
  std::vector<Camera> cameras;
  for (int i = 0; i < 4; ++i) cameras.push_back(Camera(perturbed(SE3(), random, 0.5), lens));
  Estimator est;
  const auto point = insert(est, points, 0, 0.2);
  std::vector<VarID<Camera>> camera;
  for (const Camera& truth : cameras) {
    Camera start = truth;
    start.pose = perturbed(truth.pose, random, 0.02);
    for (auto& x : start.intrinsics) x *= random.number(0.99, 1.01);
    camera.push_back(camera.size() < 2 ? est.insertRV(truth, false) : est.insertRV(start));
  }
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    for (std::size_t j = 0; j < points.size(); ++j) {
      est.insertMeasurement(Reprojection(), camera[i], point[j],
                            measured(Vec2(cameras[i].intrinsics.project(cameras[i].pose * points[j]))),
                            StandardDeviation(0.2));
    }
  }
  expectFit(est);
  expectAllNear(point, points);
  for (std::size_t i = 0; i < cameras.size(); ++i) expectNear(*camera[i], cameras[i], 1e-6);
}
TEST(Fit, OwnIntrinsics) {
  adjustBundle<PinholeCamera>(PinholeIntrinsics<>(700, 710, 320, 240), 1);
  adjustBundle<SnavelyCamera>(SnavelyIntrinsics<>(600, -0.1, 0.02), -1);
}
TEST(Fit, Projection) {
  // Where a ray meets a plane: the depth is known beforehand.
  Estimator est;
  const auto point = est.insertRV(Vec3(0, 0, 2));
  const Vec3 truth(0.4, -0.2, 3);
  const PinholeIntrinsics<> lens(700, 710, 320, 240);
  est.insertMeasurement(Projection(), lens, point, measured(Vec2(lens.project(truth))),
                        StandardDeviation(0.2));
  est.insertMeasurement([](const auto& p, const auto& depth) { return p[2] - depth; }, point, 3.0);
  expectFit(est);
  expectNear(*point, truth);
}

TEST(Fit, GravityDirection) {
  // Two directions that are known in the world determine an orientation.
  Random random(47);
  const SO3 truth = random.rotation<SO3>();
  Estimator est;
  const auto orientation = est.insertRV(perturbed(truth, random, 0.5));
  for (const S2& direction : {S2(0, 0, 1), S2(0.6, 0, -0.8)}) {
    est.insertMeasurement(GravityDirection(), orientation, direction, measured(truth.inverse() * direction));
  }
  expectFit(est);
  expectNear(*orientation, truth);

  // And known orientations a direction.
  Estimator inverse;
  const auto up = inverse.insertRV(S2(0, 0, 1));
  inverse.insertMeasurement(GravityDirection(), truth, up, measured(truth.inverse() * S2(1, 2, -3)));
  expectFit(inverse);
  expectNear(*up, S2(1, 2, -3));
}
TEST(Fit, AccelerometerCalibration) {
  Random random(48);
  const SO3 mounting = random.rotation<SO3>();
  const Vec3 bias(0.1, -0.2, 0.05);
  const mtk::Scalar<> gravity(9.81);
  const S2 up(0, 0, 1);
  Estimator est;
  const auto body2imu = est.insertRV(perturbed(mounting, random, 0.3), "body2imu");
  const auto g = est.insertRV(mtk::Scalar<>(9), "g");
  const auto b = est.insertRV(Vec3(), "bias");
  for (int i = 0; i < 10; ++i) {
    const SE3 body = random.pose<SE3>();
    est.insertMeasurement(Accelerometer(), body, body2imu, up, g, b,
                          measured(Accelerometer()(body, mounting, up, gravity, bias)),
                          StandardDeviation(0.05));
  }
  expectFit(est);
  expectNear(*body2imu, mounting);
  expectNear(*b, bias);
  EXPECT_NEAR(g->value(), 9.81, 1e-7);
}

}  // namespace
}  // namespace slom::testing
