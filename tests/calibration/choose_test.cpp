// A calibration that leaves settings to comparisons ends with the result of the settings that they choose.
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <slom/calibration.hpp>

#include "calibration/models/opencv.hpp"
#include "calibration/simulated_views.hpp"

namespace slom::calibration {
namespace {

std::vector<double> numbersOf(const Result& result) {
  std::vector<double> numbers;
  for (const CameraResult& camera : result.cameras) {
    for (const Parameter& parameter : camera.parameters) {
      numbers.push_back(parameter.value);
      numbers.push_back(parameter.std);
    }
  }
  return numbers;
}

TEST(CalibrateByChoice, EqualsACalibrationWithTheChosenSettings) {
  const unsigned seed = std::random_device()() % 1000;
  const Dataset data =
      testing::simulated(Radial1<>{500., 320., 240., -0.2}, testing::Scene{.images = 10}, seed);
  Settings settings;
  settings.sigma_px = 0.2;
  std::vector<std::string> steps;
  ChoiceProgress progress;
  progress.models = [&](const Comparison& comparison, const Settings& chosen) {
    steps.push_back("models");
    EXPECT_EQ(chosen.model, comparison.chosenTrial().model);
  };
  progress.board_shapes = [&](const Comparison&) { steps.push_back("board"); };
  progress.before_fit = [&](const Settings&) { steps.push_back("fit"); };
  progress.noise = [&](const NoiseComparison&, const Result&) { steps.push_back("noise"); };
  progress.readout = [&](const auto&, const Result&) { steps.push_back("readout"); };
  const Choices all{{Model("radial1"), Model("opencv4")}, true, true, true, true};
  const Result result = calibrateByChoice(data, settings, all, progress);
  ASSERT_TRUE(result.success()) << result.message << ", seed " << seed;
  std::erase(steps, "models");  // once, or once more on the chosen board
  EXPECT_EQ(steps, (std::vector<std::string>{"board", "fit", "noise", "readout"})) << "seed " << seed;
  EXPECT_EQ(settings.model, result.comparison->chosenTrial().model);
  EXPECT_EQ(settings.board_shape, result.board_comparison->chosenTrial().board_shape);
  EXPECT_EQ(settings.sigma_by, result.noise_comparison->chosen);
  EXPECT_EQ(numbersOf(calibrate(data, settings)), numbersOf(result)) << "seed " << seed;
}

/// Of a long recording, a part is compared, and all is fitted.
TEST(CalibrateByChoice, ComparesAPartOfALongRecording) {
  const Dataset data =
      testing::simulated(Radial1<>{500., 320., 240., -0.2}, testing::Scene{.images = 620}, 1);
  Settings settings;
  settings.sigma_px = 0.2;
  const Result result = calibrateByChoice(data, settings, {{Model("radial1"), Model("opencv4")}, true});
  ASSERT_TRUE(result.comparison && result.success());
  for (const ModelTrial& trial : result.comparison->trials) {
    EXPECT_GT(trial.held_out_squares.size(), 290u) << trial.model.name();
    EXPECT_LT(trial.held_out_squares.size(), 310u) << trial.model.name();
  }
  EXPECT_EQ(result.images.size(), 620u);
}

TEST(CalibrateByChoice, LeavesGivenSettingsAlone) {
  const Dataset data = testing::simulated(Radial1<>{500., 320., 240., -0.2}, testing::Scene{.images = 6}, 1);
  Settings settings;
  settings.model = Model("opencv5");
  const Result result = calibrateByChoice(data, settings, {{Model("radial1"), Model("opencv4")}});
  EXPECT_EQ(settings.model, Model("opencv5"));
  ASSERT_TRUE(result.comparison);
  EXPECT_EQ(result.cameras[0].model, "opencv5");
  EXPECT_FALSE(result.board_comparison || result.noise_comparison);
}

}  // namespace
}  // namespace slom::calibration
