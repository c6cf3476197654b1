// Every ready measurement from its tape: the same as by dual numbers, at easy and at hard points.
#include "tape/compare.hpp"

namespace slom::testing {
namespace {

constexpr int kSamples = 70;  // more than one batch

/// Rotation number i: none, tiny, random, close to half a turn.
template <class R>
R hardRotation(int i, Random& random) {
  const double angles[] = {0,    1e-300, 1e-160,     1e-12,      1e-8,       1e-7,
                           0.01, 2.0,    kPi - 1e-4, kPi - 1e-9, -kPi + 1e-9};
  const double angle = i < 11 ? angles[i] : random.number(-kPi, kPi);
  if constexpr (R::DIM == 2) {
    return R(angle);
  } else {
    return R::exp(Vec3(random.axis() * angle));
  }
}
template <class T>
T hardPose(int i, Random& random) {
  T pose = random.pose<T>();
  pose.orient = hardRotation<typename T::Rotation>(i, random);
  if (i % 7 == 0) pose.pos = typename T::Vector();
  return pose;
}

template <class T>
void checkRelativePoses(unsigned seed) {
  Random random(seed);
  std::vector<std::tuple<T, T, T>> samples;
  for (int i = 0; i < kSamples; ++i) {
    const T a = i % 5 == 0 ? T() : random.pose<T>(), b = random.pose<T>();
    const T difference = i == 3 ? T() : hardPose<T>(i, random);
    samples.push_back({(a.inverse() * b) * difference, a, b});
  }
  expectTraced(RelativePose(), samples);
  expectTraced(RelativePoseInFrameOfA(), samples);
}
TEST(TracedKinds, RelativePosesInThePlane) {
  for (unsigned seed = 1; seed < 4; ++seed) checkRelativePoses<SE2>(seed);
}
TEST(TracedKinds, RelativePosesInSpace) {
  for (unsigned seed = 1; seed < 4; ++seed) checkRelativePoses<SE3>(seed);
}

template <class R>
void checkRotations(unsigned seed) {
  Random random(seed);
  std::vector<std::tuple<R, R, R>> samples;
  std::vector<std::tuple<R, R>> priors;
  for (int i = 0; i < kSamples; ++i) {
    const R a = random.rotation<R>(), b = random.rotation<R>();
    samples.push_back({a.inverse() * b * hardRotation<R>(i, random), a, b});
    priors.push_back({a, a * hardRotation<R>(i, random)});
  }
  expectTraced(RelativeRotation(), samples);
  expectTraced(Prior(), priors);
}
TEST(TracedKinds, Rotations) {
  for (unsigned seed = 1; seed < 4; ++seed) {
    checkRotations<SO2>(seed);
    checkRotations<SO3>(seed);
  }
}

TEST(TracedKinds, Priors) {
  Random random(3);
  std::vector<std::tuple<S2, S2>> directions;
  std::vector<std::tuple<Vec3, Vec3>> vectors;
  std::vector<std::tuple<double, double>> numbers;
  std::vector<std::tuple<mtk::Scalar<>, mtk::Scalar<>>> scalars;
  std::vector<std::tuple<SE3, SE3>> poses;
  std::vector<std::tuple<PinholeCamera, PinholeCamera>> cameras;
  for (int i = 0; i < kSamples; ++i) {
    const S2 v = i == 6 ? S2(0, 0, 1) : S2(random.axis());  // products with its axes have no rounding errors
    const double steps[] = {0, 1e-300, 1e-12, 1e-7, 3.0};
    const double step[2] = {i < 5 ? steps[i] : random.number(), i < 5 ? 0 : random.number()};
    directions.push_back(
        {v, i == 6 ? S2(Vec3(-v.vector())) : mtk::moved(v, mtk::vectview<const double, 2>(step))});
    vectors.push_back({random.vector<Vec3>(), random.vector<Vec3>()});
    numbers.push_back({random.number(), random.number()});
    scalars.push_back({random.number(), random.number()});
    const SE3 pose = random.pose<SE3>();
    poses.push_back({pose, SE3(pose.orient * hardRotation<SO3>(i, random), random.vector<Vec3>())});
    cameras.push_back({PinholeCamera(pose, PinholeIntrinsics<>(500, 510, 320, 240)),
                       PinholeCamera(std::get<1>(poses.back()), PinholeIntrinsics<>(501, 512, 321, 242))});
  }
  expectTraced(Prior(), directions);
  expectTraced(Prior(), vectors);
  expectTraced(Prior(), numbers);
  expectTraced(Prior(), scalars);
  expectTraced(Prior(), poses);
  expectTraced(Prior(), cameras);
}

template <class T>
void checkSights(unsigned seed) {
  using Point = typename T::Vector;
  Random random(seed);
  std::vector<std::tuple<double, Point, Point>> ranges;
  std::vector<std::tuple<double, T, Point, mtk::Scalar<>>> with_offset;
  std::vector<std::tuple<Point, T, Point>> landmarks;
  for (int i = 0; i < kSamples; ++i) {
    const T pose = hardPose<T>(i, random);
    const double scale[] = {0, 1e-300, 1e-160, 1e-12, 1e-8};
    const Point way = random.vector<Point>(5) * (i < 5 ? scale[i] : 1.0);
    const Point from = i < 5 ? Point() : random.vector<Point>();
    ranges.push_back({random.number(), from, from + way});
    with_offset.push_back({random.number(), pose, pose.pos + way, random.number()});
    landmarks.push_back({random.vector<Point>(), pose, random.vector<Point>()});
  }
  expectTraced(Range(), ranges);
  expectTraced(Range(), with_offset);
  expectTraced(Landmark(), landmarks);
}
TEST(TracedKinds, RangesAndLandmarks) {
  for (unsigned seed = 1; seed < 4; ++seed) {
    checkSights<SE2>(seed);
    checkSights<SE3>(seed);
  }
}

TEST(TracedKinds, BearingsAndAngles) {
  Random random(5);
  std::vector<std::tuple<SO2, SE2, Vec2>> in_plane;
  std::vector<std::tuple<S2, SE3, Vec3>> in_space;
  std::vector<std::tuple<SO2, Vec3, Vec3>> zenith;
  std::vector<std::tuple<SO2, Vec2, Vec2, SO2>> directions;
  for (int i = 0; i < kSamples; ++i) {
    const SE2 pose = hardPose<SE2>(i, random);
    const SE3 space = hardPose<SE3>(i, random);
    const Vec2 way = i == 0 ? Vec2() : Vec2(random.vector<Vec2>(5) * (i < 3 ? 1e-200 : 1.0));
    in_plane.push_back({random.rotation<SO2>(), pose, pose.pos + way});
    const Vec3 seen = space.orient.inverse() * random.vector<Vec3>(3);
    in_space.push_back({i == 1 ? S2(seen) : S2(random.axis()), space, space * seen});
    const Vec3 from = i < 2 ? Vec3() : random.vector<Vec3>();
    zenith.push_back({random.rotation<SO2>(), from, i == 1 ? Vec3(0, 0, 2) : random.vector<Vec3>()});
    const Vec2 station = i == 0 ? Vec2() : random.vector<Vec2>();
    directions.push_back({random.rotation<SO2>(), station, station + way, random.rotation<SO2>()});
  }
  expectTraced(Bearing(), in_plane);
  expectTraced(Bearing(), in_space);
  expectTraced(ZenithAngle(), zenith);
  expectTraced(Azimuth(), zenith);
  expectTraced(HorizontalDirection(), directions);
}

TEST(TracedKinds, Gravity) {
  Random random(6);
  std::vector<std::tuple<S2, SO3, S2>> directions;
  std::vector<std::tuple<Vec3, SE3, S2, double>> readings;
  std::vector<std::tuple<Vec3, SO3, SO3, S2, double, Vec3>> mounted;
  for (int i = 0; i < kSamples; ++i) {
    const SE3 pose = hardPose<SE3>(i, random);
    const S2 up(random.axis());
    directions.push_back({i == 2 ? pose.orient.inverse() * up : S2(random.axis()), pose.orient, up});
    readings.push_back({random.vector<Vec3>(), pose, up, 9.81});
    mounted.push_back(
        {random.vector<Vec3>(), pose.orient, random.rotation<SO3>(), up, 9.81, random.vector<Vec3>()});
  }
  expectTraced(GravityDirection(), directions);
  expectTraced(Accelerometer(), readings);
  expectTraced(Accelerometer(), mounted);
}

template <class Camera>
void checkLens(const decltype(Camera::intrinsics)& lens, double towards) {
  using Lens = decltype(Camera::intrinsics);
  Random random(7);
  std::vector<std::tuple<Vec2, Lens, Vec3>> projections;
  std::vector<std::tuple<Vec2, SE3, Lens, Vec3>> seen;
  std::vector<std::tuple<Vec2, Camera, Vec3>> cameras;
  for (int i = 0; i < kSamples; ++i) {
    Vec3 p = random.vector<Vec3>();
    p[2] = towards * random.number(2, 6);
    if (i == 1) p[0] = p[1] = 0;
    if (i == 2) p[0] = 1e-9, p[1] = 0;
    const SE3 pose = hardPose<SE3>(i, random);
    const Vec3 world = pose.inverse() * p;
    projections.push_back({random.vector<Vec2>(100), lens, p});
    seen.push_back({random.vector<Vec2>(100), pose, lens, world});
    Camera camera;
    camera.pose = pose;
    camera.intrinsics = lens;
    cameras.push_back({random.vector<Vec2>(100), camera, world});
  }
  expectTraced(Projection(), projections);
  expectTraced(Reprojection(), seen);
  expectTraced(Reprojection(), cameras);
}
TEST(TracedKinds, Lenses) {
  checkLens<PinholeCamera>(PinholeIntrinsics<>(500, 510, 320, 240), 1);
  checkLens<OpenCv5Camera>(OpenCv5Intrinsics<>(500, 510, 320, 240, -0.2, 0.1, 0.01, -0.02, 0.03), 1);
  checkLens<FisheyeCamera>(FisheyeIntrinsics<>(300, 310, 320, 240, 0.1, -0.02, 0.003, 0.001), 1);
  checkLens<SnavelyCamera>(SnavelyIntrinsics<>(600, -0.1, 0.02), -1);
}

}  // namespace
}  // namespace slom::testing
