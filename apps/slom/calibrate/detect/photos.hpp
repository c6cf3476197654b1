// The photographs of the cameras: patterns expanded, and matched by the number in the name.
#pragma once

#include <string>
#include <vector>

#include "calibrate/settings.hpp"

namespace slom::app::calib {

struct Photo {
  int image = 0;  ///< what was taken at the same time has the same number
  std::string file;
};

struct CameraPhotos {
  std::string name;
  std::vector<Photo> photos;              ///< sorted by number
  std::vector<std::string> unnumbered{};  ///< files without a number in their name, which are left out
};

/// The last number in a file's name, folders and extension left aside: 7 of `run2/left07.jpg`. It is text,
/// without leading zeros, because time stamps may have any length. Empty: there is none.
std::string numberInName(const std::string& file);

/// The photographs of each camera. Where a number is too large for an image number, as time stamps are,
/// images are counted from 1 by rising number over all cameras, and paired by the nearest (ImageNumbers); `found`, where given, gets them. UserError for a pattern that matches nothing,
/// a camera without a number in any name, a number that a camera has twice, and a photograph that two cameras have.
std::vector<CameraPhotos> findPhotos(const std::vector<CameraFile>& cameras, ImageNumbers* found = nullptr);

}  // namespace slom::app::calib
