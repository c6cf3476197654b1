// Every mistake in options or data: one sentence that says where and what to do, exit code 2, and no file written.
// Files are named with the folder replaced by nothing, so that the whole sentence can be compared.
#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "calibrate/calibrate_command.hpp"
#include "calibrate/fit/calibration.hpp"
#include "error.hpp"

namespace slom::app::calib {
namespace {

using testing::corner_header;
using testing::imu_header;
using testing::TemporaryFolder;

/// A small stereo rig with an IMU, whose files each test spoils in its way.
struct Files {
  std::string left, right, imu;

  Files() {
    testing::RigOptions options;
    options.images = 3;
    options.columns = options.rows = 4;
    options.square_m = 0.08;
    std::mt19937_64 random(1);
    const auto truth = testing::simulateTruth(options, random);
    const Dataset data = testing::simulateMeasurements(truth, options, random);
    left = testing::cornerFile(data.cameras[0]);
    right = testing::cornerFile(data.cameras[1]);
    imu = testing::imuFile(*data.imu);
  }
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size()) {
    text.replace(at, what.size(), by);
  }
  return text;
}

/// Line `number` (from 1) replaced; "" removes it.
std::string withLine(const std::string& text, int number, const std::string& line) {
  std::size_t begin = 0;
  for (int i = 1; i < number; ++i) begin = text.find('\n', begin) + 1;
  const std::size_t end = text.find('\n', begin) + 1;
  return text.substr(0, begin) + (line.empty() ? "" : line + "\n") + text.substr(end);
}

/// The rows (below the header) that `keep(image, corner)` accepts.
template <class Keep>
std::string filtered(const std::string& text, Keep keep) {
  std::string result;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = text.find('\n', begin) + 1;
    const std::string line = text.substr(begin, end - begin);
    int image = 0, corner = 0;
    if (std::sscanf(line.c_str(), "%d,%d,", &image, &corner) != 2 || keep(image, corner)) result += line;
    begin = end;
  }
  return result;
}

/// Runs with the three files and `options`, which may name them by DIR/left.csv and so on.
testing::CommandResult runIn(const TemporaryFolder& folder, const Files& files, std::vector<std::string> options) {
  slom::testing::writeFile(folder / "left.csv", files.left);
  slom::testing::writeFile(folder / "right.csv", files.right);
  slom::testing::writeFile(folder / "imu.csv", files.imu);
  for (std::string& option : options) option = replaced(option, "DIR", folder.path().string());
  auto result = testing::runCalibrate(options);
  result.errors = replaced(result.errors, folder.path().string() + "/", "");
  return result;
}

std::vector<std::string> usual() {
  return {"--camera", "left=DIR/left.csv", "--camera", "right=DIR/right.csv", "--imu",    "DIR/imu.csv",
          "--json",   "DIR/result.json",   "--output", "DIR/result.yaml",     "--quiet", "--intrinsics",
          "radial1"};
}

void expectRefused(const Files& files, const std::vector<std::string>& options, const std::string& sentence) {
  const TemporaryFolder folder;
  const auto result = runIn(folder, files, options);
  EXPECT_EQ(result.errors, "slom: " + sentence + "\n");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.output, "");
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    const std::string name = entry.path().filename();
    EXPECT_TRUE(name == "left.csv" || name == "right.csv" || name == "imu.csv") << name << " was written all the same";
  }
}

void expectDataRefused(const Files& files, const std::string& sentence) { expectRefused(files, usual(), sentence); }

TEST(CalibrateFaults, TheUnspoiltFilesAreFine) {
  const TemporaryFolder folder;
  const auto result = runIn(folder, Files(), usual());
  EXPECT_EQ(result.errors, "");
  EXPECT_EQ(result.output, "");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "result.json"));
  EXPECT_TRUE(std::filesystem::exists(folder / "result.yaml"));
}

