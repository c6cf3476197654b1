#include "calibrate/input/read.hpp"

#include <map>
#include <utility>

#include <fmt/format.h>

#include "calibrate/input/csv.hpp"
#include "error.hpp"

namespace slom::app::calib {

CameraData readCorners(const std::string& camera_name, const std::string& file) {
  const CsvTable table(file, {"image", "corner", "world_x_m", "world_y_m", "world_z_m", "u_px", "v_px"});
  std::map<int, View> views;
  std::map<std::pair<int, int>, int> line_of;  // (image, corner) -> line
  for (const CsvRow& row : table.rows()) {
    const int image = row.index(0), number = row.index(1);
    const auto [known, is_new] = line_of.emplace(std::pair(image, number), row.line());
    if (!is_new) {
      throw UserError(
          fmt::format("{}: corner {} of image {} was listed in line {} already; remove one of the two rows",
                      row.place(), number, image, known->second));
    }
    View& view = views[image];
    view.image = image;
    view.corners.push_back({number, vec3(row.number(2), row.number(3), row.number(4)),
                            vec2(row.number(5), row.number(6)), row.line()});
  }
  CameraData camera{camera_name, file, {}};
  for (auto& [image, view] : views) camera.views.push_back(std::move(view));
  return camera;
}

ImuData readImu(const std::string& file) {
  const CsvTable table(file, {"image", "ax_m_s2", "ay_m_s2", "az_m_s2", "valid"});
  ImuData imu{file, {}};
  std::map<int, int> line_of;  // image -> line
  for (const CsvRow& row : table.rows()) {
    const int image = row.index(0), valid = row.index(4);
    if (valid > 1)
      throw UserError(fmt::format("{}: valid is \"{}\"; write 1, or 0 to skip the row", row.place(), valid));
    if (valid == 0) continue;
    const auto [known, is_new] = line_of.emplace(image, row.line());
    if (!is_new) {
      throw UserError(
          fmt::format("{}: image {} has a valid reading in line {} already; keep one, or the mean of both",
                      row.place(), image, known->second));
    }
    imu.readings.push_back({image, vec3(row.number(1), row.number(2), row.number(3)), row.line()});
  }
  if (imu.readings.empty()) {
    throw UserError(
        fmt::format("{}:{}: no row has valid = 1; leave out --imu, or mark the readings that can be used",
                    file, table.rows().back().line()));
  }
  return imu;
}

}  // namespace slom::app::calib
