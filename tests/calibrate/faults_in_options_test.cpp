// Every mistake in the options, files that cannot be written, and fits that fail.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <regex>
#include <sstream>
#include <string>

#include "calibrate/faults.hpp"

namespace slom::app::calib {
namespace {

using slom::testing::replaced;
using testing::corner_header;
using testing::expectRefused;
using testing::Files;
using testing::runIn;
using testing::TemporaryFolder;
using testing::usual;

TEST(CalibrateFaults, NoCamera) {
  expectRefused(
      Files(), {"--imu", "DIR/imu.csv"},
      "no --camera; give at least one, as in --camera left=left_corners.csv, or photographs by --images");
}
TEST(CalibrateFaults, CameraSyntax) {
  for (const std::string text : {"left", "left=", "=left.csv"}) {
    expectRefused(Files(), {"--camera", text},
                  "--camera " + text + ": write NAME=FILE, as in --camera left=left_corners.csv");
  }
  for (const std::string text : {"1=a.csv", "left cam=a.csv", "l\"=a.csv"}) {
    expectRefused(Files(), {"--camera", text},
                  "--camera " + text +
                      ": the name must begin with a letter and contain only letters, digits, _ and -; rename "
                      "the camera");
  }
}
TEST(CalibrateFaults, CameraNamedTwice) {
  expectRefused(
      Files(), {"--camera", "left=DIR/left.csv", "--camera", "left=DIR/right.csv"},
      "right.csv:2: image 1 of camera left is already in left.csv; number images differently in all files "
      "and alike in all cameras, put the rows of one image into one file, or give the files as two "
      "cameras");
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--camera", "left=DIR/left.csv"},
                "--camera left=left.csv: the file is given twice; give it once, or another camera's file");
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--camera", "left=DIR/./left.csv"},
                "--camera left=./left.csv: the file is given twice; give it once, or another camera's file");
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--camera", "right=DIR/./left.csv"},
                "--camera right=./left.csv: the file already belongs to camera left; give each camera its "
                "own");
}
TEST(CalibrateFaults, SeveralFilesAfterOneOption) {
  for (const std::string files : {"left=DIR/*.csv", "left=DIR/left.csv,DIR/right.csv"}) {
    expectRefused(Files(), {"--camera", files},
                  "--camera " + replaced(files, "DIR/", "") +
                      ": this file does not exist; pass --camera once for each file of a recording");
  }
  expectRefused(
      Files(), {"--camera", "left=DIR/left.csv", "--imu", "DIR/imu.csv", "--imu", "DIR/imu2.csv"},
      "--imu imu2.csv: takes only one file; put the readings of all parts of the recording into one file, "
      "with the numbers of their images");
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--exclude", "left.1", "left.2", "left.3"},
                "The following arguments were not expected: left.2 left.3; see slom calibrate --help");
}
TEST(CalibrateFaults, UnknownModel) {
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--intrinsics", "pinhole"},
                "--intrinsics pinhole: the models are opencv4, opencv5, opencv8, fisheye, radial1 and "
                "double_sphere");
}
TEST(CalibrateFaults, Sigmas) {
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--sigma-px", "0"},
                "--sigma-px 0: a standard deviation must be positive");
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--sigma-acc", "-1"},
                "--sigma-acc -1: a standard deviation must be positive");
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--sigma-px", "1e-300"},
                "--sigma-px 1e-300: standard deviation out of range; give 1e-06 to 1e+06 px");
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--sigma-px", "1e300"},
                "--sigma-px 1e+300: standard deviation out of range; give 1e-06 to 1e+06 px");
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--sigma-acc", "1e-7"},
                "--sigma-acc 1e-07: standard deviation out of range; give 1e-06 to 1e+06 m/s^2");
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--sigma-px", "small"},
                "Could not convert: --sigma-px = small; see slom calibrate --help");
}
TEST(CalibrateFaults, MaxIterations) {
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--max-iterations", "0"},
                "--max-iterations 0: give a number from 1 on");
}
TEST(CalibrateFaults, Fix) {
  const auto with = [](std::vector<std::string> more) {
    std::vector<std::string> options = usual();
    options.insert(options.end(), more.begin(), more.end());
    return options;
  };
  expectRefused(
      Files(), with({"--fix", "k7"}),
      "--fix k7: unknown parameter \"k7\"; fix acc_bias, gravity or a camera parameter: f, fx, fy, cx, "
      "cy, k1, k2, p1, p2, k3, k4, k5, k6, xi, alpha");
  expectRefused(Files(), with({"--fix", "k3"}),
                "--fix k3: the model radial1 has no k3; its parameters are f, cx, cy, k1");
  expectRefused(Files(), with({"--fix", "cx"}),
                "--fix cx: the value is missing; give it in px, as in "
                "--fix cx=320");
  expectRefused(
      Files(), with({"--fix", "top.k1"}),
      "--fix top.k1: there is no camera top; give it by --camera, or leave the name out for all cameras");
  expectRefused(Files(), with({"--fix", "k1", "--bound", "left.k1=-1,1"}),
                "--bound left.k1=-1,1: constrains the same parameter as --fix k1; keep one of them");
  expectRefused(
      Files(), with({"--fix", "gravity=-9.81"}),
      "--fix gravity=-9.81: give the magnitude of gravity, a positive number in m/s^2; its sign is found "
      "from the data");
  for (const std::string value : {"1e300", "1e-300", "1e7"}) {
    expectRefused(
        Files(), with({"--fix", "gravity=" + value}),
        "--fix gravity=" + value + ": gravity out of range; give a magnitude between 0.001 and 1e+06 m/s^2");
  }
  expectRefused(Files(), with({"--fix", "acc_bias=0,-1e300,0"}),
                "--fix acc_bias=0,-1e300,0: bias out of range; give values between -1e+06 and 1e+06 m/s^2");
  expectRefused(Files(), with({"--fix", "gravity=g"}), "--fix gravity=g: the value must be a number");
  expectRefused(Files(), with({"--fix", "gravity="}), "--fix gravity=: the value must be a number");
  expectRefused(Files(), with({"--fix", "acc_bias=0,0"}),
                "--fix acc_bias=0,0: the value must be 3 numbers separated by commas");
  expectRefused(Files(), with({"--fix", "gravity", "--fix", "gravity=9.8"}),
                "--fix gravity=9.8: gravity is already fixed; give it once");
  expectRefused(Files(), with({"--fix", "acc_bias", "--fix", "acc_bias"}),
                "--fix acc_bias: acc_bias is already fixed; give it once");
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--fix", "gravity"},
                "--fix gravity: there is no IMU; add --imu FILE or drop --fix");
}
TEST(CalibrateFaults, NameOfAnImuAtRest) {
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--imu", "imu0=imu.csv"},
                "--imu imu0=imu.csv: takes a file without a name; for an IMU in motion, give --imu-stream "
                "imu0=imu.csv, and for readings at rest --imu imu.csv");
}
TEST(CalibrateFaults, Bound) {
  const auto with = [](const std::string& bound) {
    std::vector<std::string> options = usual();
    options.insert(options.end(), {"--bound", bound});
    return options;
  };
  const std::string how =
      ": write PARAMETER=LOWER,UPPER with a camera's parameter (f, fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6, xi, alpha), as in "
      "--bound k3=-1,1 or --bound left.fx=400,600";
  expectRefused(Files(), with("gravity=9,10"), "--bound gravity=9,10" + how);
  expectRefused(Files(), with("k3"), "--bound k3" + how);
  expectRefused(Files(), with("k3=1"), "--bound k3=1: the value must be 2 numbers separated by commas");
  expectRefused(Files(), with("k3=1,-1"), "--bound k3=1,-1: the lower limit must be below the upper one");
}
TEST(CalibrateFaults, ValuesThatNoCameraHas) {
  const auto refused = [](const std::string& option, const std::string& value, const std::string& why) {
    std::vector<std::string> options = usual();
    options.back() = "opencv5";
    options.insert(options.end(), {option, value});
    expectRefused(Files(), options, option + " " + value + ": " + why);
  };
  const std::string focal = "a focal length lies between 0.001 and 1e+09 px";
  for (const std::string value : {"0", "-500", "1e-300", "1e10"})
    refused("--fix", "fx=" + value, focal + "; give such a value");
  refused("--fix", "left.cy=1e7", "the principal point lies between -1e+06 and 1e+06 px; give such a value");
  refused("--fix", "k1=-1e200",
          "a coefficient of distortion lies between -1e+06 and 1e+06; give such a value");
  for (const std::string value : {"0,1e-300", "-500,-400", "1e10,1e11"})
    refused("--bound", "fx=" + value, focal + ", and these limits allow none of that; give others");
}
TEST(CalibrateFaults, Formats) {
  const auto with = [](std::vector<std::string> more) {
    std::vector<std::string> options{
        "--camera", "left=DIR/left.csv", "--camera", "right=DIR/right.csv", "--intrinsics", "opencv4"};
    options.insert(options.end(), more.begin(), more.end());
    return options;
  };
  expectRefused(Files(), with({"--format", "ros"}),
                "--format ros: no output file is given; add --output FILE or drop --format");
  expectRefused(Files(), with({"--format", "matlab", "--output", "DIR/c.yaml"}),
                "--format matlab: the formats are opencv, ros, kalibr, openvins and basalt");
  expectRefused(
      Files(), with({"--format", "ros", "--output", "DIR/c.yaml"}),
      "--output c.yaml: ROS needs one file for each camera; write {name} in place of the camera's name, as in --output "
      "'{name}.yaml'");
  expectRefused(
      Files(), with({"--output", "DIR/{name}.yaml"}),
      "--output {name}.yaml: camera_info needs the image size, which left.csv does not state; give it, as "
      "in --image-size left=640x480");
  expectRefused(
      Files(), with({"--output", "DIR/camchain.yaml", "--image-size", "left=640x480"}),
      "--output camchain.yaml: a camchain needs the image size, which right.csv does not state; give it, "
      "as in --image-size right=640x480");
  expectRefused(
      Files(), {"--camera", "left=DIR/left.csv", "--output", "DIR/camchain.yaml"},
      "--output camchain.yaml: Kalibr has no distortion model like opencv5; calibrate with --intrinsics opencv4 (its radtan) or "
      "fisheye (its equidistant)");
  for (const std::string size : {"640", "left=1x14000000", "left=0x480"}) {
    expectRefused(
        Files(), with({"--image-size", size}),
        "--image-size " + size +
            ": write NAME=WIDTHxHEIGHT, as in --image-size left=640x480, 100000 pixels at most on a side");
  }
  expectRefused(Files(), with({"--image-size", "top=640x480"}),
                "--image-size top=640x480: there is no camera top; correct the name: left, right");
  expectRefused(
      Files(), with({"--image-size", "1500x1500", "right=1500x1400", "1400x1500"}),
      "--image-size 1400x1500: there are two sizes without a camera's name; write NAME=WIDTHxHEIGHT");
  expectRefused(Files(), with({"--image-size", "left=1500x1500", "left=1500x1400"}),
                "--image-size left=1500x1400: the size of camera left is given twice; keep one");
  Files stated;
  stated.left = "# image_size_px: 1500 x 1500\n" + stated.left;
  expectRefused(stated, with({"--image-size", "1600x1500"}),
                "--image-size left=1600x1500: left.csv: images have 1500 x 1500 pixels; drop this option, or "
                "correct the file");
  for (const std::string size : {"wide", "1 x 14000000", "640x", "640 480", "-1 x 2", "640 x 480 px"}) {
    Files files;
    files.left = "# image_size_px: " + size + "\n" + files.left;
    expectRefused(files, with({}),
                  "left.csv:1: the image size is \"image_size_px: " + size +
                      "\"; write it as in # image_size_px: 640 x 480, 100000 pixels at most on a side");
  }
  for (const std::string comment : {"image_size: 640 x 480", "Image size: 640x480", "image-size 640, 480"}) {
    Files files;
    files.left = "# " + comment + "\n" + files.left;
    expectRefused(files, with({}),
                  "left.csv:1: the image size is \"" + comment +
                      "\"; write it as in # image_size_px: 640 x 480, 100000 pixels at most on a side");
  }
  Files comments;  // about something else
  comments.left = "# image sizes differ\n" + comments.left;
  EXPECT_EQ(runIn(slom::testing::TemporaryFolder(), comments, usual()).exit_code, 0);
}
TEST(CalibrateFaults, UnknownOption) {
  expectRefused(
      Files(), {"--cameras", "left=DIR/left.csv"},
      "The following arguments were not expected: --cameras left=left.csv; see slom calibrate --help");
}

