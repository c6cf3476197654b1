#include "analyze/misfit.hpp"

#include <algorithm>
#include <cmath>

#include "model/words.hpp"

namespace slom {

namespace {
constexpr double kFar = 10;        // times what is expected
constexpr double kNoNoise = 1e-9;  // times it: data that were simulated without noise
constexpr double kLeastRedundancy = 5;
constexpr int kLeastMeasurements = 10;
constexpr double kNearlyAll = 0.9;

bool isFar(double ratio) { return ratio > kFar || (ratio < 1 / kFar && ratio > kNoNoise); }

std::string sentence(const std::string& what, double ratio) {
  return what + number(ratio, 3) + ", where the stated standard deviations let expect about 1: " +
         (ratio > 1 ? "the model or its derivatives do not fit the data, some data are wrong, or the "
                      "standard deviations are " +
                          number(std::sqrt(ratio), 2) + " times too small"
                    : "the standard deviations are " + number(1 / std::sqrt(ratio), 2) + " times too large") +
         "; outliers() names the worst data, Sigma::estimated takes the scale from the residuals";
}

/// Whether someone has said how uncertain its measurements are.
bool hasStatedNoise(const MeasurementPool& pool) {
  return pool.size() > 0 && pool.whitening(0).first != WhiteningKind::unit;
}
}  // namespace

std::vector<std::string> misfits(const Problem& problem, const Summary& summary) {
  std::vector<std::string> result;
  for (const GroupSummary& group : summary.groups) {
    for (const LossSummary& loss : group.losses) {
      if (loss.measurements < kLeastMeasurements || loss.down_weighted < kNearlyAll * loss.measurements)
        continue;
      result.push_back("the loss " + loss.loss + " gives weights below 1/2 to " +
                       std::to_string(loss.down_weighted) + " of " + std::to_string(loss.measurements) +
                       " measurements " + group.name +
                       ", so that hardly any of them counts: outliers are few by nature; start nearer to the "
                       "solution, pass a larger "
                       "scale, or set Options::graduated_non_convexity");
    }
  }
  const bool has_stated = std::all_of(problem.pools().begin(), problem.pools().end(),
                                      [](const auto& pool) { return hasStatedNoise(*pool); });
  if (summary.sigma_is_estimated || !summary.converged || summary.hasLosses()) return result;
  if (has_stated && summary.redundancy >= kLeastRedundancy && isFar(summary.chi2PerDof())) {
    result.push_back(sentence("chi-square / dof is ", summary.chi2PerDof()));
    return result;
  }
  for (std::size_t g = 0; g < summary.groups.size() && g < problem.pools().size(); ++g) {
    const GroupSummary& group = summary.groups[g];
    if (group.redundancy < kLeastRedundancy || !hasStatedNoise(*problem.pools()[g])) continue;
    if (isFar(group.final_rss / group.redundancy)) {
      result.push_back(sentence("chi-square / dof of measurements " + group.name + " is ",
                                group.final_rss / group.redundancy));
    }
  }
  return result;
}

}  // namespace slom
