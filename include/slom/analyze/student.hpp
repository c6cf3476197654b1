/// Student's t distribution, for intervals whose variance is estimated.
#pragma once

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// The probability that |t| with `dof` > 0 degrees of freedom (not only whole numbers; infinite: the normal distribution) exceeds t >= 0.
///   source   NIST Digital Library of Mathematical Functions, 8.17.22 (continued fraction of the incomplete beta function)
double studentProbability(double t, double dof);

/// The t that |t| exceeds with this probability, in (0, 1).
double studentCritical(double probability, double dof);

}  // namespace slom
