/// Variances of series whose errors are shared over longer stretches than any block.
#pragma once

#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// Returns the factor that extrapolates the variance of a value from the longest blocks to the whole series of `groups`
/// groups; 1 if there are too few lengths to see a growth. `variances`: from blocks of 1, 2, 4, ... groups. `length`: the
/// number of groups in the longest blocks.
///
/// For errors with a long memory, the variance per group of sums over blocks of b groups grows as b^a, a = 2 H - 1 with
/// Hurst's coefficient H. The variance by blocks is about the mean of all n groups, so that
/// V(b) = V(n) (b / n)^a (1 - (b / n)^(1 - a)). Beyond a = 0.8, so few blocks cannot distinguish such errors from a drift.
///   source   Beran, "Statistics for long-memory processes", 1994, section 4.4, and section 1.2 for the variance about
///            the mean
double longMemoryFactor(const std::vector<double>& variances, int groups, int length);

}  // namespace slom
