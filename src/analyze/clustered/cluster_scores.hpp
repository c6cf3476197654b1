/// Contributions of groups of measurements to a fit: the score of each group, and its leverage, by which the fit
/// follows the group.
///
/// A group g depends on private unknowns p, which no measurement outside of g depends on (such as the pose of an
/// image), and on shared unknowns s. Let P be the projection on the columns of J_p, and J~ = (I - P) J_s the rows
/// without the private part. Then the leverage is
///
///     H_gg = P + J~ C J~^T,    C = (H^-1)_ss
///
/// for any generalised inverse H^-1. Everything needed lives on the shared unknowns: N = J~^T J~ and J~^T r. Let E be
/// an orthonormal basis of eigenvectors of J~ C J~^T with eigenvalues lambda > 0. Then F = J~^T E has F F^T = N and
/// F^T C F = diag(lambda).
#pragma once

#include <vector>

#include <Eigen/Core>

#include "analyze/clusters.hpp"
#include "analyze/linearized_problem.hpp"

namespace slom {

struct ClusterFactor {
  std::vector<int> blocks;   ///< shared blocks of the group; without leverage all its blocks
  std::vector<int> start;    ///< first row of each block in F; one more entry for the end
  Eigen::MatrixXd F;         ///< shared unknowns x rank
  Eigen::VectorXd leverage;  ///< lambda, 0 to 1
  Eigen::VectorXd residual;  ///< E^T r; without leverage J_g^T r
  bool has_leverage = true;

  int unknowns() const { return start.back(); }
  /// Returns the number of unknowns of a block.
  int sizeOf(std::size_t block) const { return start[block + 1] - start[block]; }
};

class ClusterScores {
 public:
  /// Computes leverages with at most `most_columns` columns of H^-1. Groups that need more have no leverage. If each
  /// group of `finer` is a part of one group here, its factor is used instead of its measurements.
  ClusterScores(const LinearizedProblem& linearized, FreeGauge gauge, Clustering clustering, int most_columns,
                const ClusterScores* finer = nullptr);

  const Clustering& clustering() const { return clustering_; }
  const std::vector<ClusterFactor>& factors() const { return factors_; }
  int count() const { return clustering_.count(); }
  /// Returns the number of groups whose leverage is unknown.
  int withoutLeverage() const { return without_leverage_; }
  /// Returns the measurements of group g, as pool and index.
  const std::vector<MeasurementPlace>& measurements(int g) const {
    return measurements_[static_cast<std::size_t>(g)];
  }

  /// Returns the rows of Z (unknowns x k) for the unknowns of factor g.
  Eigen::MatrixXd rowsOf(const Eigen::MatrixXd& Z, int g) const;
  /// Returns E^T J_g Z of group g, 0 in directions that g alone determines; without leverage J_g Z itself.
  Eigen::MatrixXd imageOf(const Eigen::MatrixXd& Z, int g) const;
  /// Returns f(lambda) of the correction; 0 in directions that the group alone determines.
  Eigen::VectorXd factorsOf(ClusterCorrection correction, int g) const;
  /// Returns Z^T J_g^T A_g r_g of each group, groups x k.
  Eigen::MatrixXd effects(const Eigen::MatrixXd& Z, ClusterCorrection correction) const;
  /// Returns the expected squares of effects() if errors are independent and as stated, groups x k.
  Eigen::MatrixXd expectedSquares(const Eigen::MatrixXd& Z, ClusterCorrection correction) const;
  /// Returns sum_g (E^T J_g Z_a)^T (E^T J_g Z_b): the part of the stated covariance that other groups check.
  Eigen::MatrixXd vouchedFor(const Eigen::MatrixXd& Za, const Eigen::MatrixXd& Zb) const;
  /// Returns the part of z^T H z in directions of shared unknowns that group g alone determines. The leverage of g must
  /// be known.
  double aloneIn(const Eigen::VectorXd& z, int g) const;
  /// Returns whether no measurement outside of group g depends on the block.
  bool isPrivate(int block, int g) const { return owner_[static_cast<std::size_t>(block)] == g; }
  /// Returns H^-1 of all shared unknowns, in the order of shared(). Null if they are too many, or if they are more than
  /// the groups and H^-1 is only known by columns.
  const Eigen::MatrixXd* inverseOfShared() const;
  const std::vector<int>& shared() const { return shared_; }
  /// Returns the factor of all variances, in addition to the corrections of single groups.
  double factorOf(ClusterCorrection correction) const;

 private:
  static constexpr int kSharedBlock = -2;  // value in owner_
  static constexpr int kMostSharedUnknowns =
      1500;  // of one group; dense matrices of that size are decomposed

  void collectMeasurements();
  void findOwners();
  void reduce(int g);
  std::vector<std::vector<int>> partsFrom(const ClusterScores& finer) const;
  void join(int g, const ClusterScores& finer, const std::vector<int>& parts);
  bool invertShared(int most_columns);
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
  std::vector<int> owner_;  // by block: the only group that depends on it, or a constant of the source
  std::vector<ClusterFactor> factors_;
  std::vector<char> all_meet_;  // by group: whether all pairs of its shared blocks share a measurement
  std::vector<char> has_rows_;  // by group: whether F and residual hold J_g^T and r_g until finish()
  double cr1_ = 1;
  int without_leverage_ = 0;
  mutable bool inverse_is_known_ = false;
  mutable std::vector<int> shared_;  // unknowns
  mutable Eigen::MatrixXd inverse_of_shared_;
};

}  // namespace slom
