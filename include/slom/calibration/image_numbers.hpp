/// ImageNumbers: image numbers from files. Entries with the same number were taken at the same time. Numbers too large
/// for an image number are time stamps. Images of different cameras are then paired with the nearest stamps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom::calibration {

/// The numbers of several sources: cameras, an IMU.
class ImageNumbers {
 public:
  ImageNumbers() = default;
  /// Reads the whole numbers (only digits) of each source. If all are at most 2147483647, they are the image numbers.
  /// Otherwise they are time stamps, and images are counted from 1 in their order. Stamps of two sources are one image
  /// if each is the nearest to the other, and if they differ by at most half the spacing of the stamps. The spacing is
  /// the median within a source, and the smaller of the two.
  explicit ImageNumbers(const std::vector<std::vector<std::string>>& by_source);

  /// Returns whether the numbers are time stamps.
  bool areStamps() const { return are_stamps_; }
  /// Returns the image number. `number` must be one of the numbers given for the source.
  int of(std::size_t source, const std::string& number) const;
  /// Returns the largest difference within an image, in the unit of the stamps; 0 if all are equal.
  double largestDifference() const { return largest_difference_; }
  /// Returns the number of images with stamps that differ.
  std::size_t paired() const { return paired_; }
  /// Returns the median spacing of the stamps within a source, the smallest of all sources; 0 if no source has two
  /// stamps.
  double spacing() const { return spacing_; }

 private:
  bool are_stamps_ = false;
  std::vector<std::map<std::string, int>> images_;
  double largest_difference_ = 0, spacing_ = 0;
  std::size_t paired_ = 0;
};

/// Returns the time since 1970 [ns] that the digits state: 19 digits are nanoseconds, 16 digits microseconds.
/// Otherwise returns nothing.
std::optional<std::int64_t> timeInDigits(const std::string& digits);

/// Returns a sentence such as `image numbers are time stamps, and those of one moment differ by up to 1500 (3 % of
/// their spacing)`; empty if nothing was paired.
std::string sentenceOf(const ImageNumbers& numbers);

}  // namespace slom::calibration
