// The unknowns of a board's shape: which unknown moves which corner, and how.
#pragma once

#include <map>
#include <vector>

#include "calibration/data/point_key.hpp"
#include "slom/calibration/board.hpp"
#include "slom/calibration/board_shape.hpp"
#include "slom/calibration/dataset.hpp"

namespace slom::calibration {

/// The distinct points of a board, and blocks of three unknowns s that displace them: map(i) s of block(i) displaces
/// point i [m].
///   free   one block for each point, map = I
///   bent   one block for all points; map = n f^T with the normal n and three polynomials f of second degree in the
///          plane. Over the points, the f are orthogonal to each other and to polynomials of first degree, and have
///          root mean square 1. So each unknown is the root mean square height of its bend.
class BoardBasis {
 public:
  /// Takes all points that the cameras see, in the order in which they see them.
  BoardBasis(BoardShape shape, const Dataset& data);
  /// Takes these points. Only Corner::world and Corner::number are used.
  BoardBasis(BoardShape shape, const std::vector<Corner>& points);

  BoardShape shape() const { return shape_; }
  int points() const { return int(points_.size()); }
  const Corner& point(int i) const { return points_[std::size_t(i)]; }
  /// Returns the index of the point at these coordinates, or -1.
  int find(const vec3& world) const;
  /// Returns the number of blocks of three unknowns.
  int blocks() const { return shape_ == BoardShape::free ? points() : 1; }
  int block(int point) const { return shape_ == BoardShape::free ? point : 0; }
  const Eigen::Matrix3d& map(int point) const {
    return maps_[shape_ == BoardShape::free ? 0 : std::size_t(point)];
  }
  /// Returns the unknowns, block by block, whose displacements of the points are nearest to these.
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
