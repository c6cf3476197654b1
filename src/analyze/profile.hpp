#pragma once

#include <functional>
#include <memory>

#include "slom/analyze/uncertainty.hpp"

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

/// The root of a function that grows with t > 0, is -1 at 0 and about (t / guess)^2 - 1, up to 1000 guesses; infinite beyond.
double profileRoot(const std::function<double(double)>& f, double guess);

}  // namespace slom
