#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include "calibration/initialization/right_singular.hpp"
#include "slom/calibration/board.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

/// Returns the similarity that moves the points to mean 0 and root mean square radius sqrt(2).
Eigen::Matrix3d normalisation(const std::vector<vec2>& points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const vec2& p : points) mean += p / double(points.size());
  double square = 0;
  for (const vec2& p : points) square += (p - mean).squaredNorm() / double(points.size());
  const double scale = std::sqrt(2 / square);
  return (Eigen::Matrix3d() << scale, 0, -scale * mean.x(), 0, scale, -scale * mean.y(), 0, 0, 1).finished();
}

}  // namespace

Eigen::Matrix3d findHomography(const std::vector<vec2>& board, const std::vector<vec2>& pixels) {
  if (board.size() != pixels.size() || board.size() < 4) {
    throw DataError(
        "slom.calibration.bad-view",
        fmt::format("a homography cannot be found from points: {} of the board, and {} of the image; "
                    "pass as many of both, and at least 4",
                    board.size(), pixels.size()),
        "pixels");
  }
  const Eigen::Matrix3d from_board = normalisation(board), from_pixels = normalisation(pixels);
  Eigen::MatrixXd A(2 * std::max<std::size_t>(board.size(), 5),
                    9);  // a zero row, so that 4 pairs give 9 directions
  A.setZero();
  for (std::size_t i = 0; i < board.size(); ++i) {
    const Eigen::RowVector3d p = (from_board * board[i].homogeneous()).transpose();
    const Eigen::Vector3d q = from_pixels * pixels[i].homogeneous();
    A.row(2 * i) << p, Eigen::RowVector3d::Zero(), -q.x() * p;
    A.row(2 * i + 1) << Eigen::RowVector3d::Zero(), p, -q.y() * p;
  }
  Eigen::Matrix3d H = rightSingular(A).vectors.col(8).reshaped<Eigen::RowMajor>(3, 3);
  H = from_pixels.inverse() * H * from_board;
  H /= H.norm();
  double depth = 0;
  for (const vec2& p : board) depth += H.row(2).dot(p.homogeneous());
  return depth < 0 ? Eigen::Matrix3d(-H) : H;
}

}  // namespace slom::calibration
