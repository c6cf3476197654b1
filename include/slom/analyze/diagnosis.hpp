/// Diagnosis: what a problem determines and what not, in sentences with the user's names and a remedy.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom {

class Estimator;

/// A quantity that the measurements do not or hardly determine, in a sentence.
struct Finding {
  enum class Kind {
    /// A rigid motion or scaling of all variables, or a common shift of several numbers, changes no residual.
    gauge,
    undetermined,           ///< other directions in which variables can move without changing any residual
    unmeasured_variable,    ///< no measurement depends on the variable
    unobserved_component,   ///< measurements depend on the variable, but not on this component of it
    weak,                   ///< a direction in which residuals hardly change
    correlated,             ///< two components that the data can hardly distinguish
    disconnected,           ///< groups of variables that no measurement connects
    constant_measurements,  ///< all of their variables are fixed
    badly_scaled,           ///< components whose influence differs by many orders of magnitude
    implausible_sigma,      ///< the residuals of a group contradict its stated uncertainty
  };
  Kind kind;
  bool is_fault;  ///< true: the fit has no unique solution; false: a hint
  std::string text;
  std::vector<std::string> names;  ///< variables, components or groups concerned, the most important first
  int dimension = 0;               ///< number of directions; 0 for the other kinds
};

/// The rank of J, and what is missing for full rank.
struct Diagnosis {
  int residuals = 0;
  int unknowns = 0;
  int rank = 0;  ///< rank of J: unknowns minus the directions that change no residual
  std::vector<Finding> findings;
  /// Reason why the last fit, which gave these values, has not converged. Empty if it has or if there was none.
  std::string unconverged;

  /// Returns whether the measurements determine all unknowns.
  bool isDetermined() const { return rank == unknowns; }
  /// Returns a line on the rank and one for each finding.
  std::string text() const;
};

std::ostream& operator<<(std::ostream& os, const Diagnosis& diagnosis);

/// Examines the problem at the current values: its rank, the unknowns that are not or hardly determined, by the user's
/// names, and what to do about them. If all unknowns are well determined, this takes as long as 10 to 30 iterations of
/// the fit (bench_growth); if many are hardly determined, longer.
Diagnosis diagnose(const Estimator& est);

}  // namespace slom
