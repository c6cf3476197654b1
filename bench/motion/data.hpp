// Recordings of a body in motion: poses of a camera on it, and readings of an IMU that is the body, simulated or from
// files.
#pragma once

#include <cstdint>
#include <vector>

#include <slom/measurements/imu_samples.hpp>
#include <slom/slom.hpp>

namespace slom::bench {

using Vec3 = mtk::vect<3>;
using Rotation = mtk::SO3<>;
using Pose = mtk::trafo<Rotation>;

inline constexpr double kGravity = 9.80665;  // [m/s^2]

/// A smooth motion of the body by hand: sums of sines with about 0.5 m/s, 4 m/s^2 and 1.5 rad/s (RMS).
class Motion {
 public:
  explicit Motion(std::uint64_t seed);
  Vec3 position(double t) const { return sum(0, 0, t); }
  Vec3 acceleration(double t) const { return sum(0, 2, t); }
  Rotation orientation(double t) const;
  /// Returns the angular velocity in the frame of the body.
  Vec3 angularVelocity(double t) const;

 private:
  struct Sine {
    double amplitude, rate, phase;
  };
  /// Returns a derivative of three components from `first` on.
  Vec3 sum(int first, int derivative, double t) const;
  Sine sines_[6][3];
};

/// A pose of a camera at a time of its clock [s].
struct Sighting {
  double time;
  Pose pose;  ///< world_T_camera
};

/// What was recorded. The clock of the trajectory is that of the first camera.
struct Recording {
  std::vector<Sighting> images;        ///< of a camera on the body
  std::vector<ImuSample> readings;     ///< stamps are times of the clock of the camera plus the offset
  ImuNoise noise;                      ///< densities
  double position_sigma, angle_sigma;  ///< of a pose [m, rad]
  Pose body_T_camera;                  ///< a start value
};

/// What is true of a simulated recording.
struct Truth {
  Motion motion;
  Pose body_T_camera;
  double offset = 0.0173;  ///< clock of the IMU minus that of the camera [s]
};

/// Simulates 20 images and 200 readings each second.
Recording simulate(const Truth& truth, double duration, std::uint64_t seed);

/// Returns a random vector with this standard deviation in each component.
template <class Random>
Vec3 randomVector(Random& random, double sigma) {
  return {sigma * random.normal(), sigma * random.normal(), sigma * random.normal()};
}
/// Returns the pose with noise along the axes of the world, and about its own.
template <class Random>
Pose withNoise(const Pose& pose, Random& random, double position_sigma, double angle_sigma) {
  return {Vec3(pose.pos + randomVector(random, position_sigma)),
          pose.orient * Rotation::exp(randomVector(random, angle_sigma))};
}
/// Returns the pose of the sighting nearest in time.
const Pose& nearest(const std::vector<Sighting>& images, double t);

/// Returns the direction against gravity in the world, roughly: the mean of the forces, turned into the world.
mtk::S2<> roughlyUp(const Recording& recording);

}  // namespace slom::bench
