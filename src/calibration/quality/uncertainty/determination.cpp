#include "calibration/quality/uncertainty/determination.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <Eigen/Geometry>

#include "slom/calibration/board.hpp"

namespace slom::calibration {

AxisUncertainty axisUncertainty(const Lens& lens, const Eigen::MatrixXd& covariance) {
  constexpr double small = 1e-3;  // [rad]
  const auto stdOf = [&](const Eigen::RowVectorXd& by_parameters) {
    return std::sqrt(std::max(0.0, (by_parameters * covariance * by_parameters.transpose()).value()));
  };
  const Lens::Projection axis = lens.differentiate(vec3(0., 0., 1.));
  AxisUncertainty result{0, 0};
  for (int i = 0; i < 2; ++i) {
    const double x = i == 0 ? std::sin(small) : 0, y = i == 0 ? 0 : std::sin(small);
    const Lens::Projection plus = lens.differentiate(vec3(x, y, std::cos(small))),
                           minus = lens.differentiate(vec3(-x, -y, std::cos(small)));
    const double scale = plus.pixel[i] - minus.pixel[i];
    const Eigen::RowVectorXd by_parameters = plus.by_parameters.row(i) - minus.by_parameters.row(i);
    result.focal = std::max(result.focal, stdOf(by_parameters) / std::abs(scale));
    result.centre_px = std::max(result.centre_px, stdOf(axis.by_parameters.row(i)));
  }
  return result;
}

double tiltSpreadOf(const Dataset& data, const Result& result, std::size_t c) {
  std::map<int, SE3> left2world;
  for (const ImageResult& image : result.images) left2world.emplace(image.image, image.left2world);
  std::vector<Eigen::Vector3d> normals;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const View& view : data.cameras[c].views) {
    const BoardPlane plane = fitPlane(view.corners);
    const SE3 plane2camera =
        result.cameras[c].left2camera * left2world.at(view.image).inverse() * plane.plane2world;
    const Eigen::Vector3d normal = plane2camera.orient * vec3(0., 0., 1.);
    normals.push_back(normal.dot(plane2camera.pos) < 0 ? Eigen::Vector3d(-normal) : normal);
    mean += normals.back();
  }
  double largest = 0;
  for (const Eigen::Vector3d& normal : normals)
    largest = std::max(largest, std::atan2(normal.cross(mean).norm(), normal.dot(mean)));
  return largest;
}

}  // namespace slom::calibration
