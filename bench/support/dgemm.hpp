/// Speed of dense matrix products on this machine, the reference for rates of factorisations.
#pragma once

namespace slom::bench {

/// Returns the rate of C += A B for n x n matrices of double by Eigen on one thread, additions and multiplications
/// [flop/s]. It is the best of several tenths of a second.
double dgemmRate(int n);

}  // namespace slom::bench
