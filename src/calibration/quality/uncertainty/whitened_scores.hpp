// Scores of images and of corners, in coordinates in which the stated covariance of the shared parameters is the
// identity.
//
// Eliminating the poses leaves for each image its information Lambda_i and its score g_i = J_s^T r - H_sf H_ff^-1
// J_f^T r. Groups of images are sums of these. With C = (sum Lambda)^-1 = K K^T, the leverage of group g is N_g = K^T
// Lambda_g K, and the sandwich with the correction cr2 is
//   V = K (sum_g w_g w_g^T) K^T,   w_g = (I - N_g)^(-1/2) K^T g_g
// If the board has unknowns of its own, these are eliminated as well. K then has a row for each of them, and its rows
// of the shared parameters are a root of their covariance. All sums are as above.
//   source   Bell and McCaffrey 2002; docs/decisions/clustered_uncertainty.md, which has the literature
#pragma once

#include <map>
#include <vector>

#include "calibration/quality/uncertainty/information.hpp"

namespace slom::calibration {

/// The sum over groups of w w^T. K times this sum times K^T is the clustered covariance.
struct GroupSums {
  Eigen::MatrixXd V;
  Eigen::VectorXd
      dof;  ///< of the variance, by shared parameter (Satterthwaite); NaN for parameters that are not estimated
  int groups = 0;
};

/// Points of the board as groups, in addition to blocks of images.
struct BoardPointSums {
  Eigen::MatrixXd by_point, by_both;  ///< groups: points; pairs of a point and a block of images
  double dof = 0;                     ///< of by_point, from the weights of the points
  int points = 0;
};

/// Returns the stated posterior given all images, with the unknowns of the board marginalised.
Posterior statedPosterior(const Dataset& data, const FittedRig& rig, const Information& information);

class WhitenedScores {
 public:
  /// Computes the scores. `data` must be sorted.
  WhitenedScores(const Dataset& data, const FittedRig& rig);

  /// Returns K: all shared parameters x free ones. Rows of parameters that are not estimated are 0.
  auto root() const { return K_.topRows(shared_); }
  /// Returns the stated covariance of the shared parameters: root() times its transpose.
  Eigen::MatrixXd statedCovariance() const { return root() * root().transpose(); }
  int images() const { return int(images_.size()); }
  /// Returns the sums over blocks of `length` successive images. The last block also has the remainder.
  GroupSums byBlocks(int length) const;
  BoardPointSums byBoardPoints(int length) const;
  /// Returns tests of all corners, by image, then by camera, then in the order of the view.
  struct CornerTest {
    /// |(I - H)^-1 r|: the residual of the fit without the corner, to first order, with the leverage H of the corner
    /// [px]. The residual itself if no other corner checks this one.
    double without_px;
    double weighted;  ///< sqrt(r^T (I - H)^-1 r): the residual, studentised except for the noise [px]
  };
  const std::vector<CornerTest>& cornerTests() const { return tests_; }

 private:
  struct Image {
    Eigen::MatrixXd leverage;  // K^T Lambda K
    Eigen::VectorXd score;     // K^T g
    Eigen::MatrixXd on_board;  // Lambda K, rows of the unknowns of the board
  };
  /// Contributions of the corners of a view to their groups.
  struct ViewScores {
    int image;
    std::vector<int> points;   // by corner
    Eigen::MatrixXd scores;    // free parameters x corners
    Eigen::VectorXd leverage;  // trace of a corner's part of N
  };
  int blockOf(int image, int length) const {
    return std::min(image / length, std::max(1, images() / length) - 1);
  }
  void factorise(const SharedColumns& columns, const Eigen::MatrixXd& sum);
  /// Returns W with W^T W + A^2 = K^T Lambda (sum Lambda)^-1 Lambda K, A the leverage of the group.
  Eigen::MatrixXd onBoard(const Image& group) const;
  void addView(const FittedRig& rig, const View& view, std::size_t c, const SE3& left2world,
               const Eigen::MatrixXd& by_pose, const Matrix6& pose_inverse);
  void addBoard(const FittedRig& rig, const View& view, const SeenBoard& board,
                const Eigen::VectorXd& weights, Eigen::MatrixXd& rows);
  void addReading(const FittedRig& rig, const Observation& observation, const Eigen::MatrixXd& by_pose);

  int shared_;
  Eigen::MatrixXd K_, prior_;  // rows: shared parameters, then the unknowns of the board; prior_: K^T P K
  // Cholesky factor of the information on the board alone: lower triangle, scaled on both sides by board_scale_.
  Eigen::MatrixXd board_factor_;
  Eigen::VectorXd board_scale_;
  std::vector<Image> images_;
  std::vector<ViewScores> views_;
  std::vector<CornerTest> tests_;
  std::map<PointKey, int> points_;
};

}  // namespace slom::calibration
