// What images say about the parameters that all of them share: lenses, camera to camera, IMU.
//
// The pose of the board in image i is seen by that image alone, so the normal equations are an arrow, and
// eliminating the poses leaves a sum over the images:
//   information  Lambda_i = H_ss - H_sf H_ff^-1 H_fs,   covariance of the shared parameters  C = (sum_i
//   Lambda_i)^-1
// s: shared parameters, f: the pose left2world of image i, H = J^T J of its whitened measurements.
//
// A calibration knows its own frame only through the boards: another sample of the noise gives another one.
// The motion between the two is where the boards, moved by it, are seen best by the cameras as they are
// ("cross-reprojection", https://mrcal.secretsauce.net/docs-3.0/uncertainty-cross-reprojection.html). To
// first order it is
//   motion = G^-1 F ds + noise of covariance G^-1 N G^-1, independent of ds,
//   G = sum P^T H_cc P,  F = sum P^T H_cc H_ff^-1 H_fs,  N = sum P^T H_cc H_ff^-1 H_cc P
// with H_cc the part of H_ff that corners make, and P what the motion does to the pose of an image.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "calibration/data/board_basis.hpp"
#include "calibration/data/point_key.hpp"
#include "calibration/models/lens.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Where the shared parameters stand: for each camera its lens and, but for the first, its pose left2camera
/// (translation, rotation); then the IMU's rotation, acc_bias and gravity.
struct SharedColumns {
  std::vector<int> lens, pose;  ///< first column, by camera; -1 where there is none
  int imu = -1;
  int size = 0;
  std::vector<int> free;            ///< those that are estimated, rising
  std::vector<int> held_near_zero;  ///< those of the prior Settings::sigma_denominator
  std::vector<std::string> names;   ///< `left.fx`
};

/// Where the board has unknowns of its own: those of the corners that the data on the fitted board show.
class BoardColumns {
 public:
  explicit BoardColumns(const FittedBoard& board);
  int unknowns() const { return 3 * basis_.blocks(); }
  /// Of the corner that is here on the fitted board: its first unknown, and how they move it.
  std::pair<int, const Eigen::Matrix3d*> of(const vec3& world) const;
  double sigma() const { return sigma_; }

 private:
  BoardBasis basis_;
  std::map<PointKey, int> fitted_;  // points of the basis
  double sigma_;
};

/// The calibrated rig.
struct FittedRig {
  explicit FittedRig(const Result& result);

  std::vector<Lens> lenses;
  std::vector<SE3> left2camera;
  std::map<int, SE3> left2world;
  std::optional<ImuResult> imu;
  double sigma_px, sigma_acc;
  std::optional<double> sigma_denominator;
  std::optional<BoardColumns> board;
  SharedColumns columns;
};

/// What is seen in one image: by camera the points of the board that it sees, in the world, and a reading.
struct Observation {
  SE3 left2world;
  std::vector<std::vector<vec3>> points;
  std::optional<vec3> acc;
  std::vector<std::vector<double>> sigmas{};  ///< Corner::sigma, as points; empty: 1 each
};

/// How a camera sees points of the board in one image.
class SeenBoard {
 public:
  /// `rig` must live as long.
  SeenBoard(const FittedRig& rig, std::size_t camera, const SE3& left2world);

  /// The pixel of a point, and how it changes [px].
  struct Rows {
    Lens::Projection seen;  ///< by the lens parameters, too
    Eigen::Matrix<double, 2, 6> by_left2camera, by_pose;
    Eigen::Matrix<double, 2, 3> by_point;  ///< in the world

    vec2 pixel() const { return seen.pixel; }
  };
  Rows rowsOf(const vec3& point) const;
  /// By all shared parameters, where the pose of the image follows them by ImageEquations::pose_by_shared.
  void setByShared(const Rows& rows, const Eigen::Matrix<double, 6, Eigen::Dynamic>& pose_by_shared,
                   Eigen::Matrix<double, Eigen::Dynamic, 2>& by_shared) const;