TEST(CalibrateFaults, AFileWithoutAnOption) {
  expectRefused(
      Files(), {"DIR/left.csv"},
      "left.csv: the file belongs to no camera; pass --camera NAME=left.csv for corners, or --images "
      "NAME=left.csv for photographs");
}
TEST(CalibrateFaults, SigmaBy) {
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--sigma-by", "colour"},
                "--sigma-by colour: unknown quantity; give constant, speed, slant or distance");
}

TEST(CalibrateFaults, OutputsThatCannotBeWritten) {
  expectRefused(
      Files(), {"--camera", "left=DIR/left.csv", "--json", "DIR/no/such/folder.json", "--quiet"},
      "cannot write no/such/folder.json: No such file or directory; name a file in a folder that exists "
      "and may be written");
  expectRefused(
      Files(),
      {"--camera", "left=DIR/left.csv", "--json", "DIR/result.json", "--output", "DIR/no/such.yaml",
       "--quiet"},
      "cannot write no/such.yaml: No such file or directory; name a file in a folder that exists and may "
      "be written");
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--json", "DIR/."},
                "--json .: this is a folder; give the name of a file");
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--output", "/dev/stdout"},
                "--output /dev/stdout: this is a device or a pipe; give the name of a file");
}
TEST(CalibrateFaults, OutputsOverInputs) {
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--json", "DIR/./left.csv"},
                "--json ./left.csv: this is the file of --camera left too; give another one");
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--json", "DIR/r", "--output", "DIR/r"},
                "--output r: this is the file of --json too; give another one");
  const TemporaryFolder folder;
  const Files files;
  runIn(folder, files, {"--camera", "left=DIR/left.csv", "--json", "DIR/left.csv"});
  EXPECT_EQ(slom::testing::readFile(folder / "left.csv"), files.left);
}