TEST(CalibrateFaults, MissingFile) {
  expectRefused(Files(), {"--camera", "left=DIR/lost.csv", "--json", "DIR/result.json"},
                "lost.csv: cannot be read (No such file or directory); check the path");
}
TEST(CalibrateFaults, MissingImuFile) {
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--imu", "DIR/lost.csv"},
                "lost.csv: cannot be read (No such file or directory); check the path");
}
TEST(CalibrateFaults, FolderForAFile) {
  const TemporaryFolder folder;
  const auto result = testing::runCalibrate({"--camera", "left=" + folder.path().string()});
  EXPECT_EQ(result.errors, "slom: " + folder.path().string() + ": cannot be read (Is a directory); check the path\n");
  EXPECT_EQ(result.exit_code, 2);
}
TEST(CalibrateFaults, EmptyFile) {
  Files files;
  files.left = "";
  expectDataRefused(files,
                    "left.csv:1: the file is empty; its first line must be \"image,corner,world_x_m,world_y_m,"
                    "world_z_m,u_px,v_px\", with one row for each measurement below");
}
TEST(CalibrateFaults, HeaderAlone) {
  Files files;
  files.left = corner_header;
  expectDataRefused(files, "left.csv:1: there is nothing below the header; add one row for each measurement");
}
TEST(CalibrateFaults, WrongHeader) {
  Files files;
  files.left = replaced(files.left, "world_x_m", "x");
  expectDataRefused(files,
                    "left.csv:1: the header is \"image,corner,x,world_y_m,world_z_m,u_px,v_px\"; it must be "
                    "\"image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px\"");
}
TEST(CalibrateFaults, ImuFileForACamera) {
  expectRefused(Files(), {"--camera", "left=DIR/imu.csv"},
                "imu.csv:1: the header is \"image,ax_m_s2,ay_m_s2,az_m_s2,valid\"; it must be "
                "\"image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px\"");
}
TEST(CalibrateFaults, TooFewFields) {
  Files files;
  files.left = withLine(files.left, 5, "1,4,0.24,0,0,100");
  expectDataRefused(files,
                    "left.csv:5: the row has 6 fields instead of 7; write "
                    "\"image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px\"");
}
TEST(CalibrateFaults, TextForANumber) {
  Files files;
  files.left = withLine(files.left, 5, "1,4,0.24,0,0,hundred,100");
  expectDataRefused(files, "left.csv:5: u_px is \"hundred\"; write a number there, or remove the row");
}
TEST(CalibrateFaults, NumberWithTextBehindIt) {
  Files files;
  files.left = withLine(files.left, 5, "1,4,0.24,0,0,100px,100");
  expectDataRefused(files, "left.csv:5: u_px is \"100px\"; write a number there, or remove the row");
}
TEST(CalibrateFaults, NothingForANumber) {
  Files files;
  files.left = withLine(files.left, 5, "1,4,0.24,0,0,100,");
  expectDataRefused(files, "left.csv:5: v_px is \"\"; write a number there, or remove the row");
}
TEST(CalibrateFaults, NotANumber) {
  Files files;
  files.right = withLine(files.right, 7, "1,6,nan,0.08,0,100,100");
  expectDataRefused(files, "right.csv:7: world_x_m is \"nan\"; write a finite number there, or remove the row");
}
TEST(CalibrateFaults, Infinity) {
  Files files;
  files.right = withLine(files.right, 7, "1,6,0.08,0.08,0,100,-inf");
  expectDataRefused(files, "right.csv:7: v_px is \"-inf\"; write a finite number there, or remove the row");
}
TEST(CalibrateFaults, TextForAnImage) {
  Files files;
  files.left = withLine(files.left, 5, "left01.jpg,4,0.24,0,0,100,100");
  expectDataRefused(files, "left.csv:5: image is \"left01.jpg\"; write a whole number (0, 1, 2, ...) there");
}
TEST(CalibrateFaults, FractionForACorner) {
  Files files;
  files.left = withLine(files.left, 5, "1,4.5,0.24,0,0,100,100");
  expectDataRefused(files, "left.csv:5: corner is \"4.5\"; write a whole number (0, 1, 2, ...) there");
}
TEST(CalibrateFaults, CornerListedTwice) {
  Files files;
  files.left = withLine(files.left, 5, "1,3,0.24,0,0,100,100");
  expectDataRefused(files,
                    "left.csv:5: corner 3 of image 1 was listed in line 4 already; remove one of the two rows");
}
TEST(CalibrateFaults, FewerThanFourCorners) {
  Files files;
  files.left = filtered(files.left, [](int image, int corner) { return image != 2 || corner <= 3; });
  expectDataRefused(files,
                    "left.csv:18: image 2 has only 3 corners; a pose needs at least 4, so add corners or remove the "
                    "image");
}
TEST(CalibrateFaults, OneCorner) {
  Files files;
  files.left = filtered(files.left, [](int image, int corner) { return image != 2 || corner == 7; });
  expectDataRefused(files,
                    "left.csv:18: image 2 has only 1 corner; a pose needs at least 4, so add corners or remove the "
                    "image");
}
TEST(CalibrateFaults, AllPointsOnALine) {
  Files files;
  files.left = filtered(files.left, [](int image, int corner) { return image != 2 || corner <= 4; });
  expectDataRefused(files,
                    "left.csv:18: image 2: all its world points, or all but one, lie on a line; a pose needs at least "
                    "two off it, so add corners or remove the image");
}
TEST(CalibrateFaults, AllPointsButOneOnALine) {
  Files files;
  files.left = filtered(files.left, [](int image, int corner) { return image != 2 || corner <= 5; });
  expectDataRefused(files,
                    "left.csv:18: image 2: all its world points, or all but one, lie on a line; a pose needs at least "
                    "two off it, so add corners or remove the image");
}
TEST(CalibrateFaults, AllPixelsOnALine) {
  Files files;
  for (int line = 18; line <= 33; ++line) {
    const int k = line - 18;
    files.left = withLine(files.left, line,
                          fmt::format("2,{},{},{},0,{},{}", k + 1, 0.08 * (k % 4), 0.08 * (k / 4), 100 + 10 * k, 200 + 5 * k));
  }
  expectDataRefused(files,
                    "left.csv:18: image 2: all its pixels, or all but one, lie on a line, as of a board seen from its "
                    "edge; remove the image");
}
TEST(CalibrateFaults, PointsNotInAPlane) {
  Files files;
  files.left = withLine(files.left, 20, "2,3,0.16,0,0.15,100,100");
  expectDataRefused(files,
                    "left.csv:18: image 2: its world points do not lie in a plane (they are off by 0.033 m); the start "
                    "values need a flat board, so correct the points or remove the image");
}
TEST(CalibrateFaults, OneImage) {
  Files files;
  files.right = filtered(files.right, [](int image, int) { return image == 2; });
  expectDataRefused(files,
                    "right.csv:2: image 2 is the only one of camera right; its intrinsics need at least 2 images from "
                    "different directions, so add images");
}
TEST(CalibrateFaults, TooFewCornersForTheModel) {
  Files files;
  files.left = filtered(files.left, [](int image, int corner) {
    return image < 3 && (corner == 1 || corner == 4 || corner == 13 || corner == 16);
  });
  expectRefused(files, {"--camera", "left=DIR/left.csv", "--json", "DIR/result.json", "--quiet"},
                "left.csv:2: the corners give 16 numbers for 21 unknowns of the model opencv5; add images or corners, or "
                "choose a model with fewer parameters by --intrinsics");
}
TEST(CalibrateFaults, CameraWithoutCommonImage) {
  Files files;
  files.right = replaced(replaced(replaced(files.right, "\n1,", "\n11,"), "\n2,", "\n12,"), "\n3,", "\n13,");
  expectDataRefused(files,
                    "right.csv:2: camera right has no image in common with camera left, nor with one that has; take "
                    "images of the board with both at the same time, or calibrate them apart");
}
TEST(CalibrateFaults, ImuRowForAnUnknownImage) {
  Files files;
  files.imu += "7,0,0,9.81,1\n";
  expectDataRefused(files,
                    "imu.csv:5: there are no corners of image 7 in any camera; correct the number, or set valid to 0");
}
TEST(CalibrateFaults, ImuRowForAnUnknownImageThatIsNotValidIsNoFault) {
  Files files;
  files.imu += "7,,nan,nobody looks at this,0\n";
  const TemporaryFolder folder;
  const auto result = runIn(folder, files, usual());
  EXPECT_EQ(result.errors, "");
  EXPECT_EQ(result.exit_code, 0);
}
TEST(CalibrateFaults, ImuImageListedTwice) {
  Files files;
  files.imu += "2,0,0,9.81,1\n";
  expectDataRefused(files, "imu.csv:5: image 2 has a valid reading in line 3 already; keep one, or the mean of both");
}
TEST(CalibrateFaults, ImuValidNeitherZeroNorOne) {
  Files files;
  files.imu = withLine(files.imu, 3, "2,0,0,9.81,2");
  expectDataRefused(files, "imu.csv:3: valid is \"2\"; write 1, or 0 to skip the row");
}
TEST(CalibrateFaults, ImuTextForANumber) {
  Files files;
  files.imu = withLine(files.imu, 3, "2,0,zero,9.81,1");
  expectDataRefused(files, "imu.csv:3: ay_m_s2 is \"zero\"; write a number there, or remove the row");
}
TEST(CalibrateFaults, ImuWithoutValidRow) {
  Files files;
  files.imu = imu_header + "1,0,0,0,0\n2,0,0,0,0\n";
  expectDataRefused(files,
                    "imu.csv:3: no row has valid = 1; leave out --imu, or mark the readings that can be used");
}
TEST(CalibrateFaults, ImuNotDetermined) {
  Files files;
  files.imu = withLine(withLine(files.imu, 3, ""), 3, "");
  expectDataRefused(files,
                    "imu.csv:2: 1 valid reading of tilts that spread by 0 deg do not determine the orientation of the "
                    "IMU, acc_bias, gravity; add readings at other tilts, about more than one axis");
}

