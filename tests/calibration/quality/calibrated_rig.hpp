// A simulated and calibrated rig, for tests of statements about its quality.
#pragma once

#include <random>

#include <slom/calibration.hpp>

#include "calibration/quality/uncertainty/information.hpp"
#include "calibration/quality/uncertainty/projection.hpp"
#include "calibration/simulated_rig.hpp"

namespace slom::calibration::testing {

struct CalibratedRig {
  RigTruth truth;
  Dataset data;
  Settings settings;
  Result result;
};

/// Two cameras, images of 640 x 480 px, small boards.
inline RigOptions smallBoards() {
  RigOptions options;
  options.images = 8;
  options.columns = 6;
  options.rows = 5;
  options.square_m = 0.07;
  return options;
}

inline Dataset measured(const RigTruth& truth, const RigOptions& options, std::mt19937_64& random,
                        bool has_imu) {
  Dataset data = simulateMeasurements(truth, options, random);
  for (CameraData& camera : data.cameras) camera.image_size = ImageSize{640, 480};
  if (!has_imu) data.imu.reset();
  return data;
}

inline CalibratedRig calibratedRig(const RigOptions& options, const Settings& settings, unsigned seed,
                                   bool has_imu = false) {
  std::mt19937_64 random(seed);
  CalibratedRig rig;
  rig.truth = simulateTruth(options, random);
  if (settings.model == Model("opencv4")) {
    for (auto& camera : rig.truth.cameras) camera[8] = 0;
  }
  rig.data = measured(rig.truth, options, random, has_imu);
  rig.settings = settings;
  rig.result = calibrate(rig.data, settings);
  return rig;
}

inline Settings opencv4() {
  Settings settings;
  settings.model = Model("opencv4");
  return settings;
}

inline Information informationOfAll(const Dataset& data, const FittedRig& rig) {
  Information sum(rig.columns);
  for (const auto& [image, observation] : observationsOf(data, rig)) sum.add(informationOf(rig, observation));
  return sum;
}

inline std::vector<ImageGrid> grids(const Dataset& data, int columns, int rows) {
  return std::vector<ImageGrid>(data.cameras.size(), ImageGrid{columns, rows, {640, 480, false}});
}

/// Standard normal that a chi-square variable corresponds to (Wilson and Hilferty 1931).
inline double normalOfChiSquare(double chi2, double dof) {
  return (std::cbrt(chi2 / dof) - (1 - 2 / (9 * dof))) / std::sqrt(2 / (9 * dof));
}

}  // namespace slom::calibration::testing
