#include "simulate/stereo_imu_stream.hpp"

#include <cmath>
#include <functional>
#include <numbers>

namespace slom::app {

namespace {

using SE3 = mtk::trafo<mtk::SO3<>>;
using SO3 = mtk::SO3<>;
using Vec3 = mtk::vect<3>;
using mtk::testing::Random;

// Streams of random numbers.
constexpr std::uint32_t kMotionStream = 1;
constexpr std::uint32_t kCornerStream = 2;
constexpr std::uint32_t kReadingStream = 3;
constexpr std::uint32_t kWalkStream = 4;

constexpr int kViewsBefore = 20;  // 1 s apart, if the motion is not full

/// Returns two cameras of 752 x 480 px, 11 cm apart, and gravity along a board that leans back a little.
StereoImuStreamData deviceInMotion() {
  StereoImuStreamData data;
  data.image_width_px = 752;
  data.image_height_px = 480;
  data.cam0 = {458.7, 457.3, 367.2, 248.4, -0.2834, 0.0740, 0.0002, 0.0000, 0.0};
  data.cam1 = {457.6, 456.1, 379.9, 255.2, -0.2837, 0.0745, -0.0001, 0.0000, 0.0};
  data.cam0_to_cam1 = SE3(SO3::exp(Vec3(0.014, -0.002, 0.007)), Vec3(-0.1101, 0.0004, -0.0009));
  const Vec3 down(0.02, -0.99, -0.12);
  data.gravity = Vec3(down / down.norm() * 9.80665);
  return data;
}

double sideOf(const StereoImuStreamOptions& options) {
  return options.square_m * (options.tags + (options.tags - 1) * options.spacing);
}

/// One of the cameras in motion: `world2camera` at a time after the first image, in the clock of cam0.
struct MovingCamera {
  const SimulatedCamera& lens;
  double line_delay;
  std::function<SE3(double)> world2camera;

