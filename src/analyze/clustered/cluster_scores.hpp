/// What each group of measurements contributes to a fit: its score, and the leverage by which the fit follows it.
///
/// A group g sees unknowns p that no measurement outside of it depends on (its private ones, as the pose of an image), and shared ones s. With the
/// private ones projected out of its rows, J~ = (I - P) J_s, P the projection on the columns of J_p, its leverage is
///
///     H_gg = P + J~ C J~^T,    C = (H^-1)_ss
///
/// whatever generalised inverse H^-1 is. All that is needed lives on the shared unknowns: N = J~^T J~ and J~^T r. With E an orthonormal basis
/// of eigenvectors of J~ C J~^T, eigenvalues lambda > 0, F = J~^T E has F F^T = N and F^T C F = diag(lambda).
#pragma once

#include <vector>

#include <Eigen/Core>

#include "analyze/clusters.hpp"
#include "analyze/linearized_problem.hpp"

namespace slom {

struct ClusterFactor {
  std::vector<int> blocks;   ///< shared blocks that the group sees; without leverage all that it sees
  std::vector<int> start;    ///< rows of each of them in F; one more for the end
  Eigen::MatrixXd F;         ///< shared unknowns x rank
  Eigen::VectorXd leverage;  ///< lambda, 0 to 1
  Eigen::VectorXd residual;  ///< E^T r; without leverage J_g^T r
  bool has_leverage = true;

  int unknowns() const { return start.back(); }
};

class ClusterScores {
 public:
  /// Leverages take at most `most_columns` columns of H^-1; groups that need more have none.
  ClusterScores(const LinearizedProblem& linearized, FreeGauge gauge, Clustering clustering,
                int most_columns);

  const Clustering& clustering() const { return clustering_; }
  const std::vector<ClusterFactor>& factors() const { return factors_; }
  int count() const { return clustering_.count(); }
  /// Number of groups whose leverage is not known.
  int withoutLeverage() const { return without_leverage_; }
  /// Measurements of group g, as pool and place.
  const std::vector<MeasurementPlace>& measurements(int g) const {
    return measurements_[static_cast<std::size_t>(g)];
  }

  /// The rows of Z (unknowns x k) that factor g is about.
  Eigen::MatrixXd rowsOf(const Eigen::MatrixXd& Z, int g) const;
  /// E^T J_g Z of group g, 0 in directions that it determines alone; without leverage J_g Z itself.
  Eigen::MatrixXd imageOf(const Eigen::MatrixXd& Z, int g) const;
  /// f(lambda) of the correction; 0 in directions that the group determines alone.
  Eigen::VectorXd factorsOf(ClusterCorrection correction, int g) const;
  /// Z^T J_g^T A_g r_g of each group, groups x k.
  Eigen::MatrixXd effects(const Eigen::MatrixXd& Z, ClusterCorrection correction) const;
  /// The squares that these would have on average with errors that are independent and as stated, groups x k.
  Eigen::MatrixXd expectedSquares(const Eigen::MatrixXd& Z, ClusterCorrection correction) const;
  /// sum_g (E^T J_g Z_a)^T (E^T J_g Z_b): the part of the stated covariance for which other groups vouch.
  Eigen::MatrixXd vouchedFor(const Eigen::MatrixXd& Za, const Eigen::MatrixXd& Zb) const;
  /// The part of z^T H z in directions that group g, whose leverage is known, determines alone of shared unknowns.
  double aloneIn(const Eigen::VectorXd& z, int g) const;
  /// Whether no measurement outside of group g depends on the block.
  bool isPrivate(int block, int g) const { return owner_[static_cast<std::size_t>(block)] == g; }
  /// H^-1 of all shared unknowns, in the order of shared(), computed at the first call; null where they are more than the groups or than 300.
  const Eigen::MatrixXd* inverseOfShared() const;
  const std::vector<int>& shared() const { return shared_; }
  /// The factor of all variances, beside that of single groups.
  double factorOf(ClusterCorrection correction) const;

 private:
  void collectMeasurements();
  void findOwners();
  void reduce(int g);
  void addInverses(int most_columns);
  void addColumns(const std::vector<int>& groups, std::vector<Eigen::MatrixXd>& inverses, int most_columns);
  bool keepRows(int g);
  void dropLeverage(int g);
  void finish(int g, const Eigen::MatrixXd& C);
  static void finishRows(ClusterFactor& factor, const Eigen::MatrixXd& C);

  const LinearizedProblem& linearized_;
  FreeGauge gauge_;
  Clustering clustering_;
  std::vector<std::vector<MeasurementPlace>> measurements_;  // by group
  std::vector<int> owner_;  // by block: the only group that sees it, or one of the constants of the source
  std::vector<ClusterFactor> factors_;
  std::vector<char>
      all_meet_;  // by group: whether all pairs of its shared blocks meet in one of its measurements
  std::vector<char> has_rows_;  // by group: whether F and residual hold J_g^T and r_g until finish()
  double cr1_ = 1;
  int without_leverage_ = 0;
  mutable bool inverse_is_known_ = false;
  mutable std::vector<int> shared_;  // unknowns
  mutable Eigen::MatrixXd inverse_of_shared_;
};

}  // namespace slom
