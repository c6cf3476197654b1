/// What residuals have in common where independent noise would have nothing in common: patterns that say why a calibration is less certain
/// than the noise alone makes it.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "slom/calibration/board_shape.hpp"
#include "slom/calibration/types.hpp"

namespace slom::calibration {

struct Result;

/// One suspicion about one camera, put to the test.
struct ResidualPattern {
  enum class Kind {
    neighbours,   ///< residuals of neighbouring corners within an image; `value`: their correlation
    board_shape,  ///< corners of the board that are elsewhere; `value`: RMS off the plane [m], `second`: RMS of each coordinate within it [m]
    image_place,  ///< residuals by place in the image; `value`: RMS of the mean residual, of u and of v [px]
    drift,  ///< a lens that changes; `value`: change of `parameter` from the first to the last image, in its unit
    row_readout,  ///< rows that are read out one after the other; `value`: time from the first row to the last, in intervals from one image number to the next
    time_offset,  ///< a camera that is late, beside the first one; `value`: by how much, in the same intervals
    motion_blur,  ///< `value`: RMS of residuals along the motion over that across it, where that is faster than in half the images
    speed,  ///< `value`: RMS of the residuals of the quarter of images with the fastest motion over that of the slowest
    slant,     ///< the same of the most slanted boards and the most frontal ones
    distance,  ///< the same of the farthest and the nearest boards
  };
  Kind kind{};
  std::size_t camera = 0;
  double value = 0, second = std::numeric_limits<double>::quiet_NaN();
  std::vector<MovedCorner> corners{};  ///< of board_shape: all
  std::string parameter{};             ///< of drift: the one that changes most clearly
  /// Share of the squared residuals that the pattern explains, without what noise explains by chance; it may be below 0. NaN for kinds that compare
  /// sizes of residuals.
  double share = std::numeric_limits<double>::quiet_NaN();
  /// That images without the pattern show as much of it by chance, from all ways to flip the signs of `blocks` blocks of successive images: at
  /// least 2^(1 - blocks).
  double probability = 1;
  int blocks = 0;

  /// Whether it is there beyond chance, and large enough to matter.
  bool isFound() const;
};

/// `board_shape`
const char* toString(ResidualPattern::Kind kind);

/// Whether another pattern that was found explains this one: where cameras are not simultaneous, rows seem to be read out one after the other.
bool isExplained(const ResidualPattern& pattern, const Result& result);

/// What the pattern says about the images, and the remedy. Throws [slom.calibration.bad-question] where the result has no such camera.
std::string sentenceOf(const ResidualPattern& pattern, const Result& result);

}  // namespace slom::calibration
