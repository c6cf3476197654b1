#pragma once
// A simulated stereo camera with an IMU, moved by hand in front of an AprilGrid, with known truth.
//
// Frames    world   the board's: x along a row of tags, y up, z towards the cameras, origin at corner 0   [m]
//           cam0    the reference camera: z forward, x right, y down                                      [m]
//           p_cam1 = cam0_to_cam1 * p_cam0,   p_imu = cam0_to_imu * p_cam0
// Clocks    t_imu = t_cam0 + time_offset,   t_cam1 = t_cam0 + camera_offset                               [s]
// Shutter   a corner in row v is seen line_delay * v after the time of its image                          [s]
// IMU       gyro = R (angular velocity of the rig) + bias + noise                                         [rad/s]
//           force = R (acceleration of the IMU's origin - gravity) + bias + noise                         [m/s^2]

#include <cstdint>
#include <string>
#include <vector>

#include <mtk/mtk.hpp>
#include <mtk/testing/random.hpp>
#include <slom/measurements/imu_samples.hpp>

#include "simulate/stereo_imu.hpp"

namespace slom::app {

/// What the rig does while the IMU records. All but `full` leave something open.
enum class SimulatedMotion {
  full,
  translation,  ///< without turning
  one_axis,     ///< turns about one axis through cam0
  rest,
};

struct StereoImuStreamOptions {
  std::uint64_t seed = 1;
  double seconds = 20;
  double camera_rate = 20, imu_rate = 200;  ///< [Hz]
  double sigma_px = 0.1;                    ///< noise of u and of v [px]
  ImuNoise noise{2e-4, 2e-3, 2e-5, 5e-4};
  double time_offset = 0.0123;  ///< [s]
  double camera_offset = 0;     ///< [s]
  double camera_phase = 0;      ///< from an image of cam0 to one of cam1 [s]
  double line_delay = 0;        ///< of both cameras [s/row]
  SimulatedMotion motion = SimulatedMotion::full;
  int tags = 6;                            ///< in a row, and in a column
  double square_m = 0.088, spacing = 0.3;  ///< side of a tag; gap, in sides
  std::int64_t epoch_ns =
      1'700'000'000'000'000'000;                 ///< time of the first image, in the clock of the cameras
  mtk::vect<3> gyro_bias{0.004, -0.011, 0.007};  ///< at the first reading [rad/s]
  mtk::vect<3> force_bias{0.06, -0.03, 0.11};    ///< likewise [m/s^2]
  mtk::trafo<mtk::SO3<>> cam0_to_imu{mtk::SO3<>::exp(mtk::vect<3>(0.03, -0.02, 1.55)),
                                     mtk::vect<3>(0.06, -0.02, 0.015)};
};

/// The pose of cam0 over time: sums of sines, so that the IMU's readings are smooth.
class SimulatedPath {
 public:
  SimulatedPath(const StereoImuStreamOptions& options, SimulatedMotion motion);
  /// Returns the pose of cam0 in the world, `time` seconds after the first image.
  mtk::trafo<mtk::SO3<>> operator()(double time) const;

 private:
  struct Sine {
    double amplitude, frequency, phase;
  };
  mtk::vect<3> sum(const std::vector<Sine> (&axes)[3], double time) const;

  SimulatedMotion motion_;
  mtk::vect<3> centre_;  ///< of the board
  std::vector<Sine> orbit_[3], shift_[3], turn_[3];
};

struct StreamCorner {
  std::int64_t time_ns;
  int corner;  ///< 4 tag + k, k = 0..3 anticlockwise from the corner at the tag's origin
  mtk::vect<2> pixel;
};

struct StereoImuStreamData {
  int image_width_px, image_height_px;
  SimulatedCamera cam0, cam1;
  mtk::trafo<mtk::SO3<>> cam0_to_cam1;
  mtk::vect<3> gravity;                ///< in the world [m/s^2]
  mtk::vect<3> gyro_bias, force_bias;  ///< means over the readings
  std::vector<StreamCorner> corners[2];
  std::int64_t imu_epoch_ns = 0;  ///< time of the samples' zero, in the clock of the IMU
  std::vector<ImuSample> imu;
};

/// Returns the place of a corner on the board [m].
mtk::vect<3> streamCornerInWorld(const StereoImuStreamOptions& options, int corner);

/// Draws motion and noise. The cameras are always the same; options and seed determine the rest. Motion and each noise
/// are drawn separately, so equal seeds with different noise give the same motion. A tag that is not wholly in the
/// image is missing. If the motion is not full, views from all sides, 1 s apart, precede the readings of the IMU: they
/// are enough to calibrate the cameras.
StereoImuStreamData simulateStereoImuStream(const StereoImuStreamOptions& options);

}  // namespace slom::app
