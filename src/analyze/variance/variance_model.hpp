/// A linearised problem whose measurements are weighted by the variances of their kinds. Errors shared by groups are
/// further unknowns.
///
/// The unknowns are x, and b of the shared errors. The residuals of measurement i of kind k are r_i + J_i x + b_g(i),
/// with covariance theta_k I. A shared error is measured by 0 = b_g with covariance theta_s I. The restricted
/// likelihood is that of the model in which b is part of the errors, because contrasts free of x and b are contrasts of
/// that model (Henderson's mixed model equations). So every component is a weight of some rows.
///   source   Henderson, "Best linear unbiased estimation and prediction under a selection model", 1975; Koch 1999,
///            section 3.6
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "analyze/clusters.hpp"
#include "analyze/linearized_problem.hpp"

namespace slom {

/// An error of the measurements of one kind, by group.
struct SharedTerm {
  /// The groups of the error; measurements of other kinds are in none. If the error changes along groups, each place is
  /// a group.
  Clustering groups;
  int dimension = 0;  ///< of each group's error
  /// If the error changes along groups, by place: the previous place in the same group (-1: none), and the distance to
  /// it over the correlation length. Otherwise empty.
  std::vector<int> previous{};
  std::vector<double> distance{};
};

class VarianceModel {
 public:
  /// Makes the model. `component_of`: by pool and measurement the component of its errors; -1: as stated. The
  /// components of `shared` follow. Throws the errors of covariances.
  VarianceModel(const LinearizedProblem& linearized, FreeGauge gauge,
                std::vector<std::vector<int>> component_of, std::vector<SharedTerm> shared, int kinds);

  /// Evaluation of the components at given variances theta.
  struct Evaluation {
    Eigen::VectorXd square;      ///< |v_k|^2, in units of sqrt(theta_k)
    Eigen::VectorXd redundancy;  ///< tr (I - H)_kk
    Eigen::MatrixXd S;           ///< |(I - H)_kl|^2, Frobenius: twice the expected information on log theta
  };
  int kinds() const { return kinds_; }
  int components() const { return kinds_ + static_cast<int>(shared_.size()); }
  /// Returns the number of scalar residuals of each component.
  const Eigen::VectorXd& residuals() const { return residuals_; }
  /// Weights rows by theta, solves, and evaluates. If `is_rough`, S is only good enough for a step. Throws the errors
  /// of covariances.
  Evaluation evaluate(const Eigen::VectorXd& theta, bool is_rough = false);
  /// Returns the derivative of the restricted log-likelihood by the logarithm of the correlation length of shared error
  /// s, at the theta evaluated last.
  double lengthSlope(int s) const;
  /// Returns the largest movement of an unknown in its standard deviations, at the theta evaluated last.
  double largestMove() const;
  /// Returns whether S is exact, not a mean over random signs.
  bool isExact() const;
  /// Returns whether the factor has the digits that leverages need.
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
  /// Calls f(group, measurement, component) for all rows whose variance is estimated.
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
  std::size_t original_groups_;  // of the problem: pools, and the group that holds components
  BlockStructure structure_;
  JacobianRows rows_;      // weighted by theta_
  Eigen::VectorXd theta_;  // of rows_
  Eigen::VectorXd residuals_, step_;
  std::unique_ptr<LinearSolver> solver_;
  std::unique_ptr<InverseBlocks> inverse_;
  bool is_accurate_ = true;
};

}  // namespace slom