 private:
  const FittedRig& rig_;
  std::size_t camera_;
  Eigen::Matrix3d left2camera_, world2left_;
  Eigen::Vector3d offset_, origin_;
};

/// The normal equations of one image: by all shared parameters, then, where they are asked for, the unknowns of the board, and by its pose, which is
/// eliminated.
struct ImageEquations {
  Eigen::MatrixXd H;                                        ///< lower triangle; the pose last
  Eigen::Matrix<double, 6, Eigen::Dynamic> pose_by_shared;  ///< H_ff^-1 H_fs
  Matrix6 pose_inverse;                                     ///< H_ff^-1
};
ImageEquations equationsOf(const FittedRig& rig, const Observation& observation);
/// With those of the board, where it has some.
ImageEquations equationsWithBoard(const FittedRig& rig, const Observation& observation);

/// By what a reading changes: residual = R(left2world) left2imu^-1 (acc - bias) - gravity e_z.
struct ReadingJacobian {
  Eigen::Matrix<double, 3, 7> by_imu;
  Eigen::Matrix<double, 3, 6> by_pose;
};
ReadingJacobian differentiateReading(const FittedRig& rig, const Observation& observation);

/// The sums over images; of one image, its share.
class Information {
 public:
  explicit Information(const SharedColumns& columns);
  void add(const Information& images);
  /// Sets it to the sum of two disjoint sets of images of one rig.
  void setSum(const Information& a, const Information& b);
  /// The prior Settings::sigma_denominator, where the result has it.
  void addPrior(const FittedRig& rig);
  /// The covariance of the shared parameters; 0 for those that are not estimated.
  Eigen::MatrixXd covariance() const;

 private:
  friend Information informationOf(const FittedRig& rig, const Observation& observation);
  friend struct Posterior;
  friend class VarianceBound;

  std::vector<int> free_;
  int all_;                 // shared parameters, free or not
  Eigen::MatrixXd shared_;  // sum of Lambda for the free parameters: the lower triangle
  Eigen::Matrix<double, 6, Eigen::Dynamic> motion_shared_;      // F, likewise
  Matrix6 motion_ = Matrix6::Zero(), noise_ = Matrix6::Zero();  // G, N
};
Information informationOf(const FittedRig& rig, const Observation& observation);

/// What a set of images knows, ready to be propagated. A number that changes by a ds + e dm, with the shared parameters and with
/// the motion of the frame, has the variance |w|^2, w = whitened(a, e); two of them have the covariance w1 . w2.
struct Posterior {
  explicit Posterior(const Information& information);
  /// With another covariance of all shared parameters, such as the clustered one; what the poses of the images leave open of the motion of the
  /// frame stays as stated.
  Posterior(const Information& information, const Eigen::MatrixXd& covariance);
  /// Columns w, of rows a (of all shared parameters) and e.
  Eigen::MatrixXd whitened(const Eigen::MatrixXd& by_shared, const Eigen::MatrixXd& by_motion) const;
  /// 0 for those that are not estimated.
  Eigen::MatrixXd covarianceOfShared() const;

 private:
  friend class VarianceBound;
  /// (sum of Lambda)^-1 times a vector of the free ones.
  Eigen::VectorXd solve(const Eigen::VectorXd& by_free) const;

  std::vector<int> free_;
  int all_;
  Eigen::VectorXd
      scale_;  // units differ by orders of magnitude: with a unit diagonal the inverse keeps its digits
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::MatrixXd
      root_;  // with another covariance, root_ root_^T is that of the free parameters; otherwise empty
  Eigen::Matrix<double, 6, Eigen::Dynamic> motion_by_shared_;  // G^-1 F
  Matrix6 noise_root_;                                         // its square is G^-1 N G^-1
};

/// The observation of each image, by its number.
std::map<int, Observation> observationsOf(const Dataset& data, const FittedRig& rig);

}  // namespace slom::calibration
