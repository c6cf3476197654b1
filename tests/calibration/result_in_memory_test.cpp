// Results that do not belong to the data or lack a requested part, and invalid settings.
#include <chrono>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calibration/rig_in_memory.hpp"
#include "support/message_of.hpp"

namespace slom::calibration {
namespace {

using slom::testing::messageOf;
using testing::nan;
using testing::pinholeWithDistortion;
using testing::rigInMemory;

class ResultInMemory : public ::testing::Test {
 protected:
  std::string assessmentOf(const Dataset& other) {
    return messageOf([&] { assess(other, settings, result); });
  }
  std::string pixelsOf(const Dataset& other) {
    return messageOf([&] { PixelUncertainty(other, result); });
  }
  void expectRefused(const Dataset& other, const std::string& difference) {
    EXPECT_EQ(assessmentOf(other), "[slom.calibration.no-result] there is nothing to assess: " + difference +
                                       "; pass the result of calibrate() with these data and settings");
    EXPECT_EQ(pixelsOf(other), "[slom.calibration.no-result] there is no uncertainty of pixels: " +
                                   difference + "; pass the result of calibrate() with these data");
  }

  Dataset data = rigInMemory();
  Settings settings = pinholeWithDistortion();
  Result result = calibrate(data, settings);
};

TEST_F(ResultInMemory, IsAssessedWithItsData) { EXPECT_EQ(assessmentOf(data), "no error"); }

TEST_F(ResultInMemory, OfKnownLensesIsAssessed) {
  for (const auto& [name, value] : {std::pair("fx", 500.),
                                    {"fy", 500.},
                                    {"cx", 320.},
                                    {"cy", 240.},
                                    {"k1", 0.},
                                    {"k2", 0.},
                                    {"p1", 0.},
                                    {"p2", 0.}})
    settings.lens.push_back({"", name, value, value});
  for (const bool has_imu : {true, false}) {
    for (const std::size_t cameras :
         {2, 1}) {  // of one camera without an IMU, the poses of the images are all unknowns
      Dataset known = rigInMemory(12);  // enough images to look for patterns
      known.cameras.resize(cameras);
      if (!has_imu) known.imu.reset();
      const Result fitted = calibrate(known, settings);
      ASSERT_TRUE(fitted.success());
      EXPECT_EQ(fitted.cameras[0].parameters[0].std, 0);
      const Quality quality = assess(known, settings, fitted);
      EXPECT_FALSE(quality.patterns.empty());
    }
  }
}

TEST_F(ResultInMemory, OfOtherCameras) {
  Dataset other = data;
  other.cameras.pop_back();
  expectRefused(other, "the number of cameras is 1 in the data and 2 in the result");
  other = data;
  std::swap(other.cameras[0], other.cameras[1]);
  expectRefused(other, "cameras[0] is called right in the data, and left in the result");
  other = data;
  other.cameras[1].views[3].corners.pop_back();
  expectRefused(other, "the number of corners of camera right is 209 in the data and 210 in the result");
  EXPECT_EQ(messageOf([&] { assess(data, settings, Result()); }),
            "[slom.calibration.no-result] there is nothing to assess: the number of cameras is 2 in the data "
            "and 0 in the result; pass the result of calibrate() with these data and settings");
}

TEST_F(ResultInMemory, OfOtherImages) {
  Dataset other = data;
  other.imu.reset();
  other.cameras[0].views[5].image = other.cameras[1].views[5].image = 70;
  expectRefused(other, "image 70 of left is not in the result");
  other.cameras[0].views.pop_back();
  other.cameras[1].views.pop_back();
  expectRefused(other, "image 5 of the result is not in the data");
}

TEST_F(ResultInMemory, OfAnotherImu) {
  Dataset without = data;
  without.imu.reset();
  expectRefused(without, "there is an IMU only in the result");
  Dataset shorter = data;
  shorter.imu->readings.pop_back();
  expectRefused(shorter, "the number of IMU readings is 5 in the data and 6 in the result");
  Dataset other = data;
  other.imu->readings[2].image = 70;
  const std::string unknown_image =
      "[slom.calibration.imu-images] imu.readings[2]: there are no corners of image 70 in any camera; correct "
      "the number, or leave the reading out";
  EXPECT_EQ(assessmentOf(other), unknown_image);
  EXPECT_EQ(pixelsOf(other), unknown_image);
  result.imu.reset();
  expectRefused(data, "there is an IMU only in the data");
}

TEST_F(ResultInMemory, OfOtherSettings) {
  const std::string before = "[slom.calibration.no-result] there is nothing to assess: ",
                    after = "; pass the result of calibrate() with these data and settings";
  settings.model = Model("opencv8");
  EXPECT_EQ(assessmentOf(data),
            before + "the result has the model opencv4, the settings have opencv8" + after);
  settings.model = Model("opencv4");
  settings.sigma_px = 0.5;
  EXPECT_EQ(assessmentOf(data), before + "sigma_px is 0.25 in the result, and 0.5 in the settings" + after);
  settings.sigma_px = nan;
  EXPECT_EQ(assessmentOf(data),
            "[slom.calibration.bad-settings] Settings::sigma_px is nan; give a positive number");
}

TEST_F(ResultInMemory, OfCamerasOfSeveralModels) {
  result.cameras[1].model = "radial1";
  expectRefused(data, "camera right has the model radial1 in the result, and camera left the model opencv4");
}

TEST_F(ResultInMemory, WithoutTheParametersOfTheModel) {
  CameraResult camera = result.cameras[1];
  camera.parameters.resize(3);
  const std::string missing =
      "[slom.calibration.bad-camera] the number of parameters of camera right is 3 instead of 8 for the "
      "model opencv4; set all of them, in the order of Model::parameters()";
  EXPECT_EQ(messageOf([&] { camera.project(vec3(0., 0., 1.)); }), missing);
  EXPECT_EQ(messageOf([&] { camera.ray(vec2(320., 240.)); }), missing);
  result.cameras[1] = camera;
  EXPECT_EQ(assessmentOf(data), missing);
  camera.model.clear();
  EXPECT_EQ(messageOf([&] { camera.project(vec3(0., 0., 1.)); }),
            "[slom.calibration.bad-camera] camera right has no model; pass a camera of the result of "
            "calibrate(), or set model and parameters");
  const std::string count =
      "[slom.calibration.bad-question] the number of parameters is 2 instead of 8 for the model opencv4; "
      "pass all of them, in the order of Model::parameters()";
  const Model model("opencv4");
  EXPECT_EQ(messageOf([&] { model.forOpencv({1, 2}); }), count);
  EXPECT_EQ(messageOf([&] { model.forRos({1, 2}); }), count);
  EXPECT_EQ(messageOf([&] { model.forKalibr({1, 2}); }), count);
}

TEST_F(ResultInMemory, HasNoVerdictWithoutAnAssessment) {
  EXPECT_EQ(messageOf([&] { verdictOf(result); }),
            "[slom.calibration.no-quality] there is no verdict on a result without an assessment; first "
            "set result.quality to assess(data, settings, result)");
  result.quality = assess(data, settings, result);
  EXPECT_EQ(messageOf([&] { verdictOf(result); }), "no error");
  const std::string of_another =
      "[slom.calibration.no-quality] there is no verdict on a result with the assessment of another one; "
      "first set result.quality to assess(data, settings, result)";
  Result other = result;
  other.quality->cameras.pop_back();
  EXPECT_EQ(messageOf([&] { verdictOf(other); }), of_another);
  other = result;
  other.quality->cameras[0].projection.clear();
  EXPECT_EQ(messageOf([&] { verdictOf(other); }), of_another);
  other = result;
  other.quality->worst[0].camera = 2;
  EXPECT_EQ(messageOf([&] { verdictOf(other); }), of_another);
  other = result;
  other.images.clear();
  EXPECT_EQ(
      messageOf([&] { verdictOf(other); }),
      "[slom.calibration.no-quality] there is no verdict on a result without cameras or images; pass the "
      "result of calibrate()");
  EXPECT_EQ(verdictOf(Result()).level, Verdict::Level::failed);
}

TEST_F(ResultInMemory, HasNoSentenceOfAViewOfAnotherOne) {
  FurtherView view;
  view.camera = 2;
  EXPECT_EQ(
      messageOf([&] { sentenceOf(view, result); }),
      "[slom.calibration.bad-question] there is no camera 2 with a column 0 and a row 0; pass one of the "
      "further views of this result's quality");
  view.camera = 0, view.column = 3, view.row = -1;
  EXPECT_EQ(
      messageOf([&] { sentenceOf(view, result); }),
      "[slom.calibration.bad-question] there is no camera 0 with a column 3 and a row -1; pass one of the "
      "further views of this result's quality");
}

TEST_F(ResultInMemory, OfAComparisonWithoutAChoice) {
  EXPECT_EQ(
      messageOf([&] { compareModels(data, settings, {}); }),
      "[slom.calibration.bad-settings] there is no model to compare; pass some, such as comparedModels()");
  EXPECT_EQ(messageOf([] { Comparison().chosenTrial(); }),
            "[slom.calibration.no-result] no model is chosen, because none of the tried models fits; "
            "check Comparison::chosen first, and see ModelTrial::failure");
}

TEST(SettingsInMemory, TimeCountsFromAnyPoint) {
  using Clock = std::chrono::steady_clock;
  Settings settings = pinholeWithDistortion();
  settings.limits.max_seconds = 1000;
  settings.limits.since = Clock::time_point::max();
  EXPECT_TRUE(calibrate(rigInMemory(), settings).success());
  settings.limits.since = Clock::time_point::min();
  EXPECT_EQ(calibrate(rigInMemory(), settings).message, "time limit of 1000 s reached");
}

TEST(SettingsInMemory, ThatMakeNoSense) {
  const Dataset data = rigInMemory();
  const auto refusal = [&](const std::function<void(Settings&)>& spoil) {
    Settings settings = pinholeWithDistortion();
    spoil(settings);
    return messageOf([&] { calibrate(data, settings); });
  };
  const auto constrained = [&](std::vector<LensConstraint> lens) {
    return refusal([&](Settings& s) { s.lens = lens; });
  };
  const std::string id = "[slom.calibration.bad-settings] ";
  EXPECT_EQ(refusal([](Settings& s) { s.sigma_px = 0; }),
            id + "Settings::sigma_px is 0; give a positive number");
  EXPECT_EQ(refusal([](Settings& s) { s.sigma_acc = nan; }),
            id + "Settings::sigma_acc is nan; give a positive number");
  EXPECT_EQ(refusal([](Settings& s) { s.fixed.gravity = testing::infinity; }),
            id + "Settings::fixed.gravity is inf; give a positive number");
  EXPECT_EQ(refusal([](Settings& s) { s.sigma_px = 1e-300; }),
            id + "Settings::sigma_px is 1e-300; give a number from 1e-06 to 1e+06 px");
  EXPECT_EQ(refusal([](Settings& s) { s.sigma_acc = 1e12; }),
            id + "Settings::sigma_acc is 1000000000000; give a number from 1e-06 to 1e+06 m/s^2");
  EXPECT_EQ(refusal([](Settings& s) { s.sigma_denominator = 1e-300; }),
            id + "Settings::sigma_denominator is 1e-300; give a number from 1e-06 to 1e+06");
  EXPECT_EQ(refusal([](Settings& s) { s.fixed.gravity = 1e-300; }),
            id + "Settings::fixed.gravity is 1e-300; give a number from 0.001 to 1e+06 m/s^2");
  EXPECT_EQ(refusal([](Settings& s) { s.fixed.acc_bias = vec3(0., nan, 0.); }),
            id + "Settings::fixed.acc_bias is (0, nan, 0); give numbers from -1e+06 to 1e+06 m/s^2");
  EXPECT_EQ(refusal([](Settings& s) { s.fixed.acc_bias = vec3(1e300, 0., 0.); }),
            id + "Settings::fixed.acc_bias is (1e+300, 0, 0); give numbers from -1e+06 to 1e+06 m/s^2");
  EXPECT_EQ(refusal([](Settings& s) { s.max_iterations = 0; }),
            id + "Settings::max_iterations is 0; give a number from 1 on");
  EXPECT_EQ(refusal([](Settings& s) { s.limits.max_seconds = nan; }),
            id + "Settings::limits.max_seconds is nan; give a number from 0 on");
  EXPECT_EQ(constrained({{"", "k1", nan, 1}}), id + "k1 is to lie between nan and 1; give numbers");
  EXPECT_EQ(constrained({{"", "k1", testing::infinity, testing::infinity}}),
            id + "k1 is fixed at inf; give a value from -1e+06 to 1e+06");
  EXPECT_EQ(constrained({{"left", "fx", -500, -500}}),
            id + "fx is fixed at -500; give a value from 0.001 to 1e+09 px");
  EXPECT_EQ(constrained({{"left", "fx", -500, 0}}),
            id + "fx is to lie between -500 and 0; give limits that allow values from 0.001 to 1e+09 px");
  EXPECT_EQ(constrained({{"left", "cx", 2e6, 2e6}}),
            id + "cx is fixed at 2000000; give a value from -1e+06 to 1e+06 px");
  EXPECT_EQ(constrained({{"", "k1", -testing::infinity, testing::infinity}}), "no error");
  EXPECT_EQ(constrained({{"", "k1", 1, -1}}),
            id + "k1 cannot lie between 1 and -1; give the lower limit first");
  EXPECT_EQ(constrained({{"up", "k1", 0, 0}}),
            id + "there is no camera up whose k1 can be constrained; correct the name");
  EXPECT_EQ(constrained({{"", "k1", 0, 0}, {"left", "k1", -1, 1}}),
            id + "k1 of camera left is constrained twice, by lens[0] and lens[1]; keep one of the two");
  EXPECT_EQ(constrained({{"", "k1", 0, 0}, {"", "k2", 0, 0}, {"", "k1", 0, 0}}),
            id + "k1 of all cameras is constrained twice, by lens[0] and lens[2]; keep one of the two");
  EXPECT_EQ(constrained({{"left", "k1", 0, 0}, {"right", "k1", 0, 0}}), "no error");
}

}  // namespace
}  // namespace slom::calibration
