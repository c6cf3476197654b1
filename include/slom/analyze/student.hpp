/// Student's t distribution, for intervals whose variance is estimated.
#pragma once

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// Returns the probability that |t| exceeds t >= 0 with `dof` > 0 degrees of freedom (any real number; infinite: the
/// normal distribution).
///   source   NIST Digital Library of Mathematical Functions, 8.17.22 (continued fraction of the incomplete beta
///            function)
double studentProbability(double t, double dof);

/// Returns the t that |t| exceeds with this probability, in (0, 1).
double studentCritical(double probability, double dof);

}  // namespace slom
