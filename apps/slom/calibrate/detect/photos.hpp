// The photographs of the cameras: patterns expanded, and matched by the number in the name.
#pragma once

#include <string>
#include <vector>

#include "calibrate/settings.hpp"

namespace slom::app::calib {

struct Photo {
  int image = 0;  ///< photographs taken at the same time have the same number
  std::string file;
};

struct CameraPhotos {
  std::string name;
  std::vector<Photo> photos;              ///< sorted by number
  std::vector<std::string> unnumbered{};  ///< files without a number in their name; left out
};

/// Returns the last number in a file's name, without folders and extension: 7 for `run2/left07.jpg`. The number is
/// text without leading zeros, because time stamps may have any length. Empty if there is none.
std::string numberInName(const std::string& file);

/// Returns the photographs of each camera. If a number is too large for an image number, as time stamps are, images
/// are counted from 1 by ascending number over all cameras. They are paired by the nearest stamps (ImageNumbers);
/// `found`, if given, receives these numbers. Throws UserError for a pattern that matches nothing, a camera without a
/// number in any name, a number that a camera has twice, and a photograph of two cameras.
std::vector<CameraPhotos> findPhotos(const std::vector<CameraFile>& cameras, ImageNumbers* found = nullptr);

}  // namespace slom::app::calib
