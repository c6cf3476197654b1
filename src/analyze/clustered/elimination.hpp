/// Elimination of unknowns from the information of a group.
#pragma once

#include <Eigen/Core>

namespace slom {

/// Eliminates unknowns p from [App Aps; Asp Ass] x = [bp; bs]: subtracts Asp App^+ Aps from `A` and Asp App^+ bp from
/// `b`. `Aps_bp` is [Aps bp]. Unknowns p that nothing determines count as 0.
void eliminate(const Eigen::MatrixXd& App, const Eigen::MatrixXd& Aps_bp, Eigen::MatrixXd& A,
               Eigen::VectorXd& b);

}  // namespace slom
