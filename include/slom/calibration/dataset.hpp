/// The measured data: corners of a board in images of cameras, and accelerometer readings, linked by image numbers.
///
/// The data must fulfil these requirements. Otherwise a DataError names camera, image and corner, or the reading,
/// before anything is computed:
///   cameras   at least one; each has its own name, which is not empty, and at least two views. Cameras are connected
///             by common images, directly or through other cameras. An image size is unknown, or both sides are from 1
///             to most_side_px.
///   views     at most one for each camera and image number, in any order: the result is that of views sorted by
///             image number, to the last bit. A view has at least four corners in a plane that are not all, or all
///             but one, on a line.
///   corners   finite coordinates, of magnitude most_corner_px and most_corner_m at most; no point of the board is in a
///             view twice. Corner::number is only a name for messages and reports. Corner::sigma lies from
///             least_corner_sigma to most_corner_sigma.
///   readings  finite, of magnitude most_reading_m_s2 at most; at most one for each image, and only of images that some
///             camera has. An ImuData without readings is an error; without an IMU, Dataset::imu stays empty.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// Magnitudes beyond which a coordinate or a reading counts as a mistake.
inline constexpr double most_corner_px = 1e6, most_corner_m = 1e6, most_reading_m_s2 = 1e6;
/// Limits of Corner::sigma.
inline constexpr double least_corner_sigma = 1e-3, most_corner_sigma = 1e3;

/// A corner of the board found in an image.
struct Corner {
  int number = 0;  ///< name for messages
  vec3 world;      ///< [m], world z vertical
  vec2 pixel;      ///< [px]; counted from 0 or from 1, the principal point of the result is in the same count
  int line = 0;    ///< line in CameraData::file, for messages; 0: none
  /// Standard deviation divided by Settings::sigma_px. For example 2 if a detector reports twice the uncertainty.
  double sigma = 1;
  /// Derivative of the pixel by CameraResult::readout [px]. calibrate() sets it if Settings::rolling_shutter is true.
  vec2 by_readout{0., 0.};
};

/// The corners of one camera in one image.
struct View {
  int image = 0;
  std::vector<Corner> corners;
  std::string photo{};  ///< file of the photograph with the corners; empty: unknown
  std::string file{};   ///< source of the corners in messages; empty: CameraData::file
  std::optional<std::int64_t>
      time_ns{};  ///< when it was taken, in the clock of the cameras; nothing: unknown
};

/// A photograph that the fit does not use.
struct UnusedPhoto {
  std::optional<int> image{};  ///< nothing if its name has no number
  std::string file;
  std::string reason;  ///< continues the name: "shows no board"
};

/// A view that the fit does not use, because it repeats an earlier one of its camera.
struct Copy {
  int image = 0, original = 0;
  std::string photo{}, original_photo{};       ///< empty: unknown
  std::size_t corners = 0, equal_corners = 0;  ///< number of corners in both; number of these that are equal
  double difference_px = 0;                    ///< largest difference between equal corners
  bool has_reading = false;                    ///< a reading of the IMU is left out with the view
};

/// A view or corner that the user excludes from the fit.
struct Exclusion {
  std::string camera{};  ///< empty: all cameras that have the image
  int image = 0;
  std::optional<int> corner{};  ///< Corner::number; nothing: the whole view
};

/// The size of all images of a camera [px].
struct ImageSize {
  int width = 0, height = 0;
};
inline constexpr int most_side_px = 100'000;  ///< largest width or height of an image [px]
/// Returns whether both sides are from 1 to most_side_px.
bool isPlausible(const ImageSize& size);

/// The views of one camera, and other data of the camera.
struct CameraData {
  std::string name;
  std::string file{};                     ///< source of the corners in messages; never opened
  std::vector<View> views;                ///< in any order
  std::optional<ImageSize> image_size{};  ///< nullopt: unknown
  std::vector<UnusedPhoto> unused{};      ///< by rising image number, those without a number first
  std::vector<Copy> copies{};             ///< by rising image number
  std::vector<Exclusion> excluded{};      ///< views and corners that exclude() has removed
  int board_symmetry = 1;                 ///< number of ways the board looks the same (Board::symmetry)

  /// Returns the number of corners in all views.
  std::size_t cornerCount() const;
  /// Returns the view of an image, or nullptr. Fastest if the views are sorted by image number.
  const View* find(int image) const;
  /// Returns the source of a corner, with which errors begin: `left.csv:7`, or the photograph of the corner.
  std::string place(const View& view, const Corner& corner) const;
};

/// Returns the name with which messages begin: CameraData::file or, if that is empty, `camera left`.
std::string nameOf(const CameraData& camera);

/// A reading of the accelerometer while an image was taken, with the rig at rest.
struct ImuReading {
  int image = 0;
  vec3 acc;      ///< [m/s^2], in the axes of the IMU
  int line = 0;  ///< line in ImuData::file, for messages; 0: none
};

/// The readings of the accelerometer, at most one for each image.
struct ImuData {
  std::string file{};  ///< source of the readings in messages
  std::vector<ImuReading> readings;

  /// Returns the source of a reading, with which errors begin: `imu.csv:2`, or `imu.readings[4]` if it has no line.
  std::string place(std::size_t index) const;
};

/// All data. The first camera is the reference.
struct Dataset {
  std::vector<CameraData> cameras;
  std::optional<ImuData> imu;

  /// Returns the image numbers that any camera has, in rising order.
  std::vector<int> images() const;
  /// Returns only the images with `is_wanted(number)`, of all cameras, without the IMU.
  Dataset withImages(const std::function<bool(int)>& is_wanted) const;
};

/// Removes views and corners, and lists them in CameraData::excluded. Readings of the IMU of images that no camera has
/// any more are also removed. Throws DataError [slom.calibration.nothing-to-exclude] if a camera, image or corner does
/// not exist, or if a corner is named for several cameras at once. The data are then unchanged.
void exclude(Dataset& data, const std::vector<Exclusion>& exclusions);

/// Removes views that repeat an earlier one of their camera, and lists them in CameraData::copies. Readings of the IMU
/// of images that no camera has any more are also removed. A photograph given twice is not a further measurement. If it
/// counted as one, all uncertainties would be too small, and in cross-validation the photograph would agree with
/// itself.
///
/// The time grows linearly with the number of corners, unless there are thousands of frames of a camera at rest. Throws
/// DataError if two cameras have most of their views in common, or if only one view of a camera remains. The data are
/// then unchanged. Sorts the views by image number.
///
/// A view repeats another if at least 3/4 of the corners of the smaller one, and at least 4, are the same points of the
/// board within 0.005 px of each other. Frames of a camera at rest differ by more, because every detector has a noise
/// of at least 0.02 px.
void leaveOutCopies(Dataset& data);

}  // namespace slom::calibration
