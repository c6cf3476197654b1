/// Corners and readings from and to files that `slom calibrate` reads. docs/calibrate/corners.md has their columns.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/image_numbers.hpp"

namespace slom::calibration {

/// The board of corner files of other programs. They list the corners of each image row by row, and some lack the
/// positions of the corners.
struct BoardOfFiles {
  int columns = 0, rows = 0;   ///< corners along a row, and rows; 0: unknown
  double square_m = 0;         ///< distance between neighbouring corners [m]; 0: unknown
  std::vector<vec3> points{};  ///< positions of the corners [m], row by row; empty: a grid of squares
  /// Positions of the corners by Corner::number [m], for tables without positions. Empty: `points`.
  std::vector<vec3> numbered{};
};

/// Reads the corners of a camera from a file or pipe with the header
/// `image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px`. Rows may be in any order. Blank lines and comments beginning
/// with # are skipped, except `# image_size_px: 640 x 480` and `# photo 7: left07.jpg` (the photograph of image 7).
/// Frames are those of Corner.
///
/// Throws the errors of io::openInput. Throws DataError [slom.calibration.bad-file] with file and line in these cases:
/// no rows, another header, a row of another length, a field that is not a number or too large, a corner that an image
/// lists twice.
///
/// In place of `image`, the first column may be a time with its unit: `t_ns`, whole nanoseconds, `t_us`, `t_ms` or `t_s`;
/// also `timestamp_us` or `time [us]`. The columns world_x_m to world_z_m may be missing if the board is given (readRig).
///
/// Files of other programs are recognised by their first words: `corners.vnl` of mrcal, XML, YAML and JSON of OpenCV's
/// FileStorage with `image_points`. If such a file does not contain the positions of its corners, throws
/// [slom.calibration.no-board].
CameraData readCorners(const std::string& camera_name, const std::string& file);

/// Reads several files of one camera, such as the parts of a recording. Image numbers count through all files, and no
/// image may be in two of them. CameraData::file then names all files, and View::file the file of each view. Also
/// throws [slom.calibration.bad-file] if an image is in two files, or if the image sizes of the files differ.
CameraData readCorners(const std::string& camera_name, const std::vector<std::string>& files);

/// Reads readings of an accelerometer at rest [m/s^2] from a file with the columns
/// `image,ax_m_s2,ay_m_s2,az_m_s2,valid`. Rows with valid = 0 are skipped without looking at their reading or image.
/// Throws as readCorners does, also for two valid rows of an image and for no valid row.
ImuData readImu(const std::string& file);

/// The files of a camera.
struct CameraFiles {
  std::string name;
  std::vector<std::string> files;
};

/// Reads all files of a rig, as readCorners and readImu do for single files; `imu_file` may be empty. If image numbers
/// are too large, they are time stamps, which are paired over all cameras and the IMU (ImageNumbers). If `found` is
/// given, it receives the numbers.
Dataset readRig(const std::vector<CameraFiles>& cameras, const std::string& imu_file,
                ImageNumbers* found = nullptr);

/// Reads a rig from files of other programs, with their board. Throws [slom.calibration.unused-board] if no file needs
/// the board.
Dataset readRig(const std::vector<CameraFiles>& cameras, const std::string& imu_file,
                const BoardOfFiles& board, ImageNumbers* found = nullptr);

/// A calibration target from Kalibr's YAML.
struct KalibrTarget {
  enum class Kind { checkerboard, circlegrid, aprilgrid };
  Kind kind = Kind::checkerboard;
  int columns = 0, rows = 0;                       ///< inner corners, circles or tags
  double column_spacing_m = 0, row_spacing_m = 0;  ///< between corners or circles
  bool is_asymmetric = false;                      ///< circles of odd rows are shifted by half a spacing
  double tag_m = 0, spacing = 0;                   ///< aprilgrid: side of a tag, and gap / side
};

/// Reads Kalibr's `target_type: checkerboard`, `circlegrid` or `aprilgrid`. Throws as readCorners does.
KalibrTarget readKalibrTarget(const std::string& file);

/// A lens from a file of another program.
struct KnownLens {
  std::string model;                                       ///< opencv4, fisheye or double_sphere
  std::vector<std::pair<std::string, double>> parameters;  ///< names of the model, and values
  std::optional<ImageSize> image_size;
};

/// Reads the lenses of Kalibr's camchain (cam0, cam1, ...; pinhole-radtan, pinhole-equi and ds-none), or the lens of EuRoC's
/// sensor.yaml. Throws as readCorners does.
std::vector<KnownLens> readKnownLenses(const std::string& file);

/// Returns the text of a file for readCorners. Numbers have all digits, so reading the text again gives the same data.
/// Standard deviations (Corner::sigma) have no column and are left out. If all views have times, the first column is
/// t_ns.
std::string toCornerFile(const CameraData& camera);

}  // namespace slom::calibration