TEST(CalibrateFaults, AFailedRunLeavesTheOldResultAlone) {
  const TemporaryFolder folder;
  slom::testing::writeFile(folder / "result.json", "the old one");
  Files files;
  files.left = corner_header;
  EXPECT_EQ(runIn(folder, files, usual()).exit_code, 2);
  EXPECT_EQ(slom::testing::readFile(folder / "result.json"), "the old one");
}

TEST(CalibrateFaults, AFitThatDoesNotConvergeSaysSo) {
  const TemporaryFolder folder;
  auto options = usual();
  options.insert(options.end(), {"--max-iterations", "1"});
  options.erase(std::find(options.begin(), options.end(), "--quiet"));
  const auto result = runIn(folder, Files(), options);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.errors, "slom: the calibration failed: iteration limit of 1 reached\n");
  EXPECT_NE(result.output.find("NOT CONVERGED after 1 iteration"), std::string::npos) << result.output;
  EXPECT_NE(slom::testing::readFile(folder / "result.json").find("\"converged\": false"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "result.yaml"));
}

/// Photographs of different moments under one number. A fit of them may converge, but is unusable.
TEST(CalibrateFaults, ImagesThatContradictEachOther) {
  const std::string left = slom::testing::sourcePath("data/opencv_stereo/left_corners.csv"),
                    right = slom::testing::readFile(
                        slom::testing::sourcePath("data/opencv_stereo/right_corners.csv"));
  const auto calibrated = [&](const TemporaryFolder& folder, const std::function<int(int)>& number) {
    std::istringstream lines(right);
    std::ostringstream changed;
    for (std::string line; std::getline(lines, line);) {
      const std::size_t comma = line.find(',');
      const bool is_row = line[0] >= '0' && line[0] <= '9';
      changed << (is_row ? std::to_string(number(std::stoi(line))) + line.substr(comma) : line) << '\n';
    }
    slom::testing::writeFile(folder / "right.csv", changed.str());
    return testing::runCalibrate(
        {"--camera", "left=" + left, "--camera", "right=" + (folder / "right.csv").string(), "--json",
         (folder / "result.json").string(), "--output", (folder / "result.yaml").string(), "--quiet"});
  };
  const auto expectContradiction = [&](const std::function<int(int)>& number, const std::string& expected) {
    const TemporaryFolder folder;
    const auto result = calibrated(folder, number);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_TRUE(std::regex_match(result.errors, std::regex(expected + "\n"))) << result.errors;
    EXPECT_TRUE(std::filesystem::exists(folder / "result.json"));
    EXPECT_FALSE(std::filesystem::exists(folder / "result.yaml"));
  };
  // This fit converges, that of two swapped images may, and that of one image less for all does not.
  expectContradiction(
      [](int i) { return i < 11    ? i
                         : i == 14 ? 11
                                   : i + 1; },
      "slom: the calibration (is unusable|failed): images right.1[0-9](, right.1[0-9]){1,2} and right.1[0-9] "
      "contradict the others by [0-9]+ to [0-9]+ px; correct their numbers or leave them out by --exclude");
  expectContradiction(
      [](int i) { return i == 12   ? 13
                         : i == 13 ? 12
                                   : i; },
      "slom: the calibration (is unusable|failed): images right.12 and right.13 contradict the others by 78 px; "
      "correct their numbers or leave them out by --exclude");
  expectContradiction(
      [](int i) { return i + 1; },
      "slom: the calibration failed: images (right.[0-9]+, ){4}right.[0-9]+ and [0-9]+ more contradict the "
      "others by [0-9]+ to [0-9]+ px; correct their numbers or leave them out by --exclude");
  const TemporaryFolder folder;
  EXPECT_EQ(calibrated(folder, [](int i) { return i; }).exit_code, 0);
}

