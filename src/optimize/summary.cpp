#include "slom/optimize/summary.hpp"

#include <algorithm>
#include <limits>

namespace slom {

const char* toString(StopReason reason) {
  switch (reason) {
    case StopReason::gradient:
      return "gradient below tolerance";
    case StopReason::decrease:
      return "relative decrease below tolerance";
    case StopReason::step:
      return "step below tolerance";
    case StopReason::nothing_to_do:
      return "nothing to optimize";
    case StopReason::max_iterations:
      return "iteration limit reached";
    case StopReason::no_progress:
      return "no step makes the RSS smaller";
    case StopReason::rank_deficient:
      return "rank deficient";
    case StopReason::not_finite:
      return "a residual or a derivative became not finite";
    case StopReason::time_limit:
      return "time limit reached";
    case StopReason::interrupted:
      return "interrupted";
  }
  return "unknown";
}

bool isConverged(StopReason reason) { return reason <= StopReason::nothing_to_do; }

Summary::Summary() = default;
Summary::~Summary() = default;
Summary::Summary(const Summary&) = default;
Summary::Summary(Summary&&) noexcept = default;
Summary& Summary::operator=(const Summary&) = default;
Summary& Summary::operator=(Summary&&) noexcept = default;

double Summary::chi2PerDof() const {
  return redundancy > 0 ? final_rss / redundancy : std::numeric_limits<double>::quiet_NaN();
}

bool Summary::hasLosses() const {
  return std::any_of(groups.begin(), groups.end(),
                     [](const GroupSummary& group) { return !group.losses.empty(); });
}

}  // namespace slom
