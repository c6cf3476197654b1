// A test for a pattern in the residuals, by flipping signs.
//
// A pattern is residuals F d with unknown d. Its score in a block of images is s_b = F_b^T e. Without the pattern,
// each s_b is as likely with the other sign, whatever errors have in common within a block. The statistic s^T N^-1 s
// with s = sum s_b is compared with its values for all signs of the blocks. Poses and shared parameters absorb a part
// of e; the same part is removed from F:
//   N = F^T (I - H) F,   s_b := F_b^T e - C^T Cov g_b,   C = J^T F,   g_b = J_b^T e
// J is the derivative by the shared parameters with the poses eliminated, Cov their covariance.
//   source   Hemerik, Goeman and Finos, "Robust testing in generalized linear models by sign flipping score
//            contributions", Journal of the Royal Statistical Society B 82, 2020 (effective scores, section 3)
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

namespace slom::calibration {

/// The test, from products between the scores of blocks of images.
class FlipTest {
 public:
  /// Takes products(a, b) = s_a^T N^-1 s_b of blocks a and b.
  explicit FlipTest(Eigen::MatrixXd products) : products_(std::move(products)) {}
  /// Returns the p-value: the fraction of sign flips of the blocks with a statistic at least as large.
  double probability() const;
  /// Returns the part of the squared residuals that the pattern explains. Unbiased, because products of different
  /// blocks have mean 0 without the pattern.
  double explained() const { return products_.sum() - products_.trace(); }

 private:
  Eigen::MatrixXd products_;
};

/// Returns the fraction of sign flips of these numbers with a sum at least as large. Suits patterns that can have
/// only one sign.
double probabilityOfSum(const Eigen::VectorXd& sums);

/// Derivatives of a corner's pixel by D unknowns.
template <int D>
using PatternRows = Eigen::Matrix<double, 2, D, Eigen::ColMajor, 2, D == Eigen::Dynamic ? 12 : D>;

/// Scores of a pattern whose unknowns belong to separately estimated cells, d unknowns each.
class PatternScores {
 public:
  /// Prepares the scores, for `shared` shared parameters.
  PatternScores(int cells, int unknowns, int blocks, int shared);

  /// Adds a residual e in the cell [px], weighted as in the fit. Its derivatives are F by the cell's unknowns, `pose`
  /// by the pose of the image, and `by_shared` by the shared parameters, with the pose following these.
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
  /// Must follow the corners of one view.
  void endView(const Eigen::Matrix<double, 6, 6>& pose_inverse);
  /// Must follow all views. `scores`: g_b of blocks, one column each.
  void finish(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& scores);

  /// Returns the products for FlipTest.
  const Eigen::MatrixXd& products() const { return products_; }
  /// Returns N^-1 s_b of a cell; 0 in directions that the fit absorbs.
  const Eigen::MatrixXd& estimates(int cell) const { return cells_[static_cast<std::size_t>(cell)].scores; }
  /// Returns N^-1 of a cell; 0 in directions that the fit absorbs.
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
