#pragma once
// The JSON that all commands write which fit a problem from a file.

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace slom::testing {

/// Expects that all phases took some time, and in total not more than the whole.
inline void expectPlausibleSeconds(const nlohmann::json& seconds) {
  double sum = 0;
  for (const char* phase : {"load", "setup", "linearize", "factorize", "solve"}) {
    EXPECT_GT(seconds[phase], 0) << phase;
    sum += seconds[phase].get<double>();
  }
  EXPECT_LE(sum, seconds["total"].get<double>());
}

/// The keys of docs/graph/json.md, plausible times, and a trace from the first RSS to the last.
inline void expectRunJson(const nlohmann::json& json) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  EXPECT_EQ(keys, (std::vector<std::string>{"active_bounds",
                                            "chi2_per_dof",
                                            "converged",
                                            "correlations",
                                            "final_rss",
                                            "free_directions",
                                            "free_directions_are_all",
                                            "groups",
                                            "initial_rss",
                                            "iterations",
                                            "kernels",
                                            "measurements",
                                            "message",
                                            "parameters",
                                            "peak_memory_mb",
                                            "redundancy",
                                            "seconds",
                                            "sigma",
                                            "solver",
                                            "stop_reason",
                                            "threads",
                                            "trace",
                                            "unknowns",
                                            "variables",
                                            "warnings"}));
  double rss = 0;
  for (const auto& group : json["groups"]) rss += group["final_rss"].get<double>();
  EXPECT_NEAR(rss, json["final_rss"].get<double>(), 1e-9 * rss);
  expectPlausibleSeconds(json["seconds"]);
  const nlohmann::json& trace = json["trace"];
  ASSERT_EQ(trace.size(), json["iterations"].get<std::size_t>() + 1);
  EXPECT_EQ(trace.front()["rss"], json["initial_rss"]);
  EXPECT_EQ(trace.back()["rss"], json["final_rss"]);
}

}  // namespace slom::testing
