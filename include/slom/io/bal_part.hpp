/// Numbers of a part of a bundle adjustment, from lines of a BAL file or from a container, for files of which each
/// process reads a part.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "slom/io/container.hpp"
#include "slom/io/numbered_lines.hpp"
#include "slom/io/scene.hpp"

namespace slom::io {

/// The first line of a BAL file.
struct BalCounts {
  int cameras = 0, points = 0;
  std::int64_t observations = 0;
};

/// An observation with its number in the file, from 0.
struct BalObservation {
  std::int64_t number = 0;
  int camera = 0, point = 0;
  int line = 0;         ///< of the file; in a container, of the text file that it stands for
  double u = 0, v = 0;  ///< [px]
};

/// A number of a camera or a point.
struct BalNumber {
  int item = 0;  ///< number of the camera or point in the file
  int part = 0;  ///< from 0: rotation vector, translation, f, k1, k2; or x, y, z
  double value = 0;
};

/// Numbers of a camera, and numbers of a point.
inline constexpr int bal_camera_size = 9, bal_point_size = 3;

/// Returns the camera with these numbers.
Camera cameraFromBal(std::span<const double, bal_camera_size> numbers);

/// A part of the numbers.
struct BalPart {
  std::vector<BalObservation> observations;
  std::vector<BalNumber> cameras, points;
};

/// Returns the number of words of some lines.
std::int64_t countBalWords(const NumberedLines& lines);

/// Reads the counts from the first of these lines. Throws [slom.io.bad-line].
BalCounts readBalCounts(const std::string& file, const NumberedLines& lines);

/// Where some lines of a file are in it.
struct BalPlace {
  std::int64_t first_word = 0;  ///< number of words before these lines
  std::int64_t word_count = 0;  ///< of the whole file
  BalCounts counts;
};

/// Adds the numbers of some lines. Throws [slom.io.bad-line] with the file and the line.
void parseBal(const std::string& file, const NumberedLines& lines, const BalPlace& place, BalPart& part);

/// Throws [slom.io.empty-file]: the file has no words.
[[noreturn]] void refuseEmptyBal(const std::string& file);

/// Returns the counts of a container. Throws [slom.io.other-container], and [slom.io.damaged] for impossible counts.
BalCounts readBalCounts(const Container& container);

/// Returns the numbers of part `part` of `parts` of a container. Throws [slom.io.bad-scene] for a number that the text
/// file could not have.
BalPart readBalPart(const Container& container, int part, int parts);

}  // namespace slom::io