TEST(CalibrateFaults, NoCamera) {
  expectRefused(Files(), {"--imu", "DIR/imu.csv"},
                "no --camera; give at least one, as in --camera left=left_corners.csv");
}
TEST(CalibrateFaults, CameraSyntax) {
  for (const std::string text : {"left", "left=", "=left.csv"}) {
    expectRefused(Files(), {"--camera", text},
                  "--camera " + text + ": write NAME=FILE, as in --camera left=left_corners.csv");
  }
  for (const std::string text : {"1=a.csv", "left cam=a.csv", "l\"=a.csv"}) {
    expectRefused(Files(), {"--camera", text},
                  "--camera " + text + ": the name must begin with a letter and hold letters, digits, _ and - only; "
                  "rename the camera");
  }
}
TEST(CalibrateFaults, CameraNamedTwice) {
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--camera", "left=DIR/right.csv"},
                "--camera left=right.csv: there is a camera left already; give each its own name");
}
TEST(CalibrateFaults, UnknownModel) {
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--intrinsics", "fisheye"},
                "--intrinsics fisheye: the models are opencv5, opencv4 and radial1");
}
TEST(CalibrateFaults, Sigmas) {
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--sigma-px", "0"},
                "--sigma-px 0: a standard deviation must be positive");
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--sigma-acc", "-1"},
                "--sigma-acc -1: a standard deviation must be positive");
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
  expectRefused(Files(), with({"--fix", "k3"}),
                "--fix k3: nothing is called \"k3\"; what can be fixed is acc_bias and gravity");
  expectRefused(Files(), with({"--fix", "gravity=-9.81"}),
                "--fix gravity=-9.81: give the magnitude of gravity, a positive number in m/s^2; its sign is found "
                "from the data");
  expectRefused(Files(), with({"--fix", "gravity=g"}), "--fix gravity=g: the value must be a number");
  expectRefused(Files(), with({"--fix", "gravity="}), "--fix gravity=: the value must be a number");
  expectRefused(Files(), with({"--fix", "acc_bias=0,0"}),
                "--fix acc_bias=0,0: the value must be 3 numbers separated by commas");
  expectRefused(Files(), with({"--fix", "gravity", "--fix", "gravity=9.8"}),
                "--fix gravity=9.8: gravity is fixed already; give it once");
  expectRefused(Files(), with({"--fix", "acc_bias", "--fix", "acc_bias"}),
                "--fix acc_bias: acc_bias is fixed already; give it once");
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--fix", "gravity"},
                "--fix gravity: there is no IMU to fix it for; add --imu FILE, or leave out --fix");
}
TEST(CalibrateFaults, UnknownOption) {
  expectRefused(Files(), {"--cameras", "left=DIR/left.csv"},
                "The following arguments were not expected: left=left.csv --cameras; see slom calibrate --help");
}

