#pragma once
// A simulated stereo camera with an accelerometer that looks at a level chessboard, with known truth.
//
// Frames    world   the board's: x along a row of corners, z up, origin at the first corner     [m]
//           left    the reference camera: z forward, x right, y down                            [m]
//           p_left = left2world^-1 * p_world,   p_right = left2right * p_left
// Camera    OpenCV's model with k1 k2 p1 p2 k3; the centre of the first pixel is (0, 0)
// IMU       reading = R_left2imu * R_left2world^T * (0, 0, gravity) + acc_bias                  [m/s^2]

#include <cstdint>
#include <vector>

#include <mtk/mtk.hpp>

namespace slom::app {

struct StereoImuOptions {
  std::uint64_t seed = 1;
  int images = 12;
  double sigma_px = 0.25;   ///< noise of u and of v [px]
  double sigma_acc = 0.05;  ///< noise of each axis of the accelerometer [m/s^2]
};

/// Intrinsic parameters as OpenCV defines them.
struct SimulatedCamera {
  double fx, fy, cx, cy, k1, k2, p1, p2, k3;

  /// The pixel of a point in camera coordinates that lies in front of the camera.
  mtk::vect<2> project(const mtk::vect<3>& point) const;
};

/// What the simulated device is.
struct StereoImuTruth {
  int image_width_px, image_height_px;
  SimulatedCamera left, right;
  mtk::trafo<mtk::SO3<>> left2right;
  mtk::SO3<> left2imu;
  mtk::vect<3> acc_bias;                           ///< [m/s^2]
  double gravity;                                  ///< [m/s^2]
  std::vector<mtk::trafo<mtk::SO3<>>> left2world;  ///< pose of image 1, 2, ...
};

struct SimulatedCorner {
  int image;   ///< 1, 2, ...
  int corner;  ///< 1, 2, ... along the rows of the board
  mtk::vect<3> world;
  mtk::vect<2> pixel;
};

struct SimulatedAcceleration {
  int image;
  mtk::vect<3> reading;  ///< zero where not valid
  bool valid;
};

struct StereoImuData {
  StereoImuTruth truth;
  std::vector<SimulatedCorner> left, right;
  std::vector<SimulatedAcceleration> imu;
};

/// Draws the views and the noise. The device is always the same; the seed decides the rest, and noise is
/// drawn apart from views, so that equal seeds with different sigmas see the same. As in real data, corners
/// outside an image are missing, in some images one camera sees nothing, and some accelerometer readings are
/// not valid.
StereoImuData simulateStereoImu(const StereoImuOptions& options);

}  // namespace slom::app
