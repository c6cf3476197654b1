/// Warnings of derivatives that are given by hand and wrong: a fit with them ends at a wrong place, or at the right one with wrong
/// standard deviations, and does not notice.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slom/problem/problem.hpp"

namespace slom {

class GivenDerivatives {
 public:
  /// Appends a sentence for each group whose given derivatives are wrong. It looks at a few measurements of each group, once after
  /// each change of the structure, at the values of that time. Throws nothing that functions of measurements do.
  void check(const Problem& problem, std::vector<std::string>& warnings);

 private:
  std::uint64_t checked_at_ = ~std::uint64_t{0};  // structure revision
  std::vector<std::string> found_;
};

}  // namespace slom
