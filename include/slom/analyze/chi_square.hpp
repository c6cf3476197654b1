/// The chi-square distribution, for tests of residuals.
#pragma once

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// Returns the probability Q(dof / 2, x / 2) that chi-square with `dof` > 0 degrees of freedom (any real number)
/// exceeds x.
///   source   NIST Digital Library of Mathematical Functions, 8.7.1 (series) and 8.9.2 (continued fraction)
double chiSquareProbability(double x, double dof);

/// Returns the x that chi-square exceeds with this probability, in (0, 1).
double chiSquareCritical(double probability, double dof);

}  // namespace slom
