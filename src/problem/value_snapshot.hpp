/// Values of variables, kept to go back to.
#pragma once

#include <initializer_list>
#include <memory>
#include <set>
#include <vector>

#include "slom/problem/problem.hpp"

namespace slom {

/// The values of all variables at the time of construction.
class ValueSnapshot {
 public:
  explicit ValueSnapshot(Problem& problem);
  /// The values of these variables only.
  ValueSnapshot(Problem& problem, std::initializer_list<int> variables);
  ~ValueSnapshot();
  /// The value of a further variable, as it is now; nothing where there is one already.
  void keep(int variable);
  void restore();
  /// d := value now [-] value then, in the tangent space of the variable; of a snapshot of all variables.
  void difference(int variable, double* d) const;
  /// The present values of the variables of this one.
  std::unique_ptr<ValueSnapshot> takeAgain() const;
  /// Whether the value of this variable is among those that `keep` has taken.
  bool keeps(int variable) const { return kept_.count(variable) > 0; }
  /// The variables whose values `keep` has taken.
  const std::set<int>& kept() const { return kept_; }

 private:
  struct Copy;
  void copy(int variable);
  Problem& problem_;
  std::set<int> kept_;  // of those that are not all
  std::vector<std::unique_ptr<Copy>> copies_;
};

}  // namespace slom
