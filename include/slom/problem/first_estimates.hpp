/// First estimates: the values at which Jacobians are taken for variables that marginal priors depend on.
///
/// A prior that marginalisation leaves is linearised once. If the other measurements of its variables are linearised where the values have moved
/// to since, the two disagree about which motions of the world no measurement sees, and together claim to know some of them.
///   source   Huang, Mourikis, Roumeliotis, "Observability-based rules for designing consistent EKF SLAM estimators", IJRR 2010
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// The points, by variable.
class FirstEstimates {
 public:
  /// Whether no variable has one.
  bool isEmpty() const { return count_ == 0; }
  /// Where the Jacobians of the variable's measurements are taken, of its type; null: at its current value.
  const void* of(int variable) const {
    const auto v = static_cast<std::size_t>(variable);
    return v < points_.size() ? points_[v] : nullptr;
  }
  /// Whether one of these variables has one.
  bool hasAny(const int* variables, int count) const {
    return std::any_of(variables, variables + count, [this](int v) { return of(v) != nullptr; });
  }

  /// So that `set` cannot fail for variables below this number.
  void makeRoom(std::size_t variables);
  /// `point` belongs to somebody else; null: none.
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
