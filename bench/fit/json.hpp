/// Results as JSON: times in seconds, memory in bytes, rates in flop/s.
#pragma once

#include <nlohmann/json.hpp>

#include "fit/comparison.hpp"

namespace slom::bench {

using Json = nlohmann::ordered_json;

Json toJson(const Run& run);
Run runFromJson(const Json& json);
Json toJson(const Factorization& factorization);
Factorization factorizationFromJson(const Json& json);

/// Returns the comparison as JSON; unknown values are null.
Json toJson(const Comparison& comparison, const ComparisonOptions& options);

/// Returns processor, compiler, flags and BLAS.
Json machineJson();
/// Measures the rates of dgemm.
void addDgemm(Json& machine);

}  // namespace slom::bench
