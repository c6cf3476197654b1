// Options of slom calibrate, one per line: `fix k3`, `bound fx=400,600`, `board 9x6` and so on; and those of fits.
#include <cmath>
#include <sstream>

#include "calibrate/settings.hpp"
#include "fitting/fit_options.hpp"
#include "fuzz/target.hpp"

SLOM_FUZZ_TARGET(options) {
  app::calib::RawOptions raw;
  app::RawFitOptions fit;
  std::istringstream lines{std::string(input)};
  for (std::string name, value; lines >> name && std::getline(lines >> std::ws, value);) {
    if (name == "camera") raw.cameras.push_back(value);
    if (name == "images") raw.images.push_back(value);
    if (name == "board") raw.board.board = value;
    if (name == "fix") raw.fixed.push_back(value);
    if (name == "bound") raw.bounded.push_back(value);
    if (name == "size") raw.image_sizes.push_back(value);
    if (name == "format") raw.format = value;
    if (name == "model") raw.model = value;
    if (name == "output") raw.rest.yaml_file = value;
    if (name == "imu") raw.imu_files.push_back(value);
    if (name == "robust") fit.loss = value;
    if (name == "solver") fit.solver = value;
    if (name == "algorithm") fit.algorithm = value;
  }
  app::calib::CommandSettings settings;
  if (accepted([&] { settings = parseSettings(raw); })) {
    for (const auto& constraint : settings.lens)
      require(std::isfinite(constraint.lower) && constraint.lower <= constraint.upper &&
                  std::isfinite(constraint.upper),
              "limits are no limits");
    for (const auto& [camera, size] : settings.image_sizes)
      require(isPlausible(size), "an image size that cannot be");
  }
  accepted([&] { app::parseFitOptions(fit); });
}
