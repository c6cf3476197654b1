// What was measured: corners of a board seen by cameras, and accelerometer readings, linked by image numbers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrate/types.hpp"

namespace slom::app::calib {

/// A corner of the board, found in an image.
struct Corner {
  int number = 0;  ///< as the file counts it
  vec3 world;      ///< [m], world z vertical
  vec2 pixel;      ///< [px], in the file's convention for the first pixel
  int line = 0;    ///< of the file
};

/// What one camera saw in one image.
struct View {
  int image = 0;
  std::vector<Corner> corners;
  std::string photo{};  ///< file of the photograph that the corners were found in; empty: unknown
};

/// Of all images of a camera [px].
struct ImageSize {
  int width = 0, height = 0;
};

struct CameraData {
  std::string name;
  std::string file;
  std::vector<View> views;              ///< by rising image number, none empty
  std::optional<ImageSize> image_size{};  ///< nullopt: unknown

  std::size_t cornerCount() const;
  /// The view of an image, or nullptr.
  const View* find(int image) const;
};

struct ImuReading {
  int image = 0;
  vec3 acc;  ///< [m/s^2], in the axes of the IMU
  int line = 0;
};

struct ImuData {
  std::string file;
  std::vector<ImuReading> readings;  ///< the valid ones
};

/// All of it. The first camera is the reference.
struct Dataset {
  std::vector<CameraData> cameras;
  std::optional<ImuData> imu;

  /// Image numbers that any camera has, rising.
  std::vector<int> images() const;
};

}  // namespace slom::app::calib
