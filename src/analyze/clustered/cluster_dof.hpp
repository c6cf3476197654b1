/// Degrees of freedom of clustered variances.
#pragma once

#include <Eigen/Core>

#include "analyze/clustered/cluster_scores.hpp"

namespace slom {

/// Returns, for each column z of Z = H^-1 [e_c ...], the degrees of freedom 2 E(V)^2 / Var(V) of the variance V of its
/// component. Errors are assumed normal and as stated. `stated` holds, by component, the part of E(V) that is not
/// estimated. If no part is estimated, the degrees of freedom are infinite.
///
/// V = |p_1^T e|^2 + ... over the groups, with p_g^T p_h = B_gh = delta_gh |A_g x_g|^2 - y_g^T H^-1 y_h, x_g = J_g z
/// and y_g = J_g^T A_g x_g. So E(V) = tr B and Var(V) = 2 tr B^2. The trace of B^2 is exact for up to 300 groups or
/// shared unknowns. Otherwise it is the mean of |B w|^2 over random signs w.
///   source   Satterthwaite 1946; Bell and McCaffrey 2002, section 4; Hutchinson 1990 for the mean
Eigen::VectorXd satterthwaite(const LinearizedProblem& linearized, FreeGauge gauge,
                              const ClusterScores& scores, ClusterCorrection correction,
                              const Eigen::MatrixXd& Z, const Eigen::VectorXd& stated);

}  // namespace slom
