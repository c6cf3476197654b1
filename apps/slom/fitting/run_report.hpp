// Results and costs of a run, as data.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <slom/optimize/summary.hpp>

namespace slom::app {

/// A stopwatch that counts the seconds since its construction.
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
  std::vector<std::string> warnings;    ///< on the data, before the fit; the summary has those of the fit
  int free_directions = 0;              ///< no measurement determines them; they add to the redundancy
  bool has_all_free_directions = true;  ///< false: there may be more, and more redundancy
  double load_seconds = 0;              ///< reading, checking and starting
  double setup_seconds = 0;             ///< putting variables and measurements into the estimator
  std::shared_ptr<const nlohmann::ordered_json> online;  ///< figures of an online run; null otherwise
  double total_seconds = 0;  ///< from the start of the run to the end of the fit, before files
};

/// Returns the report as JSON with the keys of docs/graph/json.md.
std::string toJson(const RunReport& report);

/// Returns the peak memory of this process so far [MB, 10^6 bytes].
double peakMemoryMb();

}  // namespace slom::app
