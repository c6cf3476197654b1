/// Saved values of variables, to return to.
#pragma once

#include <initializer_list>
#include <memory>
#include <set>
#include <vector>

#include "slom/problem/problem.hpp"

namespace slom {

/// The values at the time of construction.
class ValueSnapshot {
 public:
  explicit ValueSnapshot(Problem& problem);
  /// Saves the values of these variables only.
  ValueSnapshot(Problem& problem, std::initializer_list<int> variables);
  ~ValueSnapshot();
  /// Saves the present value of a further variable, unless it is saved already.
  void keep(int variable);
  void restore();
  /// Computes d := value now [-] saved value, in the tangent space of the variable. Needs a snapshot of all variables.
  void difference(int variable, double* d) const;
  /// Returns a snapshot of the present values of the variables of this one that `keep` has saved.
  std::unique_ptr<ValueSnapshot> takeAgain() const;
  /// Returns whether `keep` has saved the value of this variable.
  bool keeps(int variable) const { return kept_.count(variable) > 0; }
  /// Returns the variables whose values `keep` has saved.
  const std::set<int>& kept() const { return kept_; }

 private:
  struct Copy;
  void copy(int variable);
  Problem& problem_;
  std::set<int> kept_;  // the variables that keep() saved
  std::vector<std::unique_ptr<Copy>> copies_;
};

}  // namespace slom
