// The calibration in one sentence, and what speaks against trusting it.
#pragma once

#include <string>
#include <vector>

#include "slom/calibration/result.hpp"

namespace slom::calibration {

struct Verdict {
  enum class Level { trustworthy, doubtful, failed };
  Level level = Level::failed;
  std::string sentence;
  std::vector<std::string> doubts;  ///< a clause each, the gravest first
};
const char* toString(Verdict::Level level);

/// `result.quality` must be there.
Verdict verdictOf(const Result& result);

/// Of all cameras [px].
double rmsOfAll(const Result& result);

/// `a board tilted by 40 degrees, its left edge farther away, in the upper left of the image of left, at 0.60
/// m: from 1.1 to 0.70 px`
std::string sentenceOf(const FurtherView& view, const Result& result);

}  // namespace slom::calibration
