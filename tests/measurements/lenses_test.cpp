// Projections by every lens against its published formula; points on the optical axis and behind the camera.
#include "measurements/formulas.hpp"
#include "support/message_of.hpp"

namespace slom::testing {
namespace {

const PinholeIntrinsics<> kPinhole(700, 710, 320, 240);
const OpenCv5Intrinsics<> kOpenCv5(700, 710, 320, 240, -0.3, 0.12, 1e-3, -2e-3, 0.05);
const FisheyeIntrinsics<> kFisheye(300, 310, 320, 240, 0.05, -0.01, 3e-3, -4e-4);
const SnavelyIntrinsics<> kSnavely(600, -0.1, 0.02);

/// Returns points in a camera's frame in the viewing direction: on the axis, next to it at all scales, and elsewhere.
/// `forward` is 1 or -1.
std::vector<Vec3> points(double forward) {
  Random random(31);
  std::vector<Vec3> result;
  for (const double off : {0.0, 1e-300, 1e-12, 3e-8, 1e-7, 1e-4, 0.1, 1.0, 1.0}) {
    const double depth = random.number(1, 6);
    result.push_back(Vec3(off * random.number() * depth, off * random.number() * depth, forward * depth));
  }
  return result;
}
template <class Lens>
void checkLens(const Lens& lens, const std::vector<Vec3>& in_camera) {
  Random random(32);
  std::vector<std::tuple<Vec2, Lens, Vec3>> projections;
  std::vector<std::tuple<Vec2, SE3, Lens, Vec3>> shared;
  for (const Vec3& p : in_camera) {
    const Vec2 pixel = lens.project(p) + random.vector<Vec2>();
    Lens own(lens);
    for (auto& x : own) x *= random.number(0.95, 1.05);
    const SE3 pose = random.pose<SE3>();
    projections.emplace_back(pixel, own, p);
    shared.emplace_back(pixel, pose, lens, pose.inverse() * p);
  }
  checkKind<Projection>(
      [](const auto& z, const auto& c, const auto& p) -> LongVector { return projected(c, p) - z; },
      projections);
  checkKind<Reprojection>(
      [](const auto& z, const auto& pose, const auto& c, const auto& p) -> LongVector {
        return projected(c, matrix(pose.orient) * p + pose.pos) - z;
      },
      shared);
}
TEST(Reprojection, Pinhole) { checkLens(kPinhole, points(1)); }
TEST(Reprojection, OpenCv5) { checkLens(kOpenCv5, points(1)); }
TEST(Reprojection, Fisheye) { checkLens(kFisheye, points(1)); }
TEST(Reprojection, Snavely) { checkLens(kSnavely, points(-1)); }
TEST(Reprojection, FisheyeSeesSidewaysAndBackwards) {
  checkLens(kFisheye, {Vec3(1, 2, 0), Vec3(-1, 0.5, 1e-9), Vec3(2, 1, -0.5), Vec3(0.3, -0.4, -1)});
}

template <class Camera, class Lens>
void checkOwnIntrinsics(const Lens& lens, double forward) {
  Random random(33);
  std::vector<std::tuple<Vec2, Camera, Vec3>> samples;
  for (const Vec3& p : points(forward)) {
    const Camera camera(random.pose<SE3>(), lens);
    samples.emplace_back(lens.project(p) + random.vector<Vec2>(), camera, camera.pose.inverse() * p);
  }
  checkKind<Reprojection>(
      [](const auto& z, const auto& camera, const auto& p) -> LongVector {
        return projected(camera.intrinsics, matrix(camera.pose.orient) * p + camera.pose.pos) - z;
      },
      samples);
}
TEST(Reprojection, OwnIntrinsics) {
  checkOwnIntrinsics<PinholeCamera>(kPinhole, 1);
  checkOwnIntrinsics<OpenCv5Camera>(kOpenCv5, 1);
  checkOwnIntrinsics<FisheyeCamera>(kFisheye, 1);
  checkOwnIntrinsics<SnavelyCamera>(kSnavely, -1);
}

TEST(Intrinsics, NameTheirComponents) {
  Estimator est;
  const auto camera = est.insertRV(OpenCv5Camera(SE3(), kOpenCv5), "cam");
  EXPECT_EQ(est.componentNames(camera).at(0), "cam.pose.pos.x");
  EXPECT_EQ(est.componentNames(camera).at(14), "cam.intrinsics.k3");
  EXPECT_EQ(camera->intrinsics.p2(), -2e-3);
  EXPECT_EQ(mtk::componentNames(kFisheye, "lens").at(7), "lens.k4");
  EXPECT_EQ(mtk::componentNames(kSnavely).at(0), "f");
}

// Points that have no image.

TEST(Intrinsics, GiveNoPixelBehindTheCamera) {
  for (const double z : {-1.0, 0.0, -1e-300}) {
    EXPECT_TRUE(std::isnan(kPinhole.project(Vec3(0.1, 0.2, z))[0])) << z;
    EXPECT_TRUE(std::isnan(kOpenCv5.project(Vec3(0.1, 0.2, z))[1])) << z;
    EXPECT_TRUE(std::isnan(kFisheye.project(Vec3(0, 0, z))[0])) << z;
  }
  // As published: a mirrored image.
  EXPECT_EQ(kSnavely.project(Vec3(0.1, 0.2, 1)), kSnavely.project(Vec3(-0.1, -0.2, -1)));
}
TEST(Intrinsics, APointBehindTheCameraSpoilsNoOther) {
  using M = CallableMeasurement<Projection, VarID<PinholeIntrinsics<>>, VarID<Vec3>, Measured<Vec2>>;
  Estimator est;
  const auto lens = est.insertRV(kPinhole);
  std::vector<M> all;
  for (const double z : {1.0, -1.0, 2.0})
    all.emplace_back(Projection(), lens, est.insertRV(Vec3(0.1, 0.2, z)), measured(Vec2(1, 2)));
  double r[6], J[3 * 14];
  M::evaluateMany(all.data(), 3, r, J);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(std::isnan(r[i]), i == 2 || i == 3) << i;
  for (int i = 0; i < 14; ++i) EXPECT_TRUE(std::isfinite(J[i]) && std::isfinite(J[28 + i])) << i;
}
TEST(Reprojection, AStartBehindTheCameraIsNamed) {
  Estimator est;
  const auto lens = est.insertRV(kPinhole, false, "lens");
  const auto point = est.insertRV(Vec3(0.1, 0.2, -1), "point");
  est.insertMeasurement(Projection(), lens, point, measured(Vec2(300, 200)));
  EXPECT_EQ(messageOf([&] { est.optimize(); }),
            "[slom.not-finite] the residual of measurement Projection #1 is not finite at lens = (700 710 "
            "320 240), point = "
            "(0.1 0.2 -1); check its data, the function where it divides, takes roots or logarithms or "
            "leaves an entry of "
            "its result unset, and the start values");
}
/// Counts the points that it finds behind a camera.
struct CountingReprojection {
  static inline int behind = 0;
  auto operator()(const auto& pose, const auto& lens, const auto& point) const {
    const auto pixel = Reprojection()(pose, lens, point);
    if (pixel[0] != pixel[0]) ++behind;
    return pixel;
  }
};
TEST(Reprojection, AStepBehindTheCameraIsTakenBack) {
  // From far away, full steps overshoot: the image moves as 1 / depth.
  const Vec3 truth(0.3, 0.1, 4);
  Estimator est;
  est.setThreads(1);
  const auto lens = est.insertRV(kPinhole, false);
  const auto point = est.insertRV(Vec3(0, 0, 30), "point");
  for (const SE3& pose : {SE3(), SE3(Vec3(-0.5, 0, 0)), SE3(Vec3(0, 0, -3.8))}) {
    est.insertMeasurement(CountingReprojection(), est.insertRV(pose, false), lens, point,
                          measured(kPinhole.project(pose * truth)));
  }
  const Summary summary = est.optimize();
  EXPECT_GT(CountingReprojection::behind, 0);
  EXPECT_TRUE(summary.converged) << summary;
  EXPECT_LT((*point - truth).norm(), 1e-8) << point->transpose();
}

}  // namespace
}  // namespace slom::testing