TEST(CalibrateFaults, OutputsThatCannotBeWritten) {
  expectRefused(Files(), {"--camera", "left=DIR/left.csv", "--json", "DIR/no/such/folder.json", "--quiet"},
                "cannot write no/such/folder.json: No such file or directory; name a file in a folder that exists and "
                "may be written");
  expectRefused(Files(),
                {"--camera", "left=DIR/left.csv", "--json", "DIR/result.json", "--output", "DIR/no/such.yaml", "--quiet"},
                "cannot write no/such.yaml: No such file or directory; name a file in a folder that exists and may be "
                "written");
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
    truth.left2world[i] = SE3(SO3::exp(vec3(M_PI, 0., 0.)), vec3(0.15 + 0.02 * i, 0.12, 0.6));
  }
  const Dataset data = testing::simulateMeasurements(truth, options, random);
  const TemporaryFolder folder;
  slom::testing::writeFile(folder / "a.csv", testing::cornerFile(data.cameras[0]));
  const auto result = testing::runCalibrate({"--camera", "a=" + (folder / "a.csv").string(), "--json",
                                             (folder / "result.json").string(), "--intrinsics", "radial1"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.output.find("Not all parameters are determined"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("not determined"), std::string::npos);
  EXPECT_NE(slom::testing::readFile(folder / "result.json").find("\"std\": null"), std::string::npos);
}

}  // namespace
}  // namespace slom::app::calib
