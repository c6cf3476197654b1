/// How far a calibration can be trusted: figures, and what they amount to in a sentence.
#pragma once

#include <string>
#include <vector>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/quality.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Residuals, projection uncertainty over the image, cross-validation by halves, correlations, and which further images would
/// help most; for Result::quality. `result` is calibrate(data, settings); DataError [slom.calibration.no-result] where its cameras, images,
/// IMU, model or sigma_px are others. After a fit that failed: residuals alone. Takes about as long as the calibration.
Quality assess(const Dataset& data, const Settings& settings, const Result& result);

/// The calibration in one sentence, and what speaks against trusting it.
struct Verdict {
  enum class Level { trustworthy, doubtful, failed };
  Level level = Level::failed;
  std::string sentence;
  std::vector<std::string> doubts;  ///< a clause each, the gravest first
};
/// `trustworthy`, `doubtful` or `failed`.
const char* toString(Verdict::Level level);

/// The verdict on a result. If the calibration succeeded, `result.quality` must be present: DataError [slom.calibration.no-quality] if it
/// is missing or belongs to another result.
Verdict verdictOf(const Result& result);

/// Something that the readings of the IMU show of themselves.
struct ImuFinding {
  enum class Kind {
    sign,        ///< up or down is open
    handedness,  ///< readings point down where up is to be expected, as of left-handed axes
    gravity,     ///< it is not that of the Earth
    misfit,      ///< the readings do not follow the images
    weak,        ///< bias and gravity trade off
  };
  Kind kind{};
  std::string fault, remedy;  ///< a clause each: what is wrong or open; what to do
  bool is_unusable =
      false;  ///< the readings cannot be right, so that the IMU's part of the result must not be used
  bool is_doubt = true;  ///< whether the verdict counts it
};
/// What is wrong with the IMU's part of a result, or open; nothing without an IMU.
std::vector<ImuFinding> imuFindings(const Result& result);

/// The RMS over the corners of all cameras [px].
double rmsOfAll(const Result& result);

/// A view of `result.quality->further_views`:
/// `a board tilted by 40 degrees, its left edge farther away, in the upper left of the image of left, at 0.60
/// m: from 1.1 to 0.70 px`
std::string sentenceOf(const FurtherView& view, const Result& result);

}  // namespace slom::calibration
