// Report on an online run.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "graph/online/online.hpp"
#include "text.hpp"

namespace slom::app::graph {

namespace {

using Json = nlohmann::ordered_json;

/// Times of the updates [s].
struct Times {
  explicit Times(const OnlineRun& run) {
    for (const Update& update : run.updates) sorted.push_back(update.seconds);
    std::sort(sorted.begin(), sorted.end());
    for (const double seconds : sorted) total += seconds;
  }
  /// Returns the time that the fraction `part` of all do not exceed.
  double quantile(double part) const {
    if (sorted.empty()) return 0;
    const std::size_t i = std::size_t(std::ceil(part * double(sorted.size())));
    return sorted[std::clamp<std::size_t>(i, 1, sorted.size()) - 1];
  }

  std::vector<double> sorted;
  double total = 0;
};

Json numberOrNull(double x) { return std::isfinite(x) ? Json(x) : Json(); }

Json traceJson(const OnlineRun& run) {
  Json trace = Json::array();
  for (const Update& update : run.updates) {
    const UpdateSummary& s = update.summary;
    trace.push_back({{"pose", update.pose},
                     {"seconds", update.seconds},
                     {"converged", s.converged},
                     {"rss", s.rss},
                     {"promise", numberOrNull(s.promise)},
                     {"steps", s.steps},
                     {"variables_moved", s.variables_moved},
                     {"measurements_linearized", s.measurements_linearized},
                     {"fronts_factorized", s.fronts_factorized},
                     {"flops", s.flops},
                     {"reordered", s.reordered},
                     {"used_optimize", s.used_optimize},
                     {"undetermined", s.undetermined.size()},
                     {"gap", numberOrNull(update.gap)}});
  }
  return trace;
}

}  // namespace

std::string onlineText(const OnlineRun& run) {
  const Times times(run);
  const auto worst = std::max_element(run.updates.begin(), run.updates.end(),
                                      [](const Update& a, const Update& b) { return a.seconds < b.seconds; });
  if (worst == run.updates.end()) return "\n0 updates\n";
  std::string text =
      fmt::format("\n{} in {:.3g} s: median {:.3g} ms, 99 % within {:.3g} ms, worst {:.3g} ms, at pose {}\n",
                  plural(run.updates.size(), "update"), times.total, 1000 * times.quantile(0.5),
                  1000 * times.quantile(0.99), 1000 * worst->seconds, worst->pose);
  const auto compared = std::count_if(run.updates.begin(), run.updates.end(),
                                      [](const Update& update) { return !std::isnan(update.gap); });
  if (run.updates.size() < run.poses)
    text += fmt::format("  ended after {} of {} poses\n", run.updates.size(), run.poses);
  text += fmt::format("  RSS {:.8g}, ", run.final_rss);
  text += std::isnan(run.batch_rss) ? "not compared: the batch fit did not converge"
                                    : fmt::format("of the batch fit {:.8g}", run.batch_rss);
  if (compared > 0) {
    text += fmt::format("; largest gap RSS / batch RSS - 1: {:.1e}, {} compared", run.largestGap(),
                        plural(std::size_t(compared), "update"));
  }
  return text + "\n";
}

Json onlineJson(const OnlineRun& run) {
  const Times times(run);
  return {{"updates", run.updates.size()},
          {"seconds",
           {{"total", times.total},
            {"median", times.quantile(0.5)},
            {"p99", times.quantile(0.99)},
            {"worst", times.quantile(1)}}},
          {"largest_gap", numberOrNull(run.largestGap())},
          {"final_rss", run.final_rss},
          {"batch_rss", numberOrNull(run.batch_rss)},
          {"trace", traceJson(run)}};
}

}  // namespace slom::app::graph
