/// Warnings about wrong derivatives given by hand. With wrong derivatives a fit ends at a wrong place, or at the right
/// place with wrong standard deviations, and nothing else shows it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slom/problem/problem.hpp"

namespace slom {

class GivenDerivatives {
 public:
  /// Appends a sentence for each group whose given derivatives are wrong. Checks a few measurements of each group, once
  /// after each change of the structure, at the current values. Exceptions of measurement functions are not passed on.
  void check(const Problem& problem, std::vector<std::string>& warnings);

 private:
  std::uint64_t checked_at_ = ~std::uint64_t{0};  // structure revision
  std::vector<std::string> found_;
};

}  // namespace slom
