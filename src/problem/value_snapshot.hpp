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
  ~ValueSnapshot();
  void restore();

 private:
  struct Copy;
  Problem& problem_;
  std::vector<std::unique_ptr<Copy>> copies_;
};

}  // namespace slom
