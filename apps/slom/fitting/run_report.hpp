// What a run found and what it cost, as data.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <slom/optimize/summary.hpp>

namespace slom::app {

/// Seconds since its construction.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

struct RunReport {
  Summary summary;
  int threads = 1;
  std::vector<std::string> warnings;    ///< on the data, before the fit; those of the fit are in its summary
  int free_directions = 0;              ///< which no measurement determines; they add to the redundancy
  bool has_all_free_directions = true;  ///< false: there may be more, and the redundancy may be larger
  double load_seconds = 0;              ///< reading, checking and starting
  double setup_seconds = 0;             ///< putting variables and measurements into the estimator
  std::shared_ptr<const nlohmann::ordered_json> online;  ///< figures of an online run; null otherwise
  double total_seconds = 0;  ///< from the start of the run to the end of the fit; files are written after it
};

/// The keys are those of docs/graph.md.
std::string toJson(const RunReport& report);

/// Peak memory of this process so far [MB, 10^6 bytes].
double peakMemoryMb();

}  // namespace slom::app
