// The unknowns of a board's shape: which of them move which corner, and how.
#pragma once

#include <map>
#include <vector>

#include "calibration/data/point_key.hpp"
#include "slom/calibration/board.hpp"
#include "slom/calibration/board_shape.hpp"
#include "slom/calibration/dataset.hpp"

namespace slom::calibration {

/// The distinct points of a board, and blocks of three unknowns s that displace them: point i by map(i) s of block(i) [m].
///   free   a block for each point, map = I
///   bent   one block; map = n f^T with the normal n and the three polynomials f of second degree in the plane that are orthogonal to each
///          other and to those of first degree over the points, root mean square 1: an unknown is the root mean square height of its bend
class BoardBasis {
 public:
  /// Of all points that the cameras see, in the order in which they see them.
  BoardBasis(BoardShape shape, const Dataset& data);
  /// Of these points, where Corner::world and Corner::number alone count.
  BoardBasis(BoardShape shape, const std::vector<Corner>& points);

  BoardShape shape() const { return shape_; }
  int points() const { return int(points_.size()); }
  const Corner& point(int i) const { return points_[std::size_t(i)]; }
  /// The point at these coordinates, or -1.
  int find(const vec3& world) const;
  /// The number of blocks of three unknowns.
  int blocks() const { return shape_ == BoardShape::free ? points() : 1; }
  int block(int point) const { return shape_ == BoardShape::free ? point : 0; }
  const Eigen::Matrix3d& map(int point) const {
    return maps_[shape_ == BoardShape::free ? 0 : std::size_t(point)];
  }
  /// The unknowns, block by block, that displace the points most nearly so.
  std::vector<vec3> unknownsOf(const std::vector<vec3>& displacements) const;
  const BoardPlane& plane() const { return plane_; }

 private:
  void add(const Corner& corner);
  void makeMaps();

  BoardShape shape_;
  std::vector<Corner> points_;
  std::map<PointKey, int> index_;
  BoardPlane plane_;
  std::vector<Eigen::Matrix3d> maps_;
};

}  // namespace slom::calibration
