/// The values of all variables, kept to go back to.
#pragma once

#include <memory>
#include <vector>

#include "slom/problem/problem.hpp"

namespace slom {

/// The values of all variables at the time of construction.
class ValueSnapshot {
 public:
  explicit ValueSnapshot(Problem& problem);
  /// The value of one variable only.
  ValueSnapshot(Problem& problem, int variable);
  ~ValueSnapshot();
  void restore();

 private:
  struct Copy;
  void keep(int variable);
  Problem& problem_;
  std::vector<std::unique_ptr<Copy>> copies_;
};

}  // namespace slom
