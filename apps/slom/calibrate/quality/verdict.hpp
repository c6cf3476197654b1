// The calibration in one sentence, and what speaks against trusting it.
#pragma once

#include <string>
#include <vector>

#include "calibrate/result.hpp"

namespace slom::app::calib {

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

}  // namespace slom::app::calib
