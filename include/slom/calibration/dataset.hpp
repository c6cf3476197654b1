/// What was measured: corners of a board seen by cameras, and accelerometer readings, linked by image numbers.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// A corner of the board, found in an image.
struct Corner {
  int number = 0;  ///< to name it by
  vec3 world;      ///< [m], world z vertical
  vec2 pixel;      ///< [px]; the principal point comes out in the same count, from 0 or from 1
  int line = 0;    ///< of CameraData::file, for messages; 0: it has none
};

/// What one camera saw in one image.
struct View {
  int image = 0;
  std::vector<Corner> corners;
  std::string photo{};  ///< file of the photograph that the corners were found in; empty: unknown
};

/// A photograph that the fit does without.
struct UnusedPhoto {
  int image = 0;
  std::string file;
  std::string reason;  ///< goes on where the name ends: "shows no board"
};

/// A view that the fit does without because it repeats an earlier one of its camera.
struct Copy {
  int image = 0, original = 0;
  std::string photo{}, original_photo{};       ///< empty: unknown
  std::size_t corners = 0, equal_corners = 0;  ///< that both have; of these, that are equal
  double difference_px = 0;                    ///< the largest between equal ones
  bool has_reading = false;                    ///< of the IMU, left out with it
};

/// Of all images of a camera [px].
struct ImageSize {
  int width = 0, height = 0;
};
inline constexpr int most_side_px = 100'000;  ///< width or height of an image [px]
/// Both sides from 1 to most_side_px.
bool isPlausible(const ImageSize& size);

struct CameraData {
  std::string name;
  std::string file{};       ///< what messages call the source of the corners; it is never opened
  std::vector<View> views;  ///< by rising image number, none empty
  std::optional<ImageSize> image_size{};  ///< nullopt: unknown
  std::vector<UnusedPhoto> unused{};      ///< by rising image number
  std::vector<Copy> copies{};             ///< by rising image number
  int board_symmetry = 1;                 ///< in how many ways the board looks the same (Board::symmetry)

  std::size_t cornerCount() const;
  /// The view of an image, or nullptr.
  const View* find(int image) const;
  /// Where a corner comes from, as errors begin: `left.csv:7`, or the photograph that it was found in.
  std::string place(const View& view, const Corner& corner) const;
};

/// As messages begin: what CameraData::file says, or else `camera left`.
std::string nameOf(const CameraData& camera);

struct ImuReading {
  int image = 0;
  vec3 acc;  ///< [m/s^2], in the axes of the IMU
  int line = 0;
};

struct ImuData {
  std::string file{};  ///< what messages call it
  std::vector<ImuReading> readings;
};

/// All of it. The first camera is the reference.
struct Dataset {
  std::vector<CameraData> cameras;
  std::optional<ImuData> imu;

  /// Image numbers that any camera has, rising.
  std::vector<int> images() const;
  /// The images `is_wanted(number)` alone, of all cameras, without the IMU.
  Dataset withImages(const std::function<bool(int)>& is_wanted) const;
};

/// Leaves out the views that repeat an earlier one of their camera, and lists them in CameraData::copies;
/// with them the readings of the IMU of images that no camera has then. A photograph given twice is no further measurement; taken
/// as one, it makes all uncertainties too small, and agrees with itself in cross-validation. The time grows as the number of
/// corners does, but where thousands of frames are of a camera at rest. DataError where two cameras have most
/// of their views in common, and where of a camera's views only one is left.
///
/// A view repeats another one when three quarters of the corners of the smaller one, and four at least, are
/// the same points of the board within 0.005 px of each other. Frames of a camera at rest differ by more: no
/// detector has less noise than 0.02 px.
void leaveOutCopies(Dataset& data);

}  // namespace slom::calibration
