// Parts that the paper omits for brevity: reading the measurements, and rough start values.
#pragma once

#include <string>
#include <vector>

#include "types.hpp"

/// A corner seen by both cameras.
struct StereoCorner {
  vec3 world;        ///< [m]
  vec2 left, right;  ///< [px]
};

/// One pose of the head.
struct Image {
  std::vector<StereoCorner> corners;
  bool has_acc = false;
  vec3 acc;          ///< accelerometer reading [m/s^2]
};

/// Reads left_corners.csv, right_corners.csv and imu.csv of a folder. Throws std::runtime_error if a file is missing.
std::vector<Image> readImages(const std::string& folder);

/// Returns f, f, cx, cy for the centre of a 1280 x 960 image, without distortion.
Camera guessCamera();
/// Returns left2world of an image for ideal cameras, from the homography between board and image.
SE3 guessPose(const Image& image, bool right_camera = false);
/// Returns the rotation that maps "up", as seen by the left cameras, to the accelerometer readings.
SO3 guessImuRotation(const std::vector<Image>& images);
