#include "calibration/streams/splines/condensed_view.hpp"

#include <algorithm>
#include <utility>

#include <Eigen/QR>

#include "calibration/fit/seen_board.hpp"

namespace slom::calibration {
namespace {

/// Returns the upper triangle of a QR factorisation, with as many rows as columns; the last ones are 0 if A has fewer
/// rows.
Eigen::MatrixXd triangleOf(const Eigen::MatrixXd& A) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(A);
  const Eigen::Index rows = std::min(A.rows(), A.cols());
  Eigen::MatrixXd R = Eigen::MatrixXd::Zero(A.cols(), A.cols());
  R.topRows(rows) = qr.matrixQR().topRows(rows).triangularView<Eigen::Upper>();
  return R;
}

/// Condenses corners. `rows_of(i)` returns the rows of corner i, and its derivatives by `left2world`.
CondensedView condensedBy(const std::vector<Corner>& corners, const Lens& lens, const SE3& left2camera,
                          const SE3& left2world, LensRows& lens_rows, const auto& rows_of) {
  const Eigen::Index n = lens.parameters(), columns = 6 + n + 1;
  Eigen::MatrixXd A(2 * Eigen::Index(corners.size()), columns);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Corner& corner = corners[i];
    const auto [rows, by_left2world] = rows_of(i);
    auto row = A.middleRows<2>(2 * Eigen::Index(i));
    row << by_left2world, rows.seen.by_parameters, rows.pixel() - corner.pixel;
    row /= corner.sigma;
  }
  const Eigen::MatrixXd R = triangleOf(A);
  lens_rows.add(R.bottomRightCorner(n + 1, n + 1).topRows(n));
  CondensedView result{left2world,
                       left2camera,
                       lens,
                       R.topLeftCorner<6, 6>(),
                       {},
                       R.block(0, 6, 6, n),
                       R.block<6, 1>(0, 6 + n)};
  // A point moves in the camera alike if the camera moves back on the rig.
  const Eigen::Matrix3d camera2world = (left2world.orient * left2camera.orient.inverse()).toRotationMatrix();
  result.by_left2camera << -result.by_left2world.leftCols<3>() * camera2world,
      -result.by_left2world.rightCols<3>();
  return result;
}

using RowsByPose = std::pair<SeenBoard::Rows, Eigen::Matrix<double, 2, 6>>;

}  // namespace

LensRows::LensRows(const Lens& lens)
    : lens_(lens), rows_(Eigen::MatrixXd::Zero(lens.size(), lens.size() + 1)) {}

void LensRows::add(const Eigen::MatrixXd& rows) {
  Eigen::MatrixXd all(rows_.rows() + rows.rows(), rows_.cols());
  all << rows_, rows;
  rows_ = triangleOf(all).topRows(rows_.rows());
}

CondensedView condensed(const View& view, const Lens& lens, const SE3& left2camera, const SE3& left2world,
                        LensRows& lens_rows) {
  const SeenBoard board(lens, left2camera, left2world);
  return condensedBy(view.corners, lens, left2camera, left2world, lens_rows, [&](std::size_t i) {
    const SeenBoard::Rows rows = board.rowsOf(view.corners[i].world);
    return RowsByPose(rows, rows.byLeft2World());
  });
}

CondensedView condensed(const std::vector<Corner>& corners, const Lens& lens, const SE3& left2camera,
                        const SE3& left2world, const std::vector<SE3>& poses, LensRows& lens_rows) {
  return condensedBy(corners, lens, left2camera, left2world, lens_rows, [&](std::size_t i) {
    const SeenBoard::Rows rows = SeenBoard(lens, left2camera, poses[i]).rowsOf(corners[i].world);
    Eigen::Matrix<double, 2, 6> by_pose = rows.byLeft2World();
    // A turn of the rig at the time of the view, seen in the axes of the rig at the time of the corner.
    by_pose.rightCols<3>() *= (poses[i].orient.inverse() * left2world.orient).toRotationMatrix();
    return RowsByPose(rows, by_pose);
  });
}

}  // namespace slom::calibration
