#pragma once
// A simulated stereo camera with an accelerometer, in front of a level chessboard, with known truth.
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

  /// Returns the pixel of a point in camera coordinates that is in front of the camera.
  mtk::vect<2> project(const mtk::vect<3>& point) const;
};

/// Truth of the simulated device.
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
  mtk::vect<3> reading;  ///< zero if not valid
  bool valid;
};

struct StereoImuData {
  StereoImuTruth truth;
  std::vector<SimulatedCorner> left, right;
  std::vector<SimulatedAcceleration> imu;
};

/// Draws the views and the noise. The device is always the same; the seed determines the rest. Noise is drawn
/// separately from views, so equal seeds with different sigmas give the same views. As in real data, corners outside an
/// image are missing, one camera sees nothing in some images, and some accelerometer readings are not valid.
StereoImuData simulateStereoImu(const StereoImuOptions& options);

}  // namespace slom::app