  /// Returns the point in the frame of the camera when its row is read, in an image of that time.
  Vec3 seenAt(const Vec3& world, double time) const {
    Vec3 point = world2camera(time) * world;
    if (line_delay == 0) return point;
    constexpr int rounds = 6;  // each reduces the error of the time by the row's motion while a row is read
    for (int round = 0; round < rounds && point.z() > 0; ++round)
      point = world2camera(time + line_delay * lens.project(point).y()) * world;
    return point;
  }
};

/// Returns the corners of all tags that one camera sees whole, without noise.
std::vector<StreamCorner> visibleCorners(const StereoImuStreamOptions& options,
                                         const StereoImuStreamData& data, const MovingCamera& camera,
                                         double time, std::int64_t time_ns) {
  std::vector<StreamCorner> corners;
  for (int tag = 0; tag < options.tags * options.tags; ++tag) {
    const std::size_t before = corners.size();
    for (int k = 0; k < 4; ++k) {
      const Vec3 point = camera.seenAt(streamCornerInWorld(options, 4 * tag + k), time);
      if (point.z() <= 0 || point.head<2>().norm() > point.z()) break;  // more than 45 degrees off the axis
      const mtk::vect<2> pixel = camera.lens.project(point);
      const bool inside = pixel.x() >= 0 && pixel.x() <= data.image_width_px - 1 &&  //
                          pixel.y() >= 0 && pixel.y() <= data.image_height_px - 1;
      if (!inside) break;
      corners.push_back({time_ns, 4 * tag + k, pixel});
    }
    if (corners.size() < before + 4) corners.resize(before);
  }
  return corners;
}

std::int64_t nanoseconds(double seconds) { return std::int64_t(std::llround(seconds * 1e9)); }

/// Adds the corners of both cameras at a time after the first image, with noise.
void addImage(const StereoImuStreamOptions& options, const SimulatedPath& path, double time, Random& random,
              StereoImuStreamData& data) {
  for (int c = 0; c < 2; ++c) {
    const double phase = c == 0 ? 0 : options.camera_phase, offset = c == 0 ? 0 : options.camera_offset;
    const MovingCamera camera{c == 0 ? data.cam0 : data.cam1, options.line_delay, [&](double t) {
                                const SE3 world_to_cam0 = path(t).inverse();
                                return c == 0 ? world_to_cam0 : data.cam0_to_cam1 * world_to_cam0;
                              }};
    for (StreamCorner corner : visibleCorners(options, data, camera, time + phase,
                                              options.epoch_ns + nanoseconds(time + phase + offset))) {
      corner.pixel.x() += options.sigma_px * random.normal();
      corner.pixel.y() += options.sigma_px * random.normal();
      data.corners[c].push_back(corner);
    }
  }
}

/// Returns the exact reading at a time. Differences of fourth order over 1 ms are off by about 1e-9 of the motion.
ImuSample readingAt(const SimulatedPath& path, const SE3& cam0_to_imu, const Vec3& gravity, double time) {
  constexpr double h = 1e-3;
  const SE3 imu_to_cam0 = cam0_to_imu.inverse();
  SE3 pose[5];
  for (int i = 0; i < 5; ++i) pose[i] = path(time + (i - 2) * h) * imu_to_cam0;
  const SO3 back = pose[2].orient.inverse();
  const auto turn = [&](int i) { return SO3::log(back * pose[i].orient); };
  ImuSample sample;
  sample.gyro = Vec3((turn(0) - 8 * turn(1) + 8 * turn(3) - turn(4)) / (12 * h));
  const Vec3 acceleration((16 * (pose[1].pos + pose[3].pos) - pose[0].pos - pose[4].pos - 30 * pose[2].pos) /
                          (12 * h * h));
  sample.force = back * Vec3(acceleration - gravity);
  return sample;
}

void addNormal(Vec3& vector, double sigma, Random& random) {
  for (int axis = 0; axis < 3; ++axis) vector[axis] += sigma * random.normal();
}

/// Adds the readings while the rig moves, and the means of their biases. No reading is at the time of an image.
void addReadings(const StereoImuStreamOptions& options, const SimulatedPath& path, double first,
                 StereoImuStreamData& data) {
  Random white(options.seed, kReadingStream), walk(options.seed, kWalkStream);
  const double step = 1 / options.imu_rate;
  const int count = int(std::floor(options.seconds * options.imu_rate));
  first += 0.37 * step;
  Vec3 gyro_bias = options.gyro_bias, force_bias = options.force_bias;
  data.imu_epoch_ns = options.epoch_ns + nanoseconds(first + options.time_offset);
  data.gyro_bias = data.force_bias = Vec3(0., 0., 0.);
  for (int i = 0; i < count; ++i) {
    ImuSample sample = readingAt(path, options.cam0_to_imu, data.gravity, first + i * step);
    sample.time = i * step;
    sample.gyro += gyro_bias;
    sample.force += force_bias;
    data.gyro_bias += gyro_bias / count;
    data.force_bias += force_bias / count;
    addNormal(sample.gyro, options.noise.gyro / std::sqrt(step), white);
    addNormal(sample.force, options.noise.force / std::sqrt(step), white);
    addNormal(gyro_bias, options.noise.gyro_walk * std::sqrt(step), walk);
    addNormal(force_bias, options.noise.force_walk * std::sqrt(step), walk);
    data.imu.push_back(sample);
  }
}

}  // namespace

mtk::vect<3> streamCornerInWorld(const StereoImuStreamOptions& options, int corner) {
  const int tag = corner / 4, k = corner % 4;
  const double pitch = 1 + options.spacing;
  const double x = tag % options.tags * pitch + (k == 1 || k == 2);
  const double y = tag / options.tags * pitch + (k >= 2);
  return Vec3(x * options.square_m, y * options.square_m, 0.0);
}

SimulatedPath::SimulatedPath(const StereoImuStreamOptions& options, SimulatedMotion motion)
    : motion_(motion) {
  centre_ = Vec3(sideOf(options) / 2, sideOf(options) / 2, 0.0);
  Random random(options.seed, kMotionStream);
  const auto draw = [&](double amplitude, double low, double high) {
    // Each number has its own statement, because C++ leaves the order of evaluation of arguments open.
    const double frequency = 2 * std::numbers::pi * random.uniform(low, high);
    const double phase = random.uniform(0, 2 * std::numbers::pi);
    return Sine{amplitude, frequency, phase};
  };
  for (int axis = 0; axis < 3; ++axis) {
    if (axis < 2) orbit_[axis].push_back(draw(0.4, 0.1, 0.2));
    shift_[axis] = {draw(0.08, 0.2, 0.5), draw(0.04, 0.5, 0.9), draw(0.02, 0.9, 1.5)};
    const double size = axis == 2 ? 2 : 1;
    turn_[axis] = {draw(0.12 * size, 0.2, 0.5), draw(0.06 * size, 0.5, 0.9), draw(0.04 * size, 0.9, 1.5)};
  }
}

mtk::vect<3> SimulatedPath::sum(const std::vector<Sine> (&axes)[3], double time) const {
  Vec3 result(0., 0., 0.);
  for (int axis = 0; axis < 3; ++axis) {
    for (const Sine& s : axes[axis]) result[axis] += s.amplitude * std::sin(s.frequency * time + s.phase);
  }
  return result;
}

/// Orbits the centre of the board slowly, shifts and turns quickly. Facing the board, x is right and y down.
mtk::trafo<mtk::SO3<>> SimulatedPath::operator()(double time) const {
  const bool is_full = motion_ == SimulatedMotion::full;
  const Vec3 still_orbit(0.3, -0.2, 0.), axis(0.2, 0.1, 0.9);
  const SE3 orbit(SO3::exp(is_full ? sum(orbit_, time) : still_orbit), centre_);
  const bool shifts = is_full || motion_ == SimulatedMotion::translation;
  Vec3 turn(0., 0., 0.);
  if (is_full) turn = sum(turn_, time);
  if (motion_ == SimulatedMotion::one_axis) turn = Vec3(axis * sum(turn_, time).z());
  const Vec3 shift = shifts ? sum(shift_, time) : Vec3(0., 0., 0.);
  const SO3 facing = SO3::exp(Vec3(std::numbers::pi, 0., 0.));
  return orbit * SE3(facing * SO3::exp(turn), Vec3(shift + Vec3(-0.05, 0., 0.85)));
}

StereoImuStreamData simulateStereoImuStream(const StereoImuStreamOptions& options) {
  StereoImuStreamData data = deviceInMotion();
  Random pixel_random(options.seed, kCornerStream);
  double first = 0;
  if (options.motion != SimulatedMotion::full) {
    const SimulatedPath around(options, SimulatedMotion::full);
    for (; first < kViewsBefore; ++first) addImage(options, around, first, pixel_random, data);
  }
  const SimulatedPath path(options, options.motion);
  const int images = int(std::floor(options.seconds * options.camera_rate)) + 1;
  for (int i = 0; i < images; ++i) {
    const double time = first + i / options.camera_rate;
    addImage(options, path, time, pixel_random, data);
  }
  addReadings(options, path, first, data);
  return data;
}

}  // namespace slom::app
