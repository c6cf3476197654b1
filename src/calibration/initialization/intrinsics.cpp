#include "calibration/initialization/intrinsics.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "calibration/initialization/right_singular.hpp"
#include "calibration/initialization/view_pose.hpp"

namespace slom::calibration {
namespace {

/// Shifts and scales pixels so that the numbers of the conic have similar size: normalised = scale * (pixel -
/// centre).
struct PixelScale {
  Eigen::Vector2d centre;
  double scale;

  Eigen::Matrix3d matrix() const {
    return (Eigen::Matrix3d() << scale, 0, -scale * centre.x(), 0, scale, -scale * centre.y(), 0, 0, 1)
        .finished();
  }
  Pinhole undo(const Pinhole& p) const {
    return {p.fx / scale, p.fy / scale, p.cx / scale + centre.x(), p.cy / scale + centre.y()};
  }
};

/// Returns the scale around the pixels where the homographies put the centres of their boards.
PixelScale pixelScale(const std::vector<Eigen::Matrix3d>& homographies,
                      const Eigen::Vector2d* centre = nullptr) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& H : homographies) mean += H.col(2).hnormalized() / double(homographies.size());
  if (centre) mean = *centre;
  double square = 0;
  for (const auto& H : homographies)
    square += (H.col(2).hnormalized() - mean).squaredNorm() / double(homographies.size());
  return {mean, 1 / std::max(100.0, std::sqrt(square))};
}

/// Returns the row of coefficients of (B11, B22, B13, B23, B33) in h_i^T B h_j, B = K^-T K^-1 without skew.
Eigen::Matrix<double, 1, 5> conicRow(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return {a[0] * b[0], a[1] * b[1], a[0] * b[2] + a[2] * b[0], a[1] * b[2] + a[2] * b[1], a[2] * b[2]};
}

/// Returns the homography to normalised pixels, with columns 0 and 1 of about unit length.
Eigen::Matrix3d normalised(const PixelScale& scale, const Eigen::Matrix3d& H) {
  Eigen::Matrix3d N = scale.matrix() * H;
  return N / std::sqrt(N.col(0).norm() * N.col(1).norm());
}

/// Returns whether p is a realistic camera, for corners within `low` and `high`.
bool plausible(const Pinhole& p, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  const Eigen::Vector2d size = high - low;
  const double extent = size.maxCoeff();
  return std::isfinite(p.fx + p.fy + p.cx + p.cy) && p.fx > 0.05 * extent && p.fx < 200 * extent &&
         p.fy / p.fx > 0.2 && p.fy / p.fx < 5 && p.cx > low.x() - extent && p.cx < high.x() + extent &&
         p.cy > low.y() - extent && p.cy < high.y() + extent;
}

double squaredErrorOfAll(const std::vector<PlaneView>& views, const Pinhole& camera) {
  double sum = 0;
  for (const PlaneView& view : views)
    sum += squaredPixelError(view, camera, poseFromHomography(view, camera));
  return sum;
}

}  // namespace

std::optional<Pinhole> zhang(const std::vector<Eigen::Matrix3d>& homographies) {
  const PixelScale scale = pixelScale(homographies);
  Eigen::MatrixXd V(std::max<std::size_t>(2 * homographies.size(), 5), 5);
  V.setZero();
  for (std::size_t i = 0; i < homographies.size(); ++i) {
    const Eigen::Matrix3d N = normalised(scale, homographies[i]);
    V.row(2 * i) = conicRow(N.col(0), N.col(1));
    V.row(2 * i + 1) = conicRow(N.col(0), N.col(0)) - conicRow(N.col(1), N.col(1));
  }
  const RightSingular svd = rightSingular(V);
  if (!(svd.values[3] > 1e-9 * svd.values[0])) return {};
  const Eigen::VectorXd b = svd.vectors.col(4);  // B11 B22 B13 B23 B33
  const double lambda = b[4] - b[2] * b[2] / b[0] - b[3] * b[3] / b[1];
  if (!(lambda / b[0] > 0) || !(lambda / b[1] > 0)) return {};
  return scale.undo({std::sqrt(lambda / b[0]), std::sqrt(lambda / b[1]), -b[2] / b[0], -b[3] / b[1]});
}

std::optional<Pinhole> zhangFocalLength(const std::vector<Eigen::Matrix3d>& homographies,
                                        const vec2& centre) {
  const Eigen::Vector2d at = centre;
  const PixelScale scale = pixelScale(homographies, &at);
  double numerator = 0, denominator = 0;  // least squares of p w + q = 0, w = 1 / f^2
  const auto add = [&](double p, double q) { numerator -= p * q, denominator += p * p; };
  for (const Eigen::Matrix3d& H : homographies) {
    const Eigen::Matrix3d N = normalised(scale, H);
    const Eigen::Vector3d a = N.col(0), b = N.col(1);
    add(a.head<2>().dot(b.head<2>()), a[2] * b[2]);
    add(a.head<2>().squaredNorm() - b.head<2>().squaredNorm(), a[2] * a[2] - b[2] * b[2]);
  }
  const double w = numerator / denominator;
  if (!(w > 0) || !std::isfinite(w)) return {};
  const double f = 1 / std::sqrt(w);
  return scale.undo({f, f, 0, 0});
}

IntrinsicsStart startIntrinsics(const std::vector<PlaneView>& views) {
  std::vector<Eigen::Matrix3d> homographies;
  Eigen::Vector2d low = views.front().pixels.front(), high = low;
  for (const PlaneView& view : views) {
    homographies.push_back(view.homography);
    for (const vec2& pixel : view.pixels) low = low.cwiseMin(pixel), high = high.cwiseMax(pixel);
  }
  const vec2 centre((low + high) / 2);
  const double extent = (high - low).maxCoeff();
  const char* guess = "a guess, centre amid the corners";
  IntrinsicsStart best{{extent, extent, centre.x(), centre.y()}, guess};
  double best_error = std::numeric_limits<double>::infinity();
  const auto propose = [&](const std::optional<Pinhole>& p, const char* source) {
    if (!p || !plausible(*p, low, high)) return;
    const double error = squaredErrorOfAll(views, *p);
    if (error < best_error) best = {*p, source}, best_error = error;
  };
  propose(zhang(homographies), "Zhang's closed form");
  propose(zhangFocalLength(homographies, centre), "f in closed form, centre amid the corners");
  for (double f = 0.25 * extent; f < 20 * extent; f *= 1.3) {
    propose(Pinhole{f, f, centre.x(), centre.y()}, guess);
  }
  return best;
}

}  // namespace slom::calibration
