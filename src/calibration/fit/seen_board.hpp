// The chain from a point of the board to its pixel, with its derivatives: by lens, pose of the camera and pose of the rig.
#pragma once

#include "calibration/cross_matrix.hpp"
#include "calibration/models/lens.hpp"
#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// Projects points of the board into a camera, in one image. Rotations are perturbed on the right, and translation comes
/// before rotation.
class SeenBoard {
 public:
  /// Takes the lens, which must outlive this object.
  SeenBoard(const Lens& lens, const SE3& left2camera, const SE3& left2world)
      : lens_(lens),
        left2camera_(left2camera.orient.toRotationMatrix()),
        world2left_(left2world.orient.toRotationMatrix().transpose()),
        offset_(left2camera.pos),
        origin_(left2world.pos) {}

  /// The pixel of a point and its derivatives [px].
  struct Rows {
    Lens::Projection seen;                          ///< also by the lens parameters
    Eigen::Matrix<double, 2, 3> by_point, by_turn;  ///< by the point in the world; by a turn of left2world

    vec2 pixel() const { return seen.pixel; }
    Eigen::Matrix<double, 2, 6> byLeft2Camera() const {
      return (Eigen::Matrix<double, 2, 6>() << seen.by_point, -by_turn).finished();
    }
    Eigen::Matrix<double, 2, 6> byLeft2World() const {
      return (Eigen::Matrix<double, 2, 6>() << -by_point, by_turn).finished();
    }
  };
  Rows rowsOf(const Eigen::Vector3d& world) const {
    const Eigen::Vector3d in_left = world2left_ * (world - origin_);
    Rows rows{lens_.differentiate(left2camera_ * in_left + offset_), {}, {}};
    const Eigen::Matrix<double, 2, 3> by_left = rows.seen.by_point * left2camera_;
    rows.by_turn = by_left * crossMatrix(in_left);
    rows.by_point = by_left * world2left_;
    return rows;
  }

 private:
  const Lens& lens_;
  Eigen::Matrix3d left2camera_, world2left_;
  Eigen::Vector3d offset_, origin_;
};

}  // namespace slom::calibration
