// A rig of cameras with an IMU that looks at a level board, with known truth, for the tests of the
// calibration.
#pragma once

#include <map>
#include <random>
#include <vector>

#include <slom/calibration.hpp>

#include "calibration/models/opencv.hpp"

namespace slom::calibration::testing {

struct RigTruth {
  std::vector<Opencv5<>> cameras;
  std::vector<SE3> left2camera;  ///< one per camera; the first is the identity
  std::map<int, SE3> left2world;
  SO3 left2imu;
  vec3 acc_bias;
  double gravity = 9.81;
};

struct RigOptions {
  int cameras = 2;
  int images = 8;
  int columns = 8, rows = 6;  ///< corners of the board
  double square_m = 0.05;
  double sigma_px = 0.25, sigma_acc = 0.05;
  double tilt = 0.5;    ///< largest tilt of the line of observation against the vertical [rad]
  bool z_down = false;  ///< the board's z axis points away from the cameras
  bool distorted = true;
  double focal_length = 600;  ///< [px]
  double distance = 0.6;      ///< to the board [m]
};

/// A rig that looks at the board from above, every image from another side.
inline RigTruth simulateTruth(const RigOptions& options, std::mt19937_64& random) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random);
  };
  RigTruth truth;
  for (int c = 0; c < options.cameras; ++c) {
    const double f = options.focal_length + 10 * c;
    Opencv5<> camera{f, f * 1.01, 330., 245. - 5 * c, 0., 0., 0., 0., 0.};
    if (options.distorted) camera.tail<5>() << -0.2, 0.08, 0.001, -0.0005, 0.01;
    truth.cameras.push_back(camera);
    truth.left2camera.push_back(
        c == 0 ? SE3() : SE3(SO3::exp(vec3(6 / f, 18 * c / f, -0.02)), vec3(-0.08 * c, 0.002, 0.004)));
  }
  const double width = options.square_m * (options.columns - 1),
               height = options.square_m * (options.rows - 1);
  for (int image = 1; image <= options.images; ++image) {
    // Camera above the centre of the board, looking down (x right, y towards the viewer), then tilted about
    // it.
    const SO3 down = SO3::exp(vec3(options.z_down ? 0. : M_PI, 0., 0.));
    const SO3 spin = SO3::exp(vec3(0., 0., uniform(-1, 1)));
    const double direction = uniform(0, 2 * M_PI), tilt = options.tilt * uniform(0.4, 1);
    const SO3 lean = SO3::exp(vec3(tilt * std::cos(direction), tilt * std::sin(direction), 0.));
    const SO3 orient = lean * spin * down;
    const vec3 centre(width / 2 + uniform(-0.03, 0.03), height / 2 + uniform(-0.03, 0.03), 0.);
    const double distance = options.distance * uniform(0.9, 1.3);
    truth.left2world[image] = SE3(orient, vec3(centre - distance * (orient * vec3(0., 0., 1.))));
  }
  truth.left2imu = SO3::exp(vec3(1.2, -0.7, 2.1));
  truth.acc_bias = vec3(0.1, -0.05, 0.08);
  return truth;
}

/// Measurements of it, with noise; corners outside 640 x 480 px are missing.
inline Dataset simulateMeasurements(const RigTruth& truth, const RigOptions& options,
                                    std::mt19937_64& random) {
  std::normal_distribution<> normal;
  Dataset data;
  for (std::size_t c = 0; c < truth.cameras.size(); ++c) {
    CameraData camera{std::string(1, "abcdefgh"[c]), "camera.csv", {}};
    int line = 1;
    for (const auto& [image, left2world] : truth.left2world) {
      View view{image, {}};
      for (int k = 0; k < options.columns * options.rows; ++k) {
        const vec3 world(options.square_m * (k % options.columns), options.square_m * (k / options.columns),
                         0.);
        const vec3 point = truth.left2camera[c] * (left2world.inverse() * world);
        const vec2 pixel = truth.cameras[c].project(point);
        const vec2 noise(normal(random), normal(random));
        const bool inside = pixel.x() > 0 && pixel.x() < 640 && pixel.y() > 0 && pixel.y() < 480;
        if (inside) view.corners.push_back({k + 1, world, vec2(pixel + options.sigma_px * noise), ++line});
      }
      if (view.corners.size() >= 6) camera.views.push_back(view);
    }
    data.cameras.push_back(camera);
  }
  data.imu = ImuData{"imu.csv", {}};
  for (const auto& [image, left2world] : truth.left2world) {
    const vec3 noise(normal(random), normal(random), normal(random));
    const vec3 up = left2world.orient.inverse() * vec3(0., 0., truth.gravity);
    data.imu->readings.push_back(
        {image, vec3(truth.left2imu * up + truth.acc_bias + options.sigma_acc * noise), image + 1});
  }
  return data;
}

/// Angle between two rotations [rad].
inline double angleBetween(const SO3& a, const SO3& b) { return SO3::log(a.inverse() * b).norm(); }

}  // namespace slom::calibration::testing
