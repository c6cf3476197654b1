/// What was measured: corners of a board seen by cameras, and accelerometer readings, linked by image numbers.
///
/// What is required of the data; anything else is a DataError that names camera, image and corner, or the reading, before
/// anything is computed:
///   cameras   at least one; each has a name of its own, which is not empty, and at least two views. Cameras are connected by
///             common images, directly or through other cameras. An image size is known with both sides from 1 to most_side_px,
///             or it is unknown.
///   views     at most one for each camera and image number, in any order: the result is that of views sorted by image number, to
///             the last bit. A view has at least four corners that lie in a plane and not, or all but one, on a line.
///   corners   finite coordinates, of magnitude most_corner_px and most_corner_m at most; no point of the board is in a view
///             twice. Corner::number is a name for messages and reports alone, and Corner::sigma lies from
///             least_corner_sigma to most_corner_sigma.
///   readings  finite, of magnitude most_reading_m_s2 at most; at most one for each image, and of an image that some camera has.
///             An ImuData without readings is an error; without an IMU, Dataset::imu stays empty.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// Magnitudes beyond which a coordinate or a reading is taken for a mistake.
inline constexpr double most_corner_px = 1e6, most_corner_m = 1e6, most_reading_m_s2 = 1e6;
/// What Corner::sigma can be.
inline constexpr double least_corner_sigma = 1e-3, most_corner_sigma = 1e3;

/// A corner of the board, found in an image.
struct Corner {
  int number = 0;  ///< to name it by
  vec3 world;      ///< [m], world z vertical
  vec2 pixel;      ///< [px]; the principal point comes out in the same count, from 0 or from 1
  int line = 0;    ///< line in CameraData::file, for messages; 0: it has none
  double sigma =
      1;  ///< standard deviation over Settings::sigma_px: 2 where a detector says that it is twice as uncertain
};

/// What one camera saw in one image.
struct View {
  int image = 0;
  std::vector<Corner> corners;
  std::string photo{};  ///< file of the photograph that the corners were found in; empty: unknown
  std::string file{};   ///< what messages call the source of the corners; empty: CameraData::file
};

/// A photograph that the fit does without.
struct UnusedPhoto {
  std::optional<int> image{};  ///< nothing where its name has no number
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

/// A view, or one of its corners, that the user wants the fit to do without.
struct Exclusion {
  std::string camera{};  ///< empty: all cameras that have the image
  int image = 0;
  std::optional<int> corner{};  ///< Corner::number; nothing: the whole view
};

/// The size of all images of a camera [px].
struct ImageSize {
  int width = 0, height = 0;
};
inline constexpr int most_side_px = 100'000;  ///< width or height of an image [px]
/// Both sides from 1 to most_side_px.
bool isPlausible(const ImageSize& size);

/// The views of one camera, and what is known of it.
struct CameraData {
  std::string name;
  std::string file{};       ///< what messages call the source of the corners; it is never opened
  std::vector<View> views;  ///< in any order of their images
  std::optional<ImageSize> image_size{};  ///< nullopt: unknown
  std::vector<UnusedPhoto> unused{};      ///< by rising image number, those without one first
  std::vector<Copy> copies{};             ///< by rising image number
  std::vector<Exclusion> excluded{};      ///< what exclude() has taken out
  int board_symmetry = 1;                 ///< in how many ways the board looks the same (Board::symmetry)

  /// The number of corners in all views.
  std::size_t cornerCount() const;
  /// The view of an image, or nullptr. Quickest where the views are sorted by image number.
  const View* find(int image) const;
  /// Where a corner comes from, as errors begin: `left.csv:7`, or the photograph that it was found in.
  std::string place(const View& view, const Corner& corner) const;
};

/// As messages begin: what CameraData::file says, or else `camera left`.
std::string nameOf(const CameraData& camera);

/// What the accelerometer read while an image was taken, the rig at rest.
struct ImuReading {
  int image = 0;
  vec3 acc;      ///< [m/s^2], in the axes of the IMU
  int line = 0;  ///< line in ImuData::file, for messages; 0: it has none
};

/// The readings of the accelerometer, at most one for each image.
struct ImuData {
  std::string file{};  ///< what messages call it
  std::vector<ImuReading> readings;

  /// Where a reading comes from, as errors begin: `imu.csv:2`, or `imu.readings[4]` where it has no line.
  std::string place(std::size_t index) const;
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

/// Takes out views and corners, and lists them in CameraData::excluded; readings of the IMU of images that no camera has then go with them.
/// DataError [slom.calibration.nothing-to-exclude] where there is no such camera, image or corner, and where a corner is named of several
/// cameras at once; the data are then as they were before.
void exclude(Dataset& data, const std::vector<Exclusion>& exclusions);

/// Leaves out the views that repeat an earlier one of their camera, and lists them in CameraData::copies;
/// with them the readings of the IMU of images that no camera has then. A photograph given twice does not count as a further
/// measurement; taken as one, it makes all uncertainties too small, and agrees with itself in cross-validation. The time grows as the number of
/// corners does, but where thousands of frames are of a camera at rest. DataError where two cameras have most
/// of their views in common, and where of a camera's views only one is left; the data are then as they were before. Sorts the views by
/// image number.
///
/// A view repeats another one when three quarters of the corners of the smaller one, and four at least, are
/// the same points of the board within 0.005 px of each other. Frames of a camera at rest differ by more: no
/// detector has less noise than 0.02 px.
void leaveOutCopies(Dataset& data);

}  // namespace slom::calibration
