#include "calibration/streams/determined.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <slom/slom.hpp>

#include "calibration/fit/rig.hpp"
#include "calibration/rotation_vector.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

/// Removes all standard deviations.
void forgetDeviations(StreamResult& result) {
  result.gravity_direction_std = result.gravity_direction_clustered = unknown;
  const vec3 none(unknown, unknown, unknown);
  for (CameraStreamResult& camera : result.cameras) {
    camera.translation_std = camera.translation_clustered = none;
    camera.rotation_std = camera.rotation_clustered = none;
    for (std::optional<StreamNumber>* number : {&camera.time_offset, &camera.line_delay}) {
      if (*number) (*number)->std = (*number)->std_clustered = unknown;
    }
  }
  for (ImuStreamResult& imu : result.imus) {
    imu.translation_std = imu.translation_clustered = imu.rotation_std = imu.rotation_clustered = none;
    imu.rotation_vector_std = imu.rotation_vector_clustered = none;
    imu.time_offset_std = imu.time_offset_clustered = unknown;
    imu.gyro_bias_std = imu.gyro_bias_clustered = imu.force_bias_std = imu.force_bias_clustered = none;
    for (double& std : imu.axes.std) std = unknown;
    for (double& std : imu.axes.std_clustered) std = unknown;
  }
}

}  // namespace

std::string openDirectionOf(const std::string& name, const Eigen::MatrixXd& covariance) {
  constexpr double most = 0.1;  // m and rad: what a ruler finds
  const auto sentence = [&](const char* what, int first, double unit, const char* unit_name,
                            const char* frame) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance.block<3, 3>(first, first));
    const double std = std::sqrt(std::max(0., axes.eigenvalues()[2]));
    if (std < most) return std::string();
    Eigen::Vector3d axis = axes.eigenvectors().col(2);
    if (axis.sum() < 0) axis = -axis;
    return fmt::format(
        "{} of {} {} ({:.2f}, {:.2f}, {:.2f}) in the axes of {} is known to {:.2g} {} only; turn the rig about all axes, "
        "quickly",
        what, name, first == 0 ? "along" : "about", axis[0], axis[1], axis[2], frame, std * unit, unit_name);
  };
  const std::string place = sentence("the position", 0, 1, "m", "the IMU");
  return place.empty() ? sentence("the orientation", 3, 180 / std::numbers::pi, "deg", "the reference camera")
                       : place;
}

std::string openTimingOf(const CameraStreamResult& camera) {
  constexpr double most_offset = 0.01, most_line_delay = 1e-4;  // s: of what a slow motion says nothing
  if (camera.time_offset && !(camera.time_offset->std < most_offset))
    return fmt::format("the time offset of {} is known to {:.2g} ms only; turn the rig quickly", camera.name,
                       1000 * camera.time_offset->std);
  if (camera.line_delay && !(camera.line_delay->std < most_line_delay))
    return fmt::format("the line delay of {} is known to {:.2g} us only; turn the rig quickly", camera.name,
                       1e6 * camera.line_delay->std);
  return "";
}

void setPoseDeviations(const Eigen::MatrixXd& covariance, ImuStreamResult& imu) {
  imu.translation_std = vec3(covariance.diagonal().head<3>().cwiseSqrt());
  imu.rotation_std = vec3(covariance.diagonal().tail<3>().cwiseSqrt());
  imu.rotation_vector_std = rotationVectorStd(imu.left2imu.orient, covariance.bottomRightCorner<3, 3>());
}

void setClusteredDeviations(const Eigen::MatrixXd& covariance, ImuStreamResult& imu) {
  imu.translation_clustered = vec3(covariance.diagonal().head<3>().cwiseSqrt());
  imu.rotation_clustered = vec3(covariance.diagonal().tail<3>().cwiseSqrt());
  imu.rotation_vector_clustered =
      rotationVectorStd(imu.left2imu.orient, covariance.bottomRightCorner<3, 3>());
}

StreamResult endOf(const Summary& summary) {
  StreamResult result;
  result.converged = summary.converged;
  result.stop_reason = toString(summary.stop_reason);
  result.message = summary.message;
  result.iterations = summary.iterations;
  result.unknowns = std::size_t(summary.unknowns);
  result.measurements = std::size_t(summary.measurements);
  return result;
}

void addDeviations(const std::function<void()>& stated, const std::function<void()>& clustered,
                   StreamResult& result) {
  try {
    stated();
    if (result.success()) clustered();
  } catch (const slom::Error& error) {
    result.undetermined = sentenceOf(error);
  }
  if (result.success()) return;
  forgetDeviations(result);
  result.notes.clear();
  result.doubts.clear();
}

}  // namespace slom::calibration
