// What speaks against the values of a fit of IMUs in motion.
#pragma once

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <string>
#include <utility>

#include "slom/calibration/imu_stream.hpp"

namespace slom::calibration {

/// Adds a clause to the doubts, and the sentence `Clause: remedy` to the notes, behind those on earlier doubts.
inline void addDoubt(const std::string& clause, const std::string& remedy, StreamResult& result) {
  std::string note = clause + ": " + remedy;
  note[0] = char(std::toupper(static_cast<unsigned char>(note[0])));
  const auto behind = std::ptrdiff_t(std::min(result.doubts.size(), result.notes.size()));
  result.notes.insert(result.notes.begin() + behind, std::move(note));
  result.doubts.push_back(clause);
}

}  // namespace slom::calibration
