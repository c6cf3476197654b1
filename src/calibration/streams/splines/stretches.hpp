// Stretches of a recording: times in which both images and readings follow each other, so that a spline is determined.
#pragma once

#include <vector>

#include "calibration/streams/problem.hpp"

namespace slom::calibration {

/// Images that follow each other while readings do, in the order of time.
struct Stretch {
  double from = 0, to = 0;          ///< times of the first and last image, in the clock of the cameras [s]
  std::vector<std::size_t> images;  ///< indices, at least 2
};

/// Returns the stretches. A stretch ends where images are missing for more than 2 s, and where no IMU has readings for
/// longer than 2 intervals between knots. Images outside of stretches are in none. `knot_spacing`: [s].
std::vector<Stretch> stretchesOf(const std::vector<RigAtImage>& images, const std::vector<StartedImu>& imus,
                                 double knot_spacing);

}  // namespace slom::calibration
