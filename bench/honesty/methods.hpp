/// Claims of the peers.
#pragma once

#include <vector>

#include "support/classics/problem.hpp"

namespace slom::bench {

/// The end of a fit. If the fit threw an exception, `rss` is NaN.
struct Claim {
  bool converged = false, threw = false;
  double rss = 0;
  int iterations = 0;
  std::vector<double> x;
};

enum class Method { automatic, levenberg_marquardt, dog_leg };
Claim fitBySlom(const testing::classics::Problem& problem, Method method);
Claim fitByCeres(const testing::classics::Problem& problem, Method method);

}  // namespace slom::bench
