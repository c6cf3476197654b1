#include "online/output.hpp"

#include <algorithm>
#include <cstdio>
#include <ostream>

#include <nlohmann/json.hpp>

namespace slom::bench {

namespace {

using Json = nlohmann::json;

Json checkJson(const Check& check) {
  Json json{{"pose", check.pose}, {"gap", check.gap}, {"position_error", check.position_error}};
  if (check.marginals > 0) json["marginals"] = check.marginals;
  return json;
}

Json replayJson(const Replay& replay) {
  Json json{{"method", replay.method},
            {"fits", replay.seconds.size()},
            {"total", replay.total()},
            {"median", replay.quantile(0.5)},
            {"p99", replay.quantile(0.99)},
            {"worst", replay.quantile(1)},
            {"worst_at_closures", replay.at_closures},
            {"rss", replay.rss},
            {"largest_gap", replay.largestGap()},
            {"largest_position_error", replay.largestPositionError()},
            {"by_optimize", replay.by_optimize},
            {"checks", Json::array()}};
  for (const Check& check : replay.checks) json["checks"].push_back(checkJson(check));
  if (replay.covariance_seconds.empty()) return json;
  const Replay covariances{.method = {}, .seconds = replay.covariance_seconds};
  json["covariance"] = {{"median", covariances.quantile(0.5)}, {"worst", covariances.quantile(1)}};
  const Replay marginals{.method = {}, .seconds = replay.marginals_seconds};
  json["marginals"] = {{"median", marginals.quantile(0.5)}, {"worst", marginals.quantile(1)}};
  json["read_newest"] = replay.read_newest;
  json["read_all"] = replay.read_all;
  return json;
}

}  // namespace

void printHead() {
  std::puts(
      "| file | fit | total [s] | median [ms] | 99 % | worst | at closures | RSS | largest gap | off by [m] | "
      "by optimize() |\n|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|");
}

void print(const FileResult& result) {
  for (const Replay& replay : result.replays) {
    std::printf("| %s | %s | %.3f | %.3f | %.2f | %.2f | %.2f | %.8g | %.1e | %.1e | %d |\n",
                result.file.c_str(), replay.method.c_str(), replay.total(), 1e3 * replay.quantile(0.5),
                1e3 * replay.quantile(0.99), 1e3 * replay.quantile(1), 1e3 * replay.at_closures, replay.rss,
                replay.largestGap(), replay.largestPositionError(), replay.by_optimize);
  }
  std::fflush(stdout);
}

void writeJson(const std::vector<FileResult>& results, std::ostream& os) {
  Json all = Json::array();
  for (const FileResult& result : results) {
    Json json{{"file", result.file}, {"poses", result.poses}, {"edges", result.edges}};
    for (const Replay& replay : result.replays) json["replays"].push_back(replayJson(replay));
    if (result.memory.after_one > 0) {
      json["memory"] = {{"replays", result.memory.replays},
                        {"after_one", result.memory.after_one},
                        {"after_all", result.memory.after_all}};
    }
    all.push_back(std::move(json));
  }
  os << Json{{"files", all}} << "\n";
}

}  // namespace slom::bench
