// How numbers and sentences are written.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <slom/solve/instruction_set.hpp>

#include "calibrate/calibrate_command.hpp"
#include "calibrate/library.hpp"
#include "calibrate/output/json.hpp"
#include "calibrate/output/notes.hpp"
#include "calibrate/output/report.hpp"

namespace slom::app::calib {
namespace {

void expectText(double value, double std, const std::string& value_text, const std::string& std_text) {
  const ValueText text = withStd(value, std);
  EXPECT_EQ(text.value, value_text);
  EXPECT_EQ(text.std, std_text);
}

TEST(Format, ShowsTwoDigitsOfTheUncertainty) {
  expectText(532.7981, 0.21234, "532.80", "0.21");
  expectText(-0.000123456, 0.0000456, "-0.000123", "0.000046");
  expectText(532.7981, 21.2, "533", "21");
  expectText(532.7981, 212, "533", "212");
  expectText(1.23456, 0.0996, "1.23", "0.10");
  expectText(1.23456, 0.0994, "1.235", "0.099");
  expectText(9.81, 0, "9.81", "fixed");
  expectText(9.81, unknown, "9.81", "not determined");
  expectText(unknown, 1, "-", "not determined");
  expectText(HUGE_VAL, 0, "-", "not determined");
  expectText(1234.5678, 1e-12, "1234.5678", "1.0e-12");
}

TEST(Format, TwoDigits) {
  EXPECT_EQ(twoDigits(0.21), "0.21");
  EXPECT_EQ(twoDigits(13.4), "13");
  EXPECT_EQ(twoDigits(0.996), "1.0");
  EXPECT_EQ(twoDigits(0), "0");
  EXPECT_EQ(twoDigits(2.13e-9), "2.1e-09");
  for (const double x : {unknown, -unknown, HUGE_VAL, -HUGE_VAL}) {
    EXPECT_EQ(twoDigits(x), "-");
    EXPECT_EQ(fixedDecimals(x, 3), "-");
  }
  EXPECT_EQ(fixedDecimals(0.12345, 3), "0.123");
}

/// Returns a result with one camera, residuals that agree with the sigmas, and a well determined IMU.
Result goodResult() {
  Result result;
  result.converged = true;
  result.sigma_px = 0.25;
  result.sigma_acc = 0.05;
  result.measurements = 1030;
  result.unknowns = 37;
  result.redundancy = 993;
  CameraResult camera;
  camera.name = "left";
  camera.corners = 500;
  camera.rms_px = 0.25 * std::sqrt(2 * (1000 - 30) / 1000.0);
  camera.rms_px_single = 0.345;
  result.cameras.push_back(camera);
  ImuResult imu;
  imu.readings = 10;
  imu.rms_acc = 0.05 * std::sqrt(3 * (30 - 7) / 30.0);
  imu.gravity = 9.8;
  imu.gravity_std = 0.02;
  imu.if_acc_bias_fixed = {0.01, 0, 0.015};
  imu.sign_evidence = 1000;
  imu.tilt_spread = 0.5;
  result.imu = imu;
  return result;
}

TEST(Notes, NothingToSayOfAGoodResult) { EXPECT_EQ(notes(goodResult()), std::vector<std::string>()); }

TEST(Notes, ResidualsThatDoNotFitTheSigmas) {
  Result result = goodResult();
  result.cameras[0].rms_px *= 0.6;
  result.imu->rms_acc *= 3;
  EXPECT_EQ(notes(result), (std::vector<std::string>{
                               "The residuals of the corners are 1.7 times smaller than --sigma-px 0.25 "
                               "predicts; --sigma-px 0.15 would fit them. The stated standard deviations "
                               "follow from the stated sigmas.",
                               "The residuals of the IMU are 3.0 times larger than --sigma-acc 0.05 "
                               "predicts; --sigma-acc 0.15 would fit them, unless the model is too simple "
                               "or the worst images are wrong. The stated standard deviations follow from "
                               "the stated sigmas."}));
}

TEST(Notes, CameraThatFitsWorseTogether) {
  Result result = goodResult();
  result.cameras[0].rms_px_single = 0.2;
  EXPECT_EQ(
      notes(result),
      (std::vector<std::string>{
          "Camera left fits its images to 0.200 px alone, but to 0.348 px together with the rest: look for "
          "images that were not taken at the same time, image numbers that do not belong together, or a "
          "part that moved."}));
}

TEST(Notes, ImagesThatContradictTheOthers) {
  Result result = goodResult();
  result.strays.push_back({"right", 3, 47.3});
  result.cameras.push_back(result.cameras[0]);
  EXPECT_EQ(
      notes(result),
      (std::vector<std::string>{
          "Image 3 of camera right contradicts the others by 47 px. Was it taken at the same time as "
          "image 3 of camera left? If not, leave it out (--exclude right.3) or correct its number. "
          "Otherwise check whether its corners were taken for their neighbours, a row or column further."}));
}

TEST(Notes, MostImagesOfACameraContradictTheOthersInOneNote) {
  Result result = goodResult();
  result.cameras.push_back(result.cameras[0]);
  result.cameras[1].name = "right";
  result.cameras[0].images = result.cameras[1].images = 5;
  for (const int image : {3, 4, 7}) result.strays.push_back({"right", image, 40.4 + image});
  result.strays.push_back({"left", 9, 12});
  const std::vector<std::string> found = notes(result);
  ASSERT_GE(found.size(), 2u);
  EXPECT_EQ(
      found[0],
      "3 of the 5 images of camera right contradict those of camera left, by 43 to 47 px. Image numbers "
      "or time stamps of this camera do not match those of the other one; correct them.");
  EXPECT_TRUE(found[1].starts_with("Image 9 of camera left contradicts the others")) << found[1];
}

TEST(Notes, AnImageOfTheReferenceIsComparedWithTheOtherCamera) {
  Result result = goodResult();
  result.strays.push_back({"left", 3, unknown});
  result.cameras.push_back(result.cameras[0]);
  result.cameras[1].name = "right";
  EXPECT_EQ(
      notes(result)[0],
      "Image 3 of camera left contradicts the others by - px. Was it taken at the same time as image 3 of "
      "camera right? If not, leave it out (--exclude left.3) or correct its number. Otherwise check "
      "whether its corners were taken for their neighbours, a row or column further.");
}

TEST(Notes, WeakGravityAndOpenSign) {
  Result result = goodResult();
  result.imu->gravity_std = 0.15;
  result.imu->sign_evidence = 1;
  EXPECT_EQ(
      notes(result),
      (std::vector<std::string>{
          "The sign of gravity is undetermined: the images are tilted about one axis only, and the other "
          "sign (with the IMU turned by half a turn) fits as well. Add images tilted about another axis.",
          "acc_bias and gravity are weakly determined, because the tilts of the images spread by only "
          "28.6 deg: the two trade off against each other and against the rotation (multiple correlation "
          "of gravity with acc_bias 0.9950). The table of the imu shows the gain from --fix gravity=9.81 "
          "or --fix acc_bias=X,Y,Z; images with more tilt, about both axes, help without such "
          "assumptions."}));
}

TEST(Notes, GravityOfAnotherPlanet) {
  Result result = goodResult();
  result.imu->gravity = -1.001;
  EXPECT_EQ(
      notes(result),
      (std::vector<std::string>{
          "Gravity of -1 m/s^2 is not that of the Earth (9.78 to 9.84). The readings seem to be in g: multiply them by "
          "9.80665."}));
  result.imu->gravity = 7;
  EXPECT_EQ(notes(result),
            (std::vector<std::string>{
                "Gravity of 7 m/s^2 is not that of the Earth (9.78 to 9.84). Check the unit and the scale of "
                "the readings, and that the world's z axis is vertical."}));
}

TEST(Notes, ParametersThatAreNotDetermined) {
  Result result = goodResult();
  result.undetermined = "the measurements do not determine left.k3";
  EXPECT_EQ(notes(result),
            (std::vector<std::string>{"Not all parameters are determined (the measurements "
                                      "do not determine left.k3), so there are no standard "
                                      "deviations, and the values must not be used. Add "
                                      "images from other directions and distances, or "
                                      "choose a model with fewer parameters by --intrinsics."}));
}

TEST(Notes, AreInTheJsonToo) {
  Result result = goodResult();
  result.undetermined = "the measurements do not determine left.k3";
  EXPECT_EQ(nlohmann::json::parse(toJson(result))["notes"], nlohmann::json(notes(result)));
}

TEST(Report, HelpOpensWithASampleRun) {
  const auto help = testing::runCalibrate({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_TRUE(help.output.starts_with("slom calibrate --board 9x6 --square 0.025 --images left="))
      << help.output;
  for (const std::string option :
       {"--camera", "--imu", "--intrinsics", "--sigma-px", "--json", "--output", "--quiet", "--help-all"}) {
    EXPECT_NE(help.output.find("  " + option), std::string::npos) << option;
  }
  const auto all = testing::runCalibrate({"--help-all"});
  EXPECT_EQ(all.exit_code, 0);
  for (const std::string option : {"--camera", "--sigma-acc", "--fix", "--max-seconds"}) {
    EXPECT_NE(all.output.find("  " + option), std::string::npos) << option;
  }
}

TEST(Report, CommandWithoutOrWithUnknownSubcommand) {
  const std::string command = slom::testing::commandPath().string();
  EXPECT_EQ(slom::testing::runCommand({command}).errors, "slom: A subcommand is required; see slom --help\n");
  const auto unknown_one = slom::testing::runCommand({command, "callibrate"});
  EXPECT_EQ(unknown_one.errors, "slom: callibrate is not a subcommand; see slom --help\n");
  EXPECT_EQ(unknown_one.exit_code, 2);
  const auto version = slom::testing::runCommand({command, "--version"});
  EXPECT_EQ(version.output, std::string("slom " SLOM_VERSION ", kernels: ") + slom::instructionSet() + "\n");
  EXPECT_EQ(version.exit_code, 0);
}

TEST(Report, SaysWhatMatters) {
  const auto folder = slom::testing::sourcePath("data/simulated_stereo_imu");
  const auto run = testing::runCalibrate({"--camera", "left=" + (folder / "left_corners.csv").string(),
                                          "--camera", "right=" + (folder / "right_corners.csv").string(),
                                          "--imu", (folder / "imu.csv").string()});
  EXPECT_EQ(run.exit_code, 0) << run.errors;
  for (const std::string part :
       {"left         10 images     900 corners", "iteration            RSS", "Converged after",
        "3678 measurements - 103 unknowns = redundancy 3575", "chi2/dof",
        "camera left: opencv5, 10 images, 900 corners, RMS", "camera right: opencv5",
        "from left to right, p_right = R p_left + t:", "imu: 10 readings, RMS", "gravity", "largest std",
        "worst images", "acc_bias and gravity are weakly determined"}) {
    EXPECT_NE(run.output.find(part), std::string::npos) << "\"" << part << "\" is not in\n" << run.output;
  }
}

}  // namespace
}  // namespace slom::app::calib
