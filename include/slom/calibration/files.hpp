/// Corners and readings from and to files: those that `slom calibrate` reads. docs/calibrate.md has their columns.
#pragma once

#include <string>
#include <vector>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/image_numbers.hpp"

namespace slom::calibration {

/// What is known of the board in others' corner files, which list the corners of each image row by row and do not all say where these lie.
struct BoardOfFiles {
  int columns = 0, rows = 0;   ///< corners along a row, and rows; 0: unknown
  double square_m = 0;         ///< how far corners are apart [m]; 0: unknown
  std::vector<vec3> points{};  ///< where they lie [m], row by row; empty: in a grid of squares
};

/// Reads what a camera saw from a file of lines `image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px` below a header of these words, in any
/// order; a pipe will do. Blank lines and comments, which begin with #, are skipped, but `# image_size_px: 640 x 480` and
/// `# photo 7: left07.jpg` (the photograph of image 7) are understood. Frames are those of Corner.
/// Throws the errors of io::openInput; and DataError [slom.calibration.bad-file], naming file and line, for a file without rows, with another
/// header or with a row of another length, a field that is not a number or too large, and a corner that is listed twice in an image.
/// Others' files are recognised by their first words: `corners.vnl` of mrcal, XML, YAML and JSON of OpenCV's FileStorage with `image_points`;
/// [slom.calibration.no-board] if such a file does not say where its corners lie.
CameraData readCorners(const std::string& camera_name, const std::string& file);

/// The same from several files of one camera, as from a recording in parts: image numbers count through all of them, and no image may be in two.
/// CameraData::file then names all of them, and View::file the one of each view. Also [slom.calibration.bad-file] where an image is in
/// two files, or the sizes of images in them differ.
CameraData readCorners(const std::string& camera_name, const std::vector<std::string>& files);

/// Reads `image,ax_m_s2,ay_m_s2,az_m_s2,valid`, readings of an accelerometer at rest [m/s^2]. Rows with valid = 0 are skipped: neither
/// their reading nor their image is looked at. Throws as readCorners does, for two valid rows of an image, and for no valid row at all.
ImuData readImu(const std::string& file);

/// The files of a camera.
struct CameraFiles {
  std::string name;
  std::vector<std::string> files;
};

/// Reads all files of a rig, as readCorners and readImu do one by one; `imu_file` may be empty. If image numbers are too large, they are time stamps,
/// which are paired over all cameras and the IMU (ImageNumbers); `found`, where given, gets them.
Dataset readRig(const std::vector<CameraFiles>& cameras, const std::string& imu_file,
                ImageNumbers* found = nullptr);

/// The same of others' files, with what is known of their board; the error [slom.calibration.unused-board] if no file needs it.
Dataset readRig(const std::vector<CameraFiles>& cameras, const std::string& imu_file,
                const BoardOfFiles& board, ImageNumbers* found = nullptr);

/// A calibration target as Kalibr's YAML states it.
struct KalibrTarget {
  enum class Kind { checkerboard, circlegrid, aprilgrid };
  Kind kind = Kind::checkerboard;
  int columns = 0, rows = 0;                       ///< inner corners, circles or tags
  double column_spacing_m = 0, row_spacing_m = 0;  ///< between corners or circles
  bool is_asymmetric = false;                      ///< circles of odd rows are set off by half a spacing
  double tag_m = 0, spacing = 0;                   ///< aprilgrid: side of a tag, and gap over side
};

/// Reads Kalibr's `target_type: checkerboard`, `circlegrid` or `aprilgrid`. Throws as readCorners does.
KalibrTarget readKalibrTarget(const std::string& file);

/// The text of a file that readCorners reads; numbers with all digits, so that reading it again gives the same data. Standard deviations
/// (Corner::sigma) have no column and are left out.
std::string toCornerFile(const CameraData& camera);

}  // namespace slom::calibration
