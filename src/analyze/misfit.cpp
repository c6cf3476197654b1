#include "analyze/misfit.hpp"

#include <algorithm>
#include <cmath>

#include "base/words.hpp"
#include "problem/stated_noise.hpp"

namespace slom {

namespace {
constexpr double kFar = 10;                // ratio to the expected value
constexpr double kMisfitOfNoNoise = 1e-9;  // ratio to the expected value, for simulations without noise
constexpr double kLeastRedundancy = 5, kFarOfFew = 100;
constexpr int kLeastMeasurements = 5;
constexpr double kNearlyAll = 0.9;

/// Returns whether chi-square is far from its degrees of freedom, which are between `least` and `most`.
bool isFar(double chi2, double least, double most) {
  if (!(most > 0)) return false;
  if (chi2 > most * (most < kLeastRedundancy ? kFarOfFew : kFar)) return true;
  return least >= kLeastRedundancy && chi2 < least / kFar && chi2 > least * kMisfitOfNoNoise;
}

std::string sentence(const std::string& what, double ratio) {
  return what + number(ratio, 3) + ", where about 1 is expected from the stated standard deviations: " +
         (ratio > 1 ? "the model or its derivatives do not fit the data, some data are wrong, or the "
                      "standard deviations are " +
                          number(std::sqrt(ratio), 2) + " times too small"
                    : "the standard deviations are " + number(1 / std::sqrt(ratio), 2) + " times too large") +
         "; slom::outliers(est) names the worst data, Sigma::estimated takes the scale from the residuals";
}

/// Returns `the loss Huber(1.345) gives`, or `losses such as Huber(1.345) give` if there are several.
std::string nameOf(const std::vector<LossSummary>& losses) {
  return losses.size() == 1 ? "the loss " + losses.front().loss + " gives"
                            : "losses such as " + losses.front().loss + " give";
}

void addDownWeighted(const GroupSummary& group, std::vector<std::string>& result) {
  int measurements = 0, down_weighted = 0;
  for (const LossSummary& loss : group.losses) {
    measurements += loss.measurements;
    down_weighted += loss.down_weighted;
  }
  if (measurements < kLeastMeasurements || down_weighted < kNearlyAll * measurements) return;
  result.push_back(nameOf(group.losses) + " weights below 1/2 to " + std::to_string(down_weighted) + " of " +
                   std::to_string(measurements) + " measurements " + group.name +
                   ", so hardly any of them counts, although outliers should be few; start nearer to the "
                   "solution, pass a larger scale, or set Options::graduated_non_convexity");
}
}  // namespace

std::vector<std::string> misfits(const Problem& problem, const Summary& summary) {
  std::vector<std::string> result;
  for (const GroupSummary& group : summary.groups) addDownWeighted(group, result);
  if (summary.sigma_is_estimated || !summary.converged) return result;
  if (statesAllNoise(problem) && !summary.hasLosses() &&
      isFar(summary.final_rss, summary.redundancy, summary.redundancy)) {
    result.push_back(sentence("chi-square / dof is ", summary.chi2PerDof()));
    return result;
  }
  for (std::size_t g = 0; g < summary.groups.size(); ++g) {
    const GroupSummary& group = summary.groups[g];
    if (!group.losses.empty() || !groupStatesNoise(problem, g)) continue;
    // If the redundancy of the group was not computed, its bounds are used.
    const bool is_known = group.redundancy >= 0;
    const double least =
        is_known ? group.redundancy : group.residuals - summary.unknowns + summary.free_directions;
    const double most = is_known ? group.redundancy : std::min(group.residuals, summary.redundancy);
    if (isFar(group.final_rss, least, most)) {
      const double dof = group.final_rss > most ? most : least;
      result.push_back(
          sentence("chi-square / dof of measurements " + group.name + " is ", group.final_rss / dof));
    }
  }
  return result;
}

}  // namespace slom
