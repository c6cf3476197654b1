#include "calibration/initialization/parallel_views.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

namespace slom::calibration {

namespace {
constexpr double degree = std::numbers::pi / 180;
constexpr double hardly_tilted = 2 * degree;
}  // namespace

double normalSpread(const std::vector<PlaneView>& views) {
  vec2 low = views.front().pixels.front(), high = low;
  for (const PlaneView& view : views) {
    for (const vec2& pixel : view.pixels) low = low.cwiseMin(pixel), high = high.cwiseMax(pixel);
  }
  const double extent = (high - low).maxCoeff();
  const vec2 centre((low + high) / 2);
  Eigen::Matrix3d K;
  K << extent, 0, centre.x(), 0, extent, centre.y(), 0, 0, 1;
  std::vector<Eigen::Vector3d> normals;
  for (const PlaneView& view : views) {
    const Eigen::Matrix3d H = K.inverse() * view.homography;
    const Eigen::Vector3d line = H.inverse().transpose().col(2).normalized();  // vanishing line of the board
    normals.push_back(line.dot(H.col(2)) *
                      line);  // H.col(2) is a point of the board, so that all normals point to one side
    normals.back().normalize();
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& normal : normals) mean += normal;
  double largest = 0;
  for (const Eigen::Vector3d& normal : normals)
    largest = std::max(largest, std::atan2(normal.cross(mean).norm(), normal.dot(mean)));
  return largest;
}

std::string parallelViews(const std::vector<std::vector<PlaneView>>& views, std::size_t images) {
  double largest = 0;
  for (const auto& of_camera : views) largest = std::max(largest, normalSpread(of_camera));
  if (largest > hardly_tilted) return "";
  return fmt::format(
      "all {} images show the board at the same tilt, within {:.2g} degrees, which leaves the focal length open",
      images, std::max(0.1, largest / degree));
}

}  // namespace slom::calibration
