#include "simulate/stereo_imu.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include <mtk/testing/random.hpp>

namespace slom::app {

namespace {

using SE3 = mtk::trafo<mtk::SO3<>>;
using mtk::testing::Random;

// The board: 12 x 8 corners.
constexpr int kBoardColumns = 12;
constexpr int kBoardRows = 8;
constexpr double kSquareSize = 0.03;  // [m]

// Streams of random numbers.
constexpr std::uint32_t kViewStream = 1;
constexpr std::uint32_t kPixelStream = 2;
constexpr std::uint32_t kAccelerationStream = 3;

/// Returns a head with two 1.2 megapixel cameras, 8 cm apart, and an accelerometer with the axes of a body frame (x
/// forward, y left, z up). All are mounted with errors of some degrees.
StereoImuTruth device() {
  StereoImuTruth truth;
  truth.image_width_px = 1280;
  truth.image_height_px = 960;
  truth.left = {1046.3, 1044.9, 643.2, 475.8, -0.2130, 0.1080, 0.0006, -0.0004, -0.0210};
  truth.right = {1051.8, 1050.6, 632.7, 484.1, -0.2080, 0.1010, -0.0003, 0.0007, -0.0170};
  truth.left2right =
      SE3(mtk::SO3<>::exp(mtk::vect<3>(0.004, -0.025, 0.007)), mtk::vect<3>(-0.0803, 0.0006, 0.0011));
  truth.left2imu = mtk::SO3<>::exp(mtk::vect<3>(-1.25, 1.19, -1.16));
  truth.acc_bias = mtk::vect<3>(0.12, -0.08, 0.21);
  truth.gravity = 9.81;
  return truth;
}

mtk::vect<3> boardPoint(int column, int row) {
  return mtk::vect<3>(column * kSquareSize, row * kSquareSize, 0.0);
}

/// Returns the pose of the left camera in view `index`, tilted by 20 to 50 degrees against the vertical. The direction
/// of the tilt turns by the golden angle from view to view. Both cameras aim near the middle of the board.
SE3 drawView(int index, Random& random) {
  constexpr double degree = std::numbers::pi / 180;
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  const double tilt = random.uniform(20, 50) * degree;
  const double azimuth = index * golden_angle + random.uniform(-15, 15) * degree;
  const double roll = random.uniform(-25, 25) * degree;
  const double distance = random.uniform(0.28, 0.46);
  // Each number has its own statement, because C++ leaves the order of evaluation of arguments open.
  const double shift_x = random.uniform(-0.08, 0.08);
  const double shift_y = random.uniform(-0.06, 0.06);
  const mtk::vect<3> target =
      0.5 * boardPoint(kBoardColumns - 1, kBoardRows - 1) + mtk::vect<3>(shift_x, shift_y, 0.0);

  const mtk::vect<3> towards_camera(std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth),
                                    std::cos(tilt));
  Eigen::Matrix3d axes;  // columns: x (right, horizontal), y (down), z (forward) of the camera
  axes.col(2) = -towards_camera;
  axes.col(0) = axes.col(2).cross(Eigen::Vector3d::UnitZ()).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  const mtk::SO3<> orient = mtk::SO3<>(axes) * mtk::SO3<>::exp(mtk::vect<3>(0.0, 0.0, roll));
  const mtk::vect<3> between_cameras = target + distance * towards_camera;
  return SE3(orient, between_cameras - orient * mtk::vect<3>(0.04, 0.0, 0.0));
}

/// Returns the corners of the board that one camera sees, without noise.
std::vector<SimulatedCorner> visibleCorners(int image, const SimulatedCamera& camera, const SE3& world2camera,
                                            const StereoImuTruth& truth) {
  std::vector<SimulatedCorner> corners;
  for (int row = 0; row < kBoardRows; ++row) {
    for (int column = 0; column < kBoardColumns; ++column) {
      const mtk::vect<3> world = boardPoint(column, row);
      const mtk::vect<3> point = world2camera * world;
      if (point.z() <= 0 || point.head<2>().norm() > point.z())
        continue;  // behind the camera, or more than 45 degrees off its axis
      const mtk::vect<2> pixel = camera.project(point);
      const bool inside = pixel.x() >= 0 && pixel.x() <= truth.image_width_px - 1 &&  //
                          pixel.y() >= 0 && pixel.y() <= truth.image_height_px - 1;
      if (inside) corners.push_back({image, row * kBoardColumns + column + 1, world, pixel});
    }
  }
  return corners;
}

struct View {
  SE3 left2world;
  std::vector<SimulatedCorner> left, right;
};

/// Returns a view in which each camera sees at least half of the board.
View drawUsableView(int index, const StereoImuTruth& truth, Random& random) {
  constexpr std::size_t enough = kBoardColumns * kBoardRows / 2;
  View view;
  do {
    view.left2world = drawView(index, random);
    const SE3 world2left = view.left2world.inverse();
    view.left = visibleCorners(index + 1, truth.left, world2left, truth);
    view.right = visibleCorners(index + 1, truth.right, truth.left2right * world2left, truth);
  } while (view.left.size() < enough || view.right.size() < enough);
  return view;
}

}  // namespace

mtk::vect<2> SimulatedCamera::project(const mtk::vect<3>& point) const {
  const double x = point.x() / point.z(), y = point.y() / point.z();
  const double r2 = x * x + y * y;
  const double g = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double x_distorted = x * g + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
  const double y_distorted = y * g + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
  return mtk::vect<2>(fx * x_distorted + cx, fy * y_distorted + cy);
}

StereoImuData simulateStereoImu(const StereoImuOptions& options) {
  StereoImuData data;
  data.truth = device();
  Random view_random(options.seed, kViewStream);
  Random pixel_random(options.seed, kPixelStream);
  Random acceleration_random(options.seed, kAccelerationStream);

  const auto add_noisy = [&](const std::vector<SimulatedCorner>& seen,
                             std::vector<SimulatedCorner>& corners) {
    for (SimulatedCorner corner : seen) {
      corner.pixel.x() += options.sigma_px * pixel_random.normal();
      corner.pixel.y() += options.sigma_px * pixel_random.normal();
      corners.push_back(corner);
    }
  };

  for (int image = 1; image <= options.images; ++image) {
    const View view = drawUsableView(image - 1, data.truth, view_random);
    data.truth.left2world.push_back(view.left2world);
    const bool left_fails = image % 6 == 5, right_fails = image % 6 == 4, imu_fails = image % 5 == 3;
    if (!left_fails) add_noisy(view.left, data.left);
    if (!right_fails) add_noisy(view.right, data.right);

    SimulatedAcceleration acceleration{image, mtk::vect<3>(), !imu_fails};
    if (acceleration.valid) {
      const mtk::vect<3> up(0.0, 0.0, data.truth.gravity);
      acceleration.reading =
          data.truth.left2imu * (view.left2world.orient.inverse() * up) + data.truth.acc_bias;
      for (int axis = 0; axis < 3; ++axis) {
        acceleration.reading[axis] += options.sigma_acc * acceleration_random.normal();
      }
    }
    data.imu.push_back(acceleration);
  }
  return data;
}

}  // namespace slom::app
