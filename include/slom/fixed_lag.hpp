/// FixedLag: a window over the newest variables of an estimator.
///
///     slom::FixedLag window({.variables = 50});
///     for (const Reading& reading : readings) {
///       const auto pose = est.insertRV(...);
///       est.insertMeasurement(...);
///       window.add(pose);
///       est.optimize();
///       window.forget(est);
///     }
///
/// Variables that leave the window are marginalised (Estimator::marginalize). So the number of unknowns stays bounded,
/// and the information on the other variables is kept.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "slom/estimator.hpp"

namespace slom {

/// Limits of the window. A variable leaves if it exceeds either limit.
struct FixedLagOptions {
  int variables = std::numeric_limits<int>::max();  ///< maximum number of variables in the window
  /// Maximum age relative to the newest variable, in units of their times.
  double duration = std::numeric_limits<double>::infinity();
  /// If true, the priors keep the linearisation points of their variables (MarginalizeOptions::first_estimates).
  bool first_estimates = false;
};

/// The variables in a window, by their times.
class FixedLag {
 public:
  /// Checks the options. Throws [slom.bad-option].
  explicit FixedLag(const FixedLagOptions& options) : options_(options) {
    if (options.variables < 1) {
      throw Error("slom.bad-option",
                  "the window of a FixedLag has " + std::to_string(options.variables) +
                      " variables; pass a positive number, such as 50",
                  "variables");
    }
    if (!(options.duration >= 0)) {
      throw Error("slom.bad-option",
                  "the duration of a FixedLag is " + std::to_string(options.duration) +
                      "; pass a number that is not negative, such as 10",
                  "duration");
    }
  }

  /// Adds a variable with its time, in any order. If the variable is in the window already, such as a landmark seen
  /// again, its time becomes the later of the two. A variable older than the window takes part in the next fit and
  /// leaves with the next `forget`, so late measurements count. Throws [slom.bad-time].
  void add(const AnyVarID& id, double time) {
    if (!std::isfinite(time)) {
      throw Error(
          "slom.bad-time",
          "the time of a variable in a FixedLag is " + std::to_string(time) + "; pass a finite number",
          "time");
    }
    for (Entry& entry : entries_) {
      if (!(entry.id == id)) continue;
      entry.time = std::max(entry.time, time);
      return;
    }
    entries_.push_back({id, time});
  }
  /// Adds a variable 1 later than the newest one, or at 0 if it is the first. For windows that count variables.
  void add(const AnyVarID& id) { add(id, entries_.empty() ? 0 : newest() + 1); }

  /// Marginalises the variables that are too old; among equally old ones, those added first. Returns the number of
  /// removed variables. Variables that were removed otherwise are no longer in the window. Throws as
  /// Estimator::marginalize does, with nothing changed.
  int forget(Estimator& est) {
    std::erase_if(entries_, [](const Entry& entry) { return !entry.id.isValid(); });
    if (entries_.empty()) return 0;
    std::stable_sort(entries_.begin(), entries_.end(),
                     [](const Entry& a, const Entry& b) { return a.time < b.time; });
    const double oldest = newest() - options_.duration;
    const auto most = static_cast<std::size_t>(options_.variables);
    std::size_t gone = entries_.size() > most ? entries_.size() - most : 0;
    while (entries_[gone].time < oldest) ++gone;
    if (gone == 0) return 0;
    std::vector<AnyVarID> ids;
    for (std::size_t i = 0; i < gone; ++i) ids.push_back(entries_[i].id);
    est.marginalize(ids, {.first_estimates = options_.first_estimates});
    entries_.erase(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(gone));
    return static_cast<int>(gone);
  }

  /// Returns the number of variables in the window.
  int size() const { return static_cast<int>(entries_.size()); }

 private:
  struct Entry {
    AnyVarID id;
    double time;
  };
  double newest() const {
    double time = entries_.front().time;
    for (const Entry& entry : entries_) time = std::max(time, entry.time);
    return time;
  }

  FixedLagOptions options_;
  std::vector<Entry> entries_;
};

}  // namespace slom
