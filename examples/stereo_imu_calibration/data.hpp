// What the paper leaves out for brevity: reading the measurements and finding rough start values.
#pragma once

#include <string>
#include <vector>

#include "types.hpp"

/// A corner that both cameras see.
struct StereoCorner {
  vec3 world;        ///< [m]
  vec2 left, right;  ///< [px]
};

/// One position of the head.
struct Image {
  std::vector<StereoCorner> corners;
  bool has_acc = false;
  vec3 acc;          ///< accelerometer reading [m/s^2]
};

/// Reads left_corners.csv, right_corners.csv and imu.csv of a folder. Throws std::runtime_error for a missing file.
std::vector<Image> readImages(const std::string& folder);

/// f, f, cx, cy for the centre of a 1280 x 960 image, no distortion.
Camera guessCamera();
/// left2world of an image for ideal cameras, from the homography between board and image.
SE3 guessPose(const Image& image, bool right_camera = false);
/// The rotation that turns "up", as the left cameras see it, into the accelerometer readings.
SO3 guessImuRotation(const std::vector<Image>& images);
