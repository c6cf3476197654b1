// The corners of one image of a camera, condensed into a few rows: by the pose of the rig, the lens, and the camera on the
// rig.
//   rows     R (x [-] x_0) + q, with x = (left2world, lens, left2camera) and x_0 their values now; in units of sigma_px
//   source   QR factorisation of the derivatives of all corners: the squares of the rows and those of the corners
//            differ by a constant, to first order of x - x_0
// After each fit, the corners are condensed again at the new values, until these stay the same. Then the rows are exact.
#pragma once

#include <vector>

#include "calibration/models/lens.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// 6 rows on the pose of the rig. Translation comes before rotation, and rotations are perturbed on the right.
struct CondensedView {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;

  SE3 left2world, left2camera;  ///< x_0
  Eigen::VectorXd lens;         ///< x_0
  Matrix6 by_left2world, by_left2camera;
  Eigen::MatrixXd by_lens;  ///< 6 x n
  Vector6 rest;             ///< q
};

/// Rows on a lens alone: what is left of the corners of many views after their rows on poses.
class LensRows {
 public:
  explicit LensRows(const Lens& lens);
  /// Adds rows: derivatives by the lens, and values in the last column.
  void add(const Eigen::MatrixXd& rows);

  const Eigen::VectorXd& lens() const { return lens_; }                        ///< x_0
  Eigen::MatrixXd byLens() const { return rows_.leftCols(rows_.cols() - 1); }  ///< R
  Eigen::VectorXd rest() const { return rows_.col(rows_.cols() - 1); }         ///< q

 private:
  Eigen::VectorXd lens_;
  Eigen::MatrixXd rows_;
};

/// Condenses the corners of a view. Adds the rows that do not depend on the pose to `lens_rows`.
CondensedView condensed(const View& view, const Lens& lens, const SE3& left2camera, const SE3& left2world,
                        LensRows& lens_rows);
/// Condenses corners that are seen one after another, near a time with the pose `left2world`. `poses`: of the rig when
/// each corner is seen; by how much they differ from `left2world` stays as it is.
CondensedView condensed(const std::vector<Corner>& corners, const Lens& lens, const SE3& left2camera,
                        const SE3& left2world, const std::vector<SE3>& poses, LensRows& lens_rows);

}  // namespace slom::calibration
