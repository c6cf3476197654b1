// The brightness of a photograph.
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

/// Reads JPEG, PNG, BMP, PGM and some other formats. Keeps pixels as the sensor gave them, whatever orientation the
/// file suggests to viewers. Scales images of 16 bits so that the brightest pixel is white. Returns nothing for a
/// file that is none of these, broken, or larger than 300 million pixels; `reason` then says what is wrong. Checks
/// the size before allocating memory.
std::optional<Photograph> readPhotograph(const std::string& file, std::string& reason);

}  // namespace slom::app::calib