/// Two views of a board that is parallel in both: intrinsics are not determined.
TEST(CalibrateFaults, ParametersThatAreNotDeterminedAreNamed) {
  testing::RigOptions options;
  options.cameras = 1;
  options.distorted = false;
  options.sigma_px = 0;
  std::mt19937_64 random(1);
  testing::RigTruth truth = testing::simulateTruth(options, random);
  truth.left2world.clear();
  for (int i = 1; i <= 4; ++i) {
    truth.left2world[i] = SE3(SO3::exp(vec3(M_PI, 0., 0.)), vec3(-0.15 + 0.02 * i, 0.12, 0.6));
  }
  const Dataset data = testing::simulateMeasurements(truth, options, random);
  const TemporaryFolder folder;
  slom::testing::writeFile(folder / "a.csv", testing::cornerFile(data.cameras[0]));
  const auto result = testing::runCalibrate({"--camera", "a=" + (folder / "a.csv").string(), "--json",
                                             (folder / "result.json").string(), "--intrinsics", "radial1"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.output.find("Not all parameters are determined"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("not determined"), std::string::npos) << result.output;
  EXPECT_NE(slom::testing::readFile(folder / "result.json").find("\"std\": null"), std::string::npos);
}

}  // namespace
}  // namespace slom::app::calib
