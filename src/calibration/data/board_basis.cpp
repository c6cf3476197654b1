#include "calibration/data/board_basis.hpp"

#include <cmath>

#include <Eigen/QR>

namespace slom::calibration {
const char* toString(BoardShape shape) {
  return shape == BoardShape::flat ? "flat" : shape == BoardShape::bent ? "bent" : "free";
}

BoardBasis::BoardBasis(BoardShape shape, const Dataset& data) : shape_(shape) {
  for (const CameraData& camera : data.cameras) {
    for (const View& view : camera.views) {
      for (const Corner& corner : view.corners) add(corner);
    }
  }
  makeMaps();
}

BoardBasis::BoardBasis(BoardShape shape, const std::vector<Corner>& points) : shape_(shape) {
  for (const Corner& point : points) add(point);
  makeMaps();
}

void BoardBasis::add(const Corner& corner) {
  if (index_.emplace(keyOf(corner.world), points()).second) points_.push_back(corner);
}

int BoardBasis::find(const vec3& world) const {
  const auto at = index_.find(keyOf(world));
  return at == index_.end() ? -1 : at->second;
}

void BoardBasis::makeMaps() {
  plane_ = fitPlane(points_);
  maps_.assign(1, Eigen::Matrix3d::Identity());
  if (shape_ == BoardShape::free) return;
  constexpr double no_bend =
      1e-6;  // relative rest of a polynomial below which it is of first degree over the points
  Eigen::MatrixXd polynomials(points(), 6);
  for (int i = 0; i < points(); ++i) {
    const Eigen::Vector2d p = plane_.coordinates(points_[std::size_t(i)].world) / plane_.size;
    polynomials.row(i) << 1, p.x(), p.y(), p.x() * p.x(), p.x() * p.y(), p.y() * p.y();
  }
  // Gram and Schmidt, twice, so that the columns are orthogonal to the last digits.
  for (Eigen::Index k = 0; k < 6; ++k) {
    const double length = polynomials.col(k).norm();
    for (int round = 0; round < 2; ++round) {
      const auto before = polynomials.leftCols(k);
      polynomials.col(k) -= before * (before.transpose() * polynomials.col(k)).eval();
    }
    const double rest = polynomials.col(k).norm();
    polynomials.col(k) *= rest > no_bend * length ? 1 / rest : 0;
  }
  const Eigen::Vector3d normal = plane_.plane2world.orient.toRotationMatrix().col(2);
  maps_.clear();
  for (int i = 0; i < points(); ++i)
    maps_.push_back(normal * (std::sqrt(points()) * polynomials.row(i).tail<3>()));
}

std::vector<vec3> BoardBasis::unknownsOf(const std::vector<vec3>& displacements) const {
  std::vector<vec3> unknowns(std::size_t(blocks()), vec3(0., 0., 0.));
  const double points_of_block = double(points()) / blocks();
  for (int i = 0; i < points(); ++i)
    unknowns[std::size_t(block(i))] += map(i).transpose() * displacements[std::size_t(i)] / points_of_block;
  return unknowns;
}

}  // namespace slom::calibration
