/// How fast this machine multiplies dense matrices: what the rate of a factorisation is measured by.
#pragma once

namespace slom::bench {

/// Rate of C += A B for n x n matrices of double by Eigen on one thread, additions and multiplications [flop/s]; the
/// best of several tenths of a second.
double dgemmRate(int n);

}  // namespace slom::bench
