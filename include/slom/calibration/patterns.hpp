/// Patterns: common properties of residuals that independent noise would not have. They explain why a calibration is
/// less certain than noise alone would make it.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "slom/calibration/board_shape.hpp"
#include "slom/calibration/types.hpp"

namespace slom::calibration {

struct Result;

/// A test of one possible pattern in the residuals of one camera.
struct ResidualPattern {
  enum class Kind {
    neighbours,  ///< correlated residuals of neighbouring corners in an image; `value`: their correlation
    /// Displaced corners of the board; `value`: RMS off the plane [m], `second`: RMS of each coordinate within the
    /// plane [m].
    board_shape,
    image_place,  ///< residuals by place in the image; `value`: RMS of the mean residual, of u and of v [px]
    drift,  ///< a changing lens; `value`: change of `parameter` from the first to the last image, in its unit
    /// Rows read out one after another; `value`: time from the first to the last row, in intervals between successive
    /// image numbers.
    row_readout,
    time_offset,  ///< a delay of the camera relative to the first one; `value`: the delay, in these intervals
    /// `value`: RMS of residuals along the motion / RMS across it, in the half of the images with the faster motion.
    motion_blur,
    /// `value`: RMS of the residuals in the quarter of images with the fastest motion / RMS in the quarter with the
    /// slowest.
    speed,
    slant,     ///< the same ratio for the most slanted and the most frontal boards
    distance,  ///< the same ratio for the farthest and the nearest boards
  };
  Kind kind{};
  std::size_t camera = 0;
  double value = 0, second = std::numeric_limits<double>::quiet_NaN();
  std::vector<MovedCorner> corners{};  ///< for board_shape: all corners
  std::string parameter{};             ///< for drift: the parameter that changes most clearly
  /// Fraction of the squared residuals that the pattern explains, minus what noise explains by chance; may be negative.
  /// NaN for kinds that compare sizes of residuals.
  double share = std::numeric_limits<double>::quiet_NaN();
  /// p-value: probability that images without the pattern show as much of it by chance. It comes from all sign flips of
  /// `blocks` blocks of successive images, and is at least 2^(1 - blocks).
  double probability = 1;
  int blocks = 0;

  /// Returns whether the pattern is significant and large enough to matter.
  bool isFound() const;
};

/// Returns text such as `board_shape`.
const char* toString(ResidualPattern::Kind kind);

/// Returns whether another pattern that was found explains this one. For example, if cameras are not simultaneous,
/// their rows seem to be read out one after another.
bool isExplained(const ResidualPattern& pattern, const Result& result);

/// Returns a sentence with the meaning of the pattern for the images, and the remedy. Throws
/// [slom.calibration.bad-question] if the result has no such camera.
std::string sentenceOf(const ResidualPattern& pattern, const Result& result);

}  // namespace slom::calibration
