// Measurements of corners whose positions on the board are unknowns of the fit.
#pragma once

#include "calibration/data/board_basis.hpp"
#include "calibration/fit/measurements.hpp"

namespace slom::calibration {

/// One corner: predicted pixel minus measured pixel [px]. `shape` is the block of unknowns that displaces the corner.
/// Corner and basis must outlive this object.
class CornerOfShape {
 public:
  CornerOfShape(const Corner& corner, const BoardBasis& basis)
      : corner_(&corner), map_(&basis.map(basis.find(corner.world))) {}

  vec2 operator()(const Lens& camera, const SE3& left2camera, const SE3& left2world,
                  const vec3& shape) const {
    const vec3 in_left = left2world.inverse() * at(shape);
    return vec2(camera.project(left2camera * in_left) - corner_->pixel);
  }
  /// Returns the derivative by the readout of the camera.
  const vec2& byReadout() const { return corner_->by_readout; }

 protected:
  void differentiated(const Lens& camera, const SE3& left2camera, const SE3& left2world, const vec3& shape,
                      auto by_camera, auto by_left2camera, auto by_left2world, auto& by_shape) const {
    const SeenBoard::Rows rows = SeenBoard(camera, left2camera, left2world).rowsOf(at(shape));
    *by_camera = rows.seen.by_parameters;
    if constexpr (!std::is_null_pointer_v<decltype(by_left2camera)>) *by_left2camera = rows.byLeft2Camera();
    *by_left2world = rows.byLeft2World();
    by_shape = rows.by_point * *map_;
  }

 private:
  vec3 at(const vec3& shape) const { return vec3(corner_->world + *map_ * shape); }

  const Corner* corner_;
  const Eigen::Matrix3d* map_;
};

/// A corner seen by the reference camera.
struct CornerOfShapeInLeft : CornerOfShape {
  using CornerOfShape::CornerOfShape;
  vec2 operator()(const Lens& camera, const SE3& left2world, const vec3& shape) const {
    return CornerOfShape::operator()(camera, SE3(), left2world, shape);
  }
  void jacobian(const Lens& camera, const SE3& left2world, const vec3& shape, auto& by_camera,
                auto& by_left2world, auto& by_shape) const {
    differentiated(camera, SE3(), left2world, shape, &by_camera, nullptr, &by_left2world, by_shape);
  }
};

/// A corner seen by another camera.
struct CornerOfShapeInOther : CornerOfShape {
  using CornerOfShape::CornerOfShape;
  void jacobian(const Lens& camera, const SE3& left2camera, const SE3& left2world, const vec3& shape,
                auto& by_camera, auto& by_left2camera, auto& by_left2world, auto& by_shape) const {
    differentiated(camera, left2camera, left2world, shape, &by_camera, &by_left2camera, &by_left2world,
                   by_shape);
  }
};

}  // namespace slom::calibration
