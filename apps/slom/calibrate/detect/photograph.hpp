// A photograph's brightness.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/library.hpp"

namespace slom::app::calib {

struct Photograph {
  ImageSize size;
  std::vector<std::uint8_t> grey;  ///< row by row, from the top left
};

/// JPEG, PNG, BMP, PGM and some more; pixels as the sensor gave them, whatever orientation the file suggests
/// to viewers. Images of 16 bits are scaled so that the brightest pixel is white. Nothing for a file that is
/// none of these, broken, or larger than 300 million pixels; `reason` then says what is wrong with it. The
/// size is looked at before memory is taken.
std::optional<Photograph> readPhotograph(const std::string& file, std::string& reason);

}  // namespace slom::app::calib
