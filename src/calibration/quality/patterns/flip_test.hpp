// Whether a pattern is in the residuals, tested by flipping signs.
//
// A pattern is residuals F d with unknown d. Its score in a block of images is s_b = F_b^T e; without the pattern, each s_b may as
// well have the other sign, whatever the errors within a block have in common. The statistic s^T N^-1 s, s = sum s_b, is
// compared with what all signs of the blocks give. What poses and shared parameters have taken out of e is taken out of F too:
//   N = F^T (I - H) F,   s_b := F_b^T e - C^T Cov g_b,   C = J^T F,   g_b = J_b^T e
// with J by the shared parameters, poses eliminated, and their covariance Cov.
//   source   Hemerik, Goeman and Finos, "Robust testing in generalized linear models by sign flipping score contributions", Journal of the
//            Royal Statistical Society B 82, 2020 (effective scores, section 3)
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

namespace slom::calibration {

/// The products of what blocks of images say, and what they amount to.
class FlipTest {
 public:
  /// products(a, b): what blocks a and b have in common, s_a^T N^-1 s_b.
  explicit FlipTest(Eigen::MatrixXd products) : products_(std::move(products)) {}
  /// The share of all signs of the blocks that give as much or more.
  double probability() const;
  /// What the pattern explains of the squared residuals, without bias: blocks share nothing by chance.
  double explained() const { return products_.sum() - products_.trace(); }

 private:
  Eigen::MatrixXd products_;
};

/// The share of all signs of these numbers that give as large a sum or a larger one: for a pattern that can have one sign only.
double probabilityOfSum(const Eigen::VectorXd& sums);

/// Derivatives of a corner's pixel by D unknowns.
template <int D>
using PatternRows = Eigen::Matrix<double, 2, D, Eigen::ColMajor, 2, D == Eigen::Dynamic ? 12 : D>;

/// Scores of a pattern whose unknowns fall into cells that are estimated apart, d unknowns each.
class PatternScores {
 public:
  /// Of `shared` parameters.
  PatternScores(int cells, int unknowns, int blocks, int shared);

  /// A residual e in the cell [px], weighted as in the fit. Its rows are: F by the cell's unknowns, `pose` by the pose of the image, `by_shared`
  /// by the shared parameters, where the pose follows these.
  template <int D>
  void add(int cell, int block, double weight, const Eigen::Vector2d& e, const PatternRows<D>& F,
           const Eigen::Matrix<double, 2, 6>& pose,
           const Eigen::Matrix<double, Eigen::Dynamic, 2>& by_shared) {
    Cell& own = cells_[static_cast<std::size_t>(cell)];
    const PatternRows<D> weighted = weight * F;
    own.N += F.transpose().lazyProduct(weighted);
    own.square += F.cwiseProduct(weighted).colwise().sum().transpose();
    own.C += by_shared.lazyProduct(weighted);
    own.scores.col(block) += weighted.transpose().lazyProduct(e);
    own.by_pose += pose.transpose().lazyProduct(weighted);
    if (own.is_touched) return;
    own.is_touched = true;
    touched_.push_back(cell);
  }
  /// After the corners of one view.
  void endView(const Eigen::Matrix<double, 6, 6>& pose_inverse);
  /// After all views. `scores`: g_b of blocks, one column each.
  void finish(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& scores);

  /// products of FlipTest.
  const Eigen::MatrixXd& products() const { return products_; }
  /// N^-1 s_b of a cell; 0 in directions that the fit takes out.
  const Eigen::MatrixXd& estimates(int cell) const { return cells_[static_cast<std::size_t>(cell)].scores; }
  /// N^-1 of a cell, likewise.
  const Eigen::MatrixXd& covariance(int cell) const { return cells_[static_cast<std::size_t>(cell)].N; }
  int cells() const { return static_cast<int>(cells_.size()); }

 private:
  struct Cell {
    Eigen::MatrixXd N;        // d x d
    Eigen::VectorXd square;   // diagonal of F^T F
    Eigen::MatrixXd C;        // shared x d
    Eigen::MatrixXd scores;   // d x blocks
    Eigen::MatrixXd by_pose;  // 6 x d, of the current view
    bool is_touched = false;
  };
  std::vector<Cell> cells_;
  std::vector<int> touched_;
  Eigen::MatrixXd products_;
};

}  // namespace slom::calibration
