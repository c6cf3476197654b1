#include "slom/analyze/losses.hpp"

#include <algorithm>
#include <map>
#include <span>
#include <tuple>

namespace slom {

namespace {

/// Returns the place of one of the library's losses in their table. Users' own losses come after them.
std::ptrdiff_t placeInTable(const Loss& loss) {
  const std::span<const LossKind* const> all = losses();
  return std::find(all.begin(), all.end(), loss.kind()) - all.begin();
}

}  // namespace

std::vector<LossSummary> summarizeLosses(MeasurementPool& pool) {
  if (pool.lossCount() == 0) return {};
  std::map<Loss, LossSummary> summary_of;
  std::vector<double> r;
  for (int i = 0; i < pool.size(); ++i) {
    const Loss* loss = pool.lossOf(i);
    if (loss == nullptr) continue;
    r.resize(static_cast<std::size_t>(pool.rows(i)));
    pool.evaluate(i, i + 1, r.data());
    const double s = Eigen::Map<const Eigen::VectorXd>(r.data(), pool.rows(i)).squaredNorm();
    const double weight = loss->evaluate(s).first;
    LossSummary& summary = summary_of[*loss];
    ++summary.measurements;
    if (weight < 0.5) ++summary.down_weighted;
    if (weight == 0) ++summary.weightless;
  }
  std::vector<const Loss*> order;
  for (auto& [loss, summary] : summary_of) {
    summary.loss = loss.text();
    order.push_back(&loss);
  }
  std::sort(order.begin(), order.end(), [&](const Loss* a, const Loss* b) {
    return std::tuple(placeInTable(*a), a->scale(), a->shape(), summary_of[*a].loss) <
           std::tuple(placeInTable(*b), b->scale(), b->shape(), summary_of[*b].loss);
  });
  std::vector<LossSummary> result;
  for (const Loss* loss : order) result.push_back(summary_of[*loss]);
  return result;
}

void addLosses(const std::vector<LossSummary>& more, std::vector<LossSummary>& sum) {
  for (const LossSummary& entry : more) {
    const auto same = std::find_if(sum.begin(), sum.end(),
                                   [&](const LossSummary& known) { return known.loss == entry.loss; });
    if (same == sum.end()) {
      sum.push_back(entry);
      continue;
    }
    same->measurements += entry.measurements;
    same->down_weighted += entry.down_weighted;
    same->weightless += entry.weightless;
  }
}

std::vector<std::string> weightlessMeasurements(const std::vector<GroupSummary>& groups) {
  std::vector<std::string> result;
  for (const GroupSummary& group : groups) {
    for (const LossSummary& summary : group.losses) {
      if (summary.weightless == 0) continue;
      result.push_back(
          "the loss " + summary.loss + " gives weight 0 to " + std::to_string(summary.weightless) + " of " +
          std::to_string(summary.measurements) + " measurements " + group.name +
          ", which then determine nothing; start nearer to the solution, pass a larger scale, or set "
          "Options::graduated_non_convexity");
    }
  }
  return result;
}

}  // namespace slom
