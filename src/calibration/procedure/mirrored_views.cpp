#include "calibration/procedure/mirrored_views.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

#include "calibration/data/check.hpp"
#include "calibration/data/rejected.hpp"
#include "calibration/procedure/scaled_views.hpp"

namespace slom::calibration {
namespace {

constexpr const char* mirrored_why =
    "the board is mirrored, because u and v are exchanged or corners are numbered from a mirrored corner";

/// Returns the views of a camera that are certainly mirrored.
std::vector<Stray> mirroredViewsOf(const CameraData& camera, const BoardPlane& plane) {
  constexpr std::size_t fewest = 3;
  std::vector<const View*> right, left;
  for (const View& view : camera.views) {
    const Handedness handedness = handednessOf(view, plane);
    if (handedness == Handedness::right) right.push_back(&view);
    if (handedness == Handedness::left) left.push_back(&view);
  }
  const std::vector<const View*>& few = right.size() < left.size() ? right : left;
  const std::size_t all = right.size() + left.size();
  if (all < fewest || 3 * (all - few.size()) <= 2 * all) return {};
  std::vector<Stray> mirrored;
  for (const View* const view : few) {
    Stray stray{.camera = camera.name, .image = view->image, .photo = view->photo, .is_left_out = true};
    stray.why = mirrored_why;
    stray.is_mirrored = true;
    mirrored.push_back(std::move(stray));
  }
  return mirrored;
}

}  // namespace

Handedness handednessOf(const View& view, const BoardPlane& plane) {
  constexpr std::size_t fewest_corners = 6;
  constexpr double most_off_plane = 0.05;  // relative to the size of the board
  constexpr double least_width =
      0.1;  // of the board in the image, relative to its length; holds for tilts below 84 degrees
  constexpr double least_over_misfit = 2;  // width over the RMS distance from the affine map
  const auto n = Eigen::Index(view.corners.size());
  if (view.corners.size() < fewest_corners) return Handedness::unclear;
  Eigen::MatrixXd board(n, 2), pixels(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Corner& corner = view.corners[std::size_t(i)];
    const vec3 there(plane.plane2world.inverse() * corner.world);
    if (std::abs(there.z()) > most_off_plane * plane.size) return Handedness::unclear;
    board.row(i) << there.x(), there.y();
    pixels.row(i) = corner.pixel.transpose();
  }
  board.rowwise() -= board.colwise().mean().eval();
  pixels.rowwise() -= pixels.colwise().mean().eval();
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(board);
  if (qr.rank() < 2) return Handedness::unclear;
  const Eigen::Matrix2d affine = qr.solve(pixels);
  const Eigen::MatrixXd mapped = board * affine;
  const double misfit = (pixels - mapped).norm();
  const Eigen::Vector2d spread =
      Eigen::JacobiSVD<Eigen::MatrixXd>(mapped, Eigen::ComputeThinU | Eigen::ComputeThinV).singularValues();
  const Eigen::Vector2d scales = Eigen::JacobiSVD<Eigen::Matrix2d>(affine).singularValues();
  const bool is_clear = scales[1] > least_width * scales[0] && spread[1] > least_over_misfit * misfit;
  if (!is_clear) return Handedness::unclear;
  return affine.determinant() > 0 ? Handedness::right : Handedness::left;
}

std::vector<Stray> mirroredViews(const Dataset& data) {
  constexpr double flat = 0.02;  // thickness over size
  if (data.cameras.empty()) return {};
  const View& fullest = fullestView(data);
  if (fullest.corners.size() < 3) return {};
  const BoardPlane plane = fitPlane(fullest.corners);
  if (!(plane.thickness < flat * plane.size)) return {};
  std::vector<Stray> mirrored;
  for (const CameraData& camera : data.cameras) {
    for (Stray& stray : mirroredViewsOf(camera, plane)) mirrored.push_back(std::move(stray));
  }
  if (!mirrored.empty() && !isStillConnected(withoutViews(data, mirrored))) return {};
  return mirrored;
}

void addMirroredViews(std::vector<Stray> mirrored, const Dataset& data, Result& result) {
  for (Stray& stray : mirrored) {
    const std::size_t c = indexOf(result, stray.camera);
    stray.error_px =
        result.success() ? rmsOfBestPose(result, c, *data.cameras[c].find(stray.image), 1) : unknown;
    result.strays.push_back(std::move(stray));
  }
  std::stable_sort(result.strays.begin(), result.strays.end(),
                   [](const Stray& a, const Stray& b) { return a.image < b.image; });
}

}  // namespace slom::calibration
