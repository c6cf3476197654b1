/// What a problem determines and what it does not, in sentences with the user's names and a remedy.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// Something that the measurements do not determine, or hardly, in a sentence.
struct Finding {
  enum class Kind {
    gauge,  ///< a rigid motion or a scale of everything changes no residual, or a shift of several numbers
    undetermined,           ///< other directions in which variables can move without changing any residual
    unmeasured_variable,    ///< no measurement depends on it
    unobserved_component,   ///< measurements depend on the variable, but not on this component of it
    weak,                   ///< a direction in which residuals hardly change
    correlated,             ///< two components that the data hardly distinguish
    disconnected,           ///< groups of variables that no measurement connects
    constant_measurements,  ///< all of their variables are fixed
    badly_scaled,           ///< components whose influence differs by many orders of magnitude
    implausible_sigma,      ///< the residuals of a group contradict its stated uncertainty
  };
  Kind kind;
  bool is_fault;  ///< the fit has no unique solution; otherwise a hint
  std::string text;
  std::vector<std::string> names;  ///< variables, components or groups concerned, the most important first
  int dimension = 0;               ///< number of directions; 0 for the other kinds
};

/// What the measurements determine: the rank of J and what lacks for it.
struct Diagnosis {
  int residuals = 0;
  int unknowns = 0;
  int rank = 0;  ///< rank of J: unknowns less the directions that change no residual
  std::vector<Finding> findings;
  std::string
      unconverged;  ///< why the last fit, whose values these are, has not converged; empty: it has, or there was none

  /// Whether the measurements determine all unknowns.
  bool isDetermined() const { return rank == unknowns; }
  /// A line on the rank and one for each finding.
  std::string text() const;
};

std::ostream& operator<<(std::ostream& os, const Diagnosis& diagnosis);

}  // namespace slom
