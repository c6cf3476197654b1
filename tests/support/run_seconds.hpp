#pragma once
// The times in the JSON of a fit.

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace slom::testing {

/// All phases took some time, and together not more than the whole.
inline void expectPlausibleSeconds(const nlohmann::json& seconds) {
  double sum = 0;
  for (const char* phase : {"load", "setup", "linearize", "factorize", "solve"}) {
    EXPECT_GT(seconds[phase], 0) << phase;
    sum += seconds[phase].get<double>();
  }
  EXPECT_LE(sum, seconds["total"].get<double>());
}

}  // namespace slom::testing
