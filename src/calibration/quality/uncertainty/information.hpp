// Information of images about the parameters that all images share: lenses, camera to camera, IMU.
//
// The pose of the board in image i is seen only in that image, so the normal equations form an arrow. Eliminating the
// poses leaves a sum over the images:
//   information  Lambda_i = H_ss - H_sf H_ff^-1 H_fs
//   covariance of the shared parameters  C = (sum_i Lambda_i)^-1
// s: shared parameters, f: the pose left2world of image i, H = J^T J of its whitened measurements.
//
// Only the boards determine the frame of a calibration, so another sample of the noise gives another frame. The
// motion between the two is the one for which the cameras see the moved boards best ("cross-reprojection",
// https://mrcal.secretsauce.net/docs-3.0/uncertainty-cross-reprojection.html). To first order it is
//   motion = G^-1 F ds + noise of covariance G^-1 N G^-1, independent of ds,
//   G = sum P^T H_cc P,  F = sum P^T H_cc H_ff^-1 H_fs,  N = sum P^T H_cc H_ff^-1 H_cc P
// H_cc is the part of H_ff from corners, and P is the derivative of the pose of an image by the motion.
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
#include "calibration/fit/seen_board.hpp"
#include "calibration/models/lens.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Columns of the shared parameters: for each camera its lens, its readout if that was estimated and, except for the
/// first, its pose left2camera (translation, rotation); then the IMU's rotation, acc_bias and gravity.
struct SharedColumns {
  std::vector<int> lens, readout, pose;  ///< first column, by camera; -1: none
  std::vector<int> of_camera;            ///< number of columns of lens and readout, by camera
  int imu = -1;
  int size = 0;
  std::vector<int> free;            ///< estimated parameters, ascending
  std::vector<int> held_near_zero;  ///< parameters of the prior Settings::sigma_denominator
  std::vector<std::string> names;   ///< `left.fx`
};

/// Columns of the board's own unknowns, for the corners that the data on the fitted board have.
class BoardColumns {
 public:
  explicit BoardColumns(const FittedBoard& board);
  int unknowns() const { return 3 * basis_.blocks(); }
  /// Returns, for the corner at this place on the fitted board, its first unknown and the map by which the unknowns
  /// move it.
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
  /// Returns the board before a camera, seen from a pose of the rig. The rig must outlive the returned object.
  SeenBoard seenBoard(std::size_t camera, const SE3& left2world) const {
    return {lenses[camera], left2camera[camera], left2world};
  }

  std::vector<Lens> lenses;
  std::vector<SE3> left2camera;
  std::map<int, SE3> left2world;
  std::optional<ImuResult> imu;
  double sigma_px, sigma_acc;
  std::optional<double> sigma_denominator;
  std::optional<BoardColumns> board;
  SharedColumns columns;
};

/// The observations of one image: by camera the corners that it sees, and a reading. Pixels of corners are not used.
struct Observation {
  SE3 left2world;
  std::vector<std::vector<Corner>> corners;
  std::optional<vec3> acc;
};

/// Derivatives of the pixel of a corner by what belongs to the camera, in the order of SharedColumns: its lens, and its
/// readout if that was estimated [px].
using ByCamera = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, Lens::most_parameters + 1>;
ByCamera byCamera(const SharedColumns& columns, std::size_t camera, const SeenBoard::Rows& rows,
                  const Corner& corner);

/// Sets the derivatives by all shared parameters, with the pose of the image following them by
/// ImageEquations::pose_by_shared.
void setByShared(const SharedColumns& columns, std::size_t camera, const SeenBoard::Rows& rows,
                 const Corner& corner, const Eigen::Matrix<double, 6, Eigen::Dynamic>& pose_by_shared,
                 Eigen::Matrix<double, Eigen::Dynamic, 2>& by_shared);

/// The normal equations of one image: by all shared parameters, then by the unknowns of the board if requested, and
/// by the pose of the image, which is eliminated.
struct ImageEquations {
  Eigen::MatrixXd H;                                        ///< lower triangle; the pose last
  Eigen::Matrix<double, 6, Eigen::Dynamic> pose_by_shared;  ///< H_ff^-1 H_fs
  Matrix6 pose_inverse;                                     ///< H_ff^-1
};
ImageEquations equationsOf(const FittedRig& rig, const Observation& observation);
/// Returns the equations including the unknowns of the board, if it has any.
ImageEquations equationsWithBoard(const FittedRig& rig, const Observation& observation);

/// Derivatives of residual = R(left2world) left2imu^-1 (acc - bias) - gravity e_z.
struct ReadingJacobian {
  Eigen::Matrix<double, 3, 7> by_imu;
  Eigen::Matrix<double, 3, 6> by_pose;
};
ReadingJacobian differentiateReading(const FittedRig& rig, const Observation& observation);

/// The sums over images, or the share of one image.
class Information {
 public:
  explicit Information(const SharedColumns& columns);
  void add(const Information& images);
  /// Sets this to the sum of two disjoint sets of images of one rig.
  void setSum(const Information& a, const Information& b);
  /// Adds the prior Settings::sigma_denominator, if the result has it.
  void addPrior(const FittedRig& rig);
  /// Returns the covariance of the shared parameters; 0 for parameters that are not estimated.
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

/// The posterior given a set of images, ready to be propagated. Let a number change by a ds + e dm, with the shared
/// parameters and the motion of the frame. Its variance is |w|^2 with w = whitened(a, e). The covariance of two such
/// numbers is w1 . w2.
struct Posterior {
  explicit Posterior(const Information& information);
  /// Uses another covariance of all shared parameters, such as the clustered one. The part of the frame's motion that
  /// the poses of the images leave open stays as stated.
  Posterior(const Information& information, const Eigen::MatrixXd& covariance);
  /// Returns columns w for rows a (by all shared parameters) and e.
  Eigen::MatrixXd whitened(const Eigen::MatrixXd& by_shared, const Eigen::MatrixXd& by_motion) const;
  /// Returns the covariance of the shared parameters; 0 for parameters that are not estimated.
  Eigen::MatrixXd covarianceOfShared() const;

 private:
  friend class VarianceBound;
  /// Returns (sum of Lambda)^-1 times a vector over the free parameters.
  Eigen::VectorXd solve(const Eigen::VectorXd& by_free) const;

  std::vector<int> free_;
  int all_;
  Eigen::VectorXd
      scale_;  // units differ by orders of magnitude; with a unit diagonal the inverse keeps its digits
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::MatrixXd
      root_;  // for another covariance: root_ root_^T is the covariance of the free parameters; otherwise empty
  Eigen::Matrix<double, 6, Eigen::Dynamic> motion_by_shared_;  // G^-1 F
  Matrix6 noise_root_;                                         // its square is G^-1 N G^-1
};

/// Returns the observation of each image, by its number.
std::map<int, Observation> observationsOf(const Dataset& data, const FittedRig& rig);

}  // namespace slom::calibration
