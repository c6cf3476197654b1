#include "calibrate/html/motion_data.hpp"

#include <cmath>

#include "calibrate/html/page_numbers.hpp"
#include "calibrate/output/quality_json.hpp"

namespace slom::app::calib {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_points = 3000;  // of a path

Json list(const vec3& v) { return {v[0], v[1], v[2]}; }

Json residualsJson(const ImuStreamResult& imu) {
  Json gyro{Json::array(), Json::array(), Json::array()}, force = gyro, time = Json::array(), gyro_std = time,
                                                          force_std = time;
  std::vector<double> spacings;
  for (const ImuResidual& one : imu.residuals) {
    time.push_back(rounded(one.time, 3));
    for (std::size_t i = 0; i < 3; ++i) {
      gyro[i].push_back(rounded(one.gyro[Eigen::Index(i)], 6));
      force[i].push_back(rounded(one.force[Eigen::Index(i)], 5));
    }
    gyro_std.push_back(rounded(one.gyro_std, 6));
    force_std.push_back(rounded(one.force_std, 5));
    spacings.push_back(one.duration);
  }
  double spacing = 0;
  for (const double one : spacings) spacing += one / double(spacings.size());
  return {{"time", time},         {"gyro", gyro},           {"force", force},
          {"gyro_std", gyro_std}, {"force_std", force_std}, {"spacing", spacing}};
}

Json imuJson(const ImuStreamResult& imu, const StreamResult& streams) {
  Json rows = Json::array(), at_rest = Json::array(), notes = Json::array();
  rows.push_back(valueRow("time offset", 1000 * imu.time_offset, 1000 * imu.time_offset_std,
                          1000 * imu.time_offset_clustered, "ms"));
  addVector(rows, "translation", imu.left2imu.pos, imu.translation_std, imu.translation_clustered, "m");
  addVector(rows, "rotation", vec3(SO3::log(imu.left2imu.orient) * degrees),
            vec3(imu.rotation_vector_std * degrees), vec3(imu.rotation_vector_clustered * degrees), "deg");
  for (const AllanDeviation& one : imu.at_rest)
    at_rest.push_back({{"time", one.time}, {"gyro", one.gyro}, {"force", one.force}});
  for (const std::string& note : streams.notes) {
    if (streams.imus.size() == 1 || note.find(imu.name) != std::string::npos) notes.push_back(note);
  }
  return {{"name", imu.name},
          {"samples", imu.samples},
          {"intervals", imu.intervals},
          {"undetermined", streams.success()              ? ""
                           : streams.undetermined.empty() ? streams.message
                                                          : streams.undetermined},
          {"parameters", std::move(rows)},
          {"noise_is_given", imu.noise_is_given},
          {"density", {{"gyro", imu.noise.gyro}, {"force", imu.noise.force}}},
          {"walk", {{"gyro", imu.noise.gyro_walk}, {"force", imu.noise.force_walk}}},
          {"ratio", {{"gyro", imu.gyro_ratio}, {"force", imu.force_ratio}}},
          {"excitation", {{"gyro", list(imu.excitation.turns)}, {"acc", list(imu.excitation.forces)}}},
          {"notes", std::move(notes)},
          {"residuals", residualsJson(imu)},
          {"rest", {imu.rest_from, imu.rest_to}},
          {"at_rest", std::move(at_rest)}};
}

/// Returns the rows of clocks and shutters that were estimated.
Json timingRows(const StreamResult& streams) {
  Json rows = Json::array();
  const auto add = [&](const std::string& name, const std::optional<StreamNumber>& one, double per_unit,
                       const char* unit) {
    if (one)
      rows.push_back(
          valueRow(name, per_unit * one->value, per_unit * one->std, per_unit * one->std_clustered, unit));
  };
  for (const CameraStreamResult& camera : streams.cameras) {
    add("time offset of " + camera.name, camera.time_offset, 1e3, "ms");
    add("line delay of " + camera.name, camera.line_delay, 1e6, "us");
  }
  return rows;
}

}  // namespace

Json motionJson(const FittedStreams& fitted) {
  const StreamResult& streams = fitted.result;
  Json imus = Json::array(), path = Json::array();
  for (const ImuStreamResult& imu : streams.imus) imus.push_back(imuJson(imu, streams));
  const std::size_t every = (streams.poses.size() + most_points - 1) / most_points;
  for (std::size_t i = 0; i < streams.poses.size(); i += every) {
    const TimedPose& one = streams.poses[i];
    path.push_back({rounded(one.time, 3), rounded(one.pose.pos[0], 4), rounded(one.pose.pos[1], 4),
                    rounded(one.pose.pos[2], 4)});
  }
  return {{"verdict", verdictJson(fitted.verdict)},
          {"imus", std::move(imus)},
          {"timings", timingRows(streams)},
          {"path", std::move(path)}};
}

}  // namespace slom::app::calib
