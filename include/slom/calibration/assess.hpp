/// Assessment: how far a calibration can be trusted, in figures and in one sentence.
#pragma once

#include <string>
#include <vector>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/quality.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Returns residuals, projection uncertainty over the image, cross-validation by halves, correlations, and the further
/// images that would help most; for Result::quality. `result` must be calibrate(data, settings). Throws DataError
/// [slom.calibration.no-result] if its cameras, images, IMU, model or sigma_px differ. After a failed fit, only
/// residuals. Takes about as long as the calibration.
Quality assess(const Dataset& data, const Settings& settings, const Result& result);

/// The calibration in one sentence, and reasons to doubt it.
struct Verdict {
  enum class Level { trustworthy, doubtful, failed };
  Level level = Level::failed;
  std::string sentence;
  std::vector<std::string> doubts;  ///< a clause each, the most serious first
};
/// Returns `trustworthy`, `doubtful` or `failed`.
const char* toString(Verdict::Level level);

/// Returns the verdict on a result. If the calibration succeeded, `result.quality` must be present. Throws DataError
/// [slom.calibration.no-quality] if it is missing or belongs to another result.
Verdict verdictOf(const Result& result);

/// A problem that the readings of the IMU show.
struct ImuFinding {
  enum class Kind {
    sign,        ///< the readings leave up or down open
    handedness,  ///< readings point down although up is expected, as with left-handed axes
    gravity,     ///< gravity differs from the Earth's
    misfit,      ///< the readings do not agree with the images
    weak,        ///< bias and gravity are hard to separate
  };
  Kind kind{};
  std::string fault, remedy;  ///< a clause each: what is wrong or open; what to do
  /// True if the readings cannot be right. The IMU's part of the result must then not be used.
  bool is_unusable = false;
  bool is_doubt = true;  ///< true if the verdict counts it
};
/// Returns what is wrong or open in the IMU's part of a result; nothing without an IMU.
std::vector<ImuFinding> imuFindings(const Result& result);

/// Returns the RMS over the corners of all cameras [px].
double rmsOfAll(const Result& result);

/// Returns a sentence on a view of `result.quality->further_views`: `a board tilted by 40 degrees, its left edge
/// farther away, in the upper left of the image of left, at 0.60 m: from 1.1 to 0.70 px`
std::string sentenceOf(const FurtherView& view, const Result& result);

}  // namespace slom::calibration
