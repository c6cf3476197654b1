/// A linearised problem whose measurements are weighted by the variances of their kinds, with errors that groups share as further unknowns.
///
/// With unknowns x and b of the shared errors the residuals of measurement i of kind k are r_i + J_i x + b_g(i), their covariance theta_k I; a shared
/// error is measured by 0 = b_g with covariance theta_s I. Its restricted likelihood is that of the model in which b is part of the errors,
/// as contrasts that are free of x and b are those of the latter (Henderson's mixed model equations). So all components are alike: a weight of some rows.
///   source   Henderson, "Best linear unbiased estimation and prediction under a selection model", 1975; Koch 1999, section 3.6
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "analyze/clusters.hpp"
#include "analyze/linearized_problem.hpp"

namespace slom {

/// An error of the measurements of one kind, by group.
struct SharedTerm {
  Clustering
      groups;  ///< those of other kinds are in none; where the error changes along groups, each place is a group
  int dimension = 0;  ///< of each group's error
  /// Where the error changes along groups, by place: the place before it in the same group (-1: none), and the distance to that over the
  /// correlation length. Otherwise empty.
  std::vector<int> previous{};
  std::vector<double> distance{};
};

class VarianceModel {
 public:
  /// `component_of`: by pool and measurement the component of its errors, -1: as stated. The components of `shared` follow.
  /// Throws what covariances throw.
  VarianceModel(const LinearizedProblem& linearized, FreeGauge gauge,
                std::vector<std::vector<int>> component_of, std::vector<SharedTerm> shared, int kinds);

  /// Statements about the components at some variances theta.
  struct Evaluation {
    Eigen::VectorXd square;      ///< |v_k|^2, in units of sqrt(theta_k)
    Eigen::VectorXd redundancy;  ///< tr (I - H)_kk
    Eigen::MatrixXd S;           ///< |(I - H)_kl|^2, Frobenius: twice the expected information on log theta
  };
  int kinds() const { return kinds_; }
  int components() const { return kinds_ + static_cast<int>(shared_.size()); }
  /// Number of scalar residuals of each component.
  const Eigen::VectorXd& residuals() const { return residuals_; }
  /// Weighs rows by theta, solves, and evaluates; `is_rough`: S need not be more than good enough for a step. Throws what covariances throw.
  Evaluation evaluate(const Eigen::VectorXd& theta, bool is_rough = false);
  /// Derivative of the restricted log-likelihood by the logarithm of the correlation length of shared error s, at the theta evaluated last.
  double lengthSlope(int s) const;
  /// By how many of its standard deviations the unknown that moves most moves, at the theta evaluated last.
  double largestMove() const;
  /// Whether S is exact, and not a mean over random signs.
  bool isExact() const;
  /// Whether the factor had the digits that leverages need.
  bool isAccurate() const { return is_accurate_; }

 private:
  void makeStructure();
  void addRows();
  void addSharedRows();
  void addDatum();
  int componentOf(std::size_t group, int m) const;
  void weigh(const Eigen::VectorXd& theta);
  bool solve();
  double addLeverages(Evaluation& result) const;
  void addInformation(Evaluation& result, bool is_rough);
  Eigen::MatrixXd squaredLeverages();
  Eigen::MatrixXd squaredLeveragesByProbes(int count);
  /// f(group, measurement, component) for all rows whose variance is estimated.
  template <class F>
  void forEachOfComponents(const F& f) const {
    for (std::size_t g = 0; g < structure_.groups.size(); ++g) {
      for (int m = 0; m < rows_.size(g); ++m) {
        if (const int c = componentOf(g, m); c >= 0) f(g, m, c);
      }
    }
  }

  const LinearizedProblem& linearized_;
  FreeGauge gauge_;
  std::vector<std::vector<int>> component_of_;
  std::vector<SharedTerm> shared_;
  int kinds_;
  std::size_t original_groups_;  // of the problem: pools, and the group of what does not move
  BlockStructure structure_;
  JacobianRows rows_;      // weighted by theta_
  Eigen::VectorXd theta_;  // of rows_
  Eigen::VectorXd residuals_, step_;
  std::unique_ptr<LinearSolver> solver_;
  std::unique_ptr<InverseBlocks> inverse_;
  bool is_accurate_ = true;
};

}  // namespace slom
