/// Image numbers as files write them: what has the same number was taken at the same time. Numbers too large for an image number are time
/// stamps, and images of different cameras are paired where their stamps are nearest.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom::calibration {

/// The numbers of several sources: cameras, an IMU.
class ImageNumbers {
 public:
  ImageNumbers() = default;
  /// By source: whole numbers, digits alone. If all are at most 2147483647, they are the image numbers. Otherwise they are time stamps: images are counted from 1
  /// in their order, and stamps of different sources are one image where each is the nearest to the other and they differ by at most half of the
  /// spacing of the stamps within a source, the median one, the smaller of both.
  explicit ImageNumbers(const std::vector<std::vector<std::string>>& by_source);

  /// Whether the numbers are time stamps.
  bool areStamps() const { return are_stamps_; }
  /// The image number; `number` is one that the source was said to have.
  int of(std::size_t source, const std::string& number) const;
  /// The largest difference within an image, in the unit of the stamps; 0 where all are equal.
  double largestDifference() const { return largest_difference_; }
  /// How many images have stamps that differ.
  std::size_t paired() const { return paired_; }
  /// The median spacing of the stamps within a source, the smallest of all sources; 0 where no source has two.
  double spacing() const { return spacing_; }

 private:
  bool are_stamps_ = false;
  std::vector<std::map<std::string, int>> images_;
  double largest_difference_ = 0, spacing_ = 0;
  std::size_t paired_ = 0;
};

/// `image numbers are time stamps, and those of one moment differ by up to 1500 (3 % of their spacing)`; empty where nothing was paired.
std::string sentenceOf(const ImageNumbers& numbers);

}  // namespace slom::calibration
