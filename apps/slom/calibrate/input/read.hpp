// Files to data: corner files and the IMU file.
#pragma once

#include <string>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// Reads `image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px`, and the comments `# image_size_px: 640 x 480` and
/// `# photo 7: left07.jpg` (of image 7) where there are such. A corner that is listed twice in an image is
/// an error.
CameraData readCorners(const std::string& camera_name, const std::string& file);

/// Reads `image,ax_m_s2,ay_m_s2,az_m_s2,valid`. Rows with valid = 0 are skipped: neither their reading nor
/// their image is looked at. An image with two valid rows is an error.
ImuData readImu(const std::string& file);

}  // namespace slom::app::calib
