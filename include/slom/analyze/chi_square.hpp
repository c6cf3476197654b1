/// The chi-square distribution, for tests of residuals.
#pragma once

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// The probability that chi-square with `dof` > 0 degrees of freedom (not only whole numbers) exceeds x: Q(dof / 2, x / 2).
///   source   NIST Digital Library of Mathematical Functions, 8.7.1 (series) and 8.9.2 (continued fraction)
double chiSquareProbability(double x, double dof);

/// The x that is exceeded with this probability, in (0, 1).
double chiSquareCritical(double probability, double dof);

}  // namespace slom
