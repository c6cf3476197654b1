#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "slom/calibration/error.hpp"
#include "slom/calibration/stream_agreement.hpp"

namespace slom::calibration {
namespace {

constexpr double most_deviations = 3;

/// Returns the largest; NaN if one is unknown.
double largestOf(std::initializer_list<double> stds) {
  double largest = 0;
  for (const double std : stds) {
    if (!(std <= largest)) largest = std;
    if (std::isnan(std)) return unknown;
  }
  return largest;
}

vec3 largestOf(const vec3& a, const vec3& b, const vec3& c, const vec3& d) {
  vec3 largest;
  for (int i = 0; i < 3; ++i) largest[i] = largestOf({a[i], b[i], c[i], d[i]});
  return largest;
}

/// Returns the numbers of a model in the order of ImuAxesResult::std.
std::vector<double> numbersOfAxes(const ImuModel<>& model) {
  std::vector<double> all;
  const auto append = [&](const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
  append(model.force_axes), append(model.gyro_axes), append(model.gyro_by_force), append(model.force_places);
  return all;
}

/// Returns the names of these numbers: accelerometer.xx, ...
std::vector<std::string> namesOfAxes() {
  std::vector<std::string> names;
  const auto add = [&](const char* of, int row, int column) {
    names.push_back(fmt::format("{}.{}{}", of, "xyz"[row], "xyz"[column]));
  };
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column <= row; ++column) add("accelerometer", row, column);
  }
  for (const char* const of : {"gyroscope", "gyroscope_by_force"}) {
    for (int i = 0; i < 9; ++i) add(of, i / 3, i % 3);
  }
  for (int i = 0; i < 6; ++i) add("accelerometer_place", 1 + i / 3, i % 3);
  return names;
}

void addAxes(const ImuAxesResult& a, const ImuAxesResult& b, ImuAgreement& one) {
  if (a.estimated != b.estimated) return;
  const std::vector<double> first = numbersOfAxes(a.model), second = numbersOfAxes(b.model);
  const auto stdOf = [](const std::vector<double>& stds, std::size_t i) {
    return i < stds.size() ? stds[i] : unknown;
  };
  for (std::size_t i = 0; i < std::max(a.std.size(), b.std.size()); ++i) {
    one.axes.push_back(second[i] - first[i]);
    one.axes_std.push_back(
        largestOf({stdOf(a.std, i), stdOf(a.std_clustered, i), stdOf(b.std, i), stdOf(b.std_clustered, i)}));
  }
}

ImuAgreement agreementOf(const ImuStreamResult& a, const ImuStreamResult& b) {
  ImuAgreement one;
  one.name = a.name;
  one.translation = vec3(b.left2imu.pos - a.left2imu.pos);
  one.translation_std =
      largestOf(a.translation_std, a.translation_clustered, b.translation_std, b.translation_clustered);
  one.rotation = SO3::log(a.left2imu.orient.inverse() * b.left2imu.orient);
  one.rotation_std = largestOf(a.rotation_std, a.rotation_clustered, b.rotation_std, b.rotation_clustered);
  one.time_offset = b.time_offset - a.time_offset;
  one.time_offset_std =
      largestOf({a.time_offset_std, a.time_offset_clustered, b.time_offset_std, b.time_offset_clustered});
  addAxes(a.axes, b.axes, one);
  return one;
}

/// What to look at if a value differs.
const char* causesOf(const std::string& value) {
  if (value.find("time_offset") != std::string::npos)
    return "blurred images, image times that jitter, or knots that are too far apart for the motion";
  if (value.find("translation") != std::string::npos)
    return "knots that are too far apart for the motion, vibration, or blurred images";
  return "knots that are too far apart for the motion, or errors that corners of an image share, as by blur or a board "
         "that is not flat";
}

void addLargest(StreamAgreement& agreement) {
  const auto take = [&](double deviations, const std::string& name) {
    if (deviations > agreement.largest) agreement.largest = deviations, agreement.largest_name = name;
  };
  for (const ImuAgreement& imu : agreement.imus) {
    const auto [deviations, name] = imu.largest();
    take(deviations, name);
  }
  take(agreement.gravity_angle / agreement.gravity_std, "gravity");
  if (agreement.largest <= most_deviations) return;
  agreement.contradiction =
      fmt::format("The two fits differ in {} by {:.2g} standard deviations. Usual causes: {}.",
                  agreement.largest_name, agreement.largest, causesOf(agreement.largest_name));
}

}  // namespace

std::pair<double, std::string> ImuAgreement::largest() const {
  std::pair<double, std::string> most{0, ""};
  const auto take = [&](double difference, double std, const std::string& value) {
    const double deviations = std::abs(difference) / std;
    if (deviations > most.first) most = {deviations, name + "." + value};
  };
  for (int i = 0; i < 3; ++i) {
    const char axis = "xyz"[i];
    take(translation[i], translation_std[i], std::string("translation.") + axis);
    take(rotation[i], rotation_std[i], std::string("rotation.") + axis);
  }
  take(time_offset, time_offset_std, "time_offset");
  const std::vector<std::string> of_axes = namesOfAxes();
  for (std::size_t i = 0; i < axes.size(); ++i) take(axes[i], axes_std[i], of_axes[i]);
  return most;
}

StreamAgreement agreementOf(const StreamResult& first, const StreamResult& second) {
  const auto has_name = [](const ImuStreamResult& a, const ImuStreamResult& b) { return a.name == b.name; };
  if (!std::equal(first.imus.begin(), first.imus.end(), second.imus.begin(), second.imus.end(), has_name))
    throw DataError("slom.calibration.bad-stream",
                    "the two results have other IMUs; compare fits of the same streams", "second");
  StreamAgreement agreement;
  for (std::size_t i = 0; i < first.imus.size(); ++i)
    agreement.imus.push_back(agreementOf(first.imus[i], second.imus[i]));
  const Eigen::Vector3d a = first.gravity, b = second.gravity;
  agreement.gravity_angle = std::atan2(a.cross(b).norm(), a.dot(b));
  agreement.gravity_std = largestOf({first.gravity_direction_std, first.gravity_direction_clustered,
                                     second.gravity_direction_std, second.gravity_direction_clustered});
  for (const StreamResult* fit : {&first, &second}) {
    if (!fit->success() && agreement.contradiction.empty())
      agreement.contradiction =
          fmt::format("The fit by {} failed, so there is nothing to compare: {}.", toString(fit->path),
                      fit->undetermined.empty() ? fit->message : fit->undetermined);
  }
  if (agreement.contradiction.empty()) addLargest(agreement);
  return agreement;
}

}  // namespace slom::calibration
