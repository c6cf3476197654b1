/// What Estimator::update() does, and how it went.
#pragma once

#include <string>
#include <vector>

namespace slom {

struct UpdateOptions {
  /// Steps are taken until another one promises to decrease the RSS by no more than this part of it.
  double tolerance = 1e-6;
  /// Steps at most. What is left is done by the next call.
  int max_steps = 100;
};

struct UpdateSummary {
  bool converged = false;  ///< the promise is within the tolerance
  std::string message;     ///< why it ended, in a sentence
  double rss = 0;          ///< at the end
  double promise = 0;  ///< by how much another step would decrease the RSS, by the linear model: g^T H^-1 g
  int steps = 0;
  int variables_moved = 0;          ///< counted in each step
  int measurements_linearized = 0;  ///< counted each time
  int fronts_factorized = 0;        ///< parts of the factor that were computed again
  double flops = 0;                 ///< of their factorisation
  bool reordered = false;           ///< all variables were ordered anew
  bool used_optimize =
      false;  ///< steps went uphill, or there are bounds: optimize() took over, in time proportional to everything
  /// Names of components that no measurement determines, given those of other variables; they keep their values until one does.
  std::vector<std::string> undetermined;
};

}  // namespace slom
