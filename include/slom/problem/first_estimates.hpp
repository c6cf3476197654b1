/// FirstEstimates: the values at which Jacobians are taken for variables that marginal priors depend on.
///
/// A prior from marginalisation is linearised once. If other measurements of its variables are linearised at later
/// values, the two disagree about which motions of the world no measurement observes. Together they then seem to
/// determine some of these motions.
///   source   Huang, Mourikis, Roumeliotis, "Observability-based rules for designing consistent EKF SLAM estimators",
///            IJRR 2010
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// The first estimates by variable.
class FirstEstimates {
 public:
  /// Returns whether no variable has a first estimate.
  bool isEmpty() const { return count_ == 0; }
  /// Returns the value, of the variable's type, at which the Jacobians of its measurements are taken; null: the current
  /// value.
  const void* of(int variable) const {
    const auto v = static_cast<std::size_t>(variable);
    return v < points_.size() ? points_[v] : nullptr;
  }
  /// Returns whether one of these variables has a first estimate.
  bool hasAny(const int* variables, int count) const {
    return std::any_of(variables, variables + count, [this](int v) { return of(v) != nullptr; });
  }

  /// Reserves memory, so that `set` cannot fail for variables below this number.
  void makeRoom(std::size_t variables);
  /// Sets the first estimate of a variable; null: none. `point` is not owned.
  void set(int variable, const void* point) {
    const void*& place = points_[static_cast<std::size_t>(variable)];
    count_ += static_cast<int>(point != nullptr) - static_cast<int>(place != nullptr);
    place = point;
  }

 private:
  std::vector<const void*> points_;  // by variable
  int count_ = 0;
};

}  // namespace slom
