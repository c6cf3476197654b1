// Every mistake in the data gives one sentence with place and remedy, exit code 2, and no file.
#include <filesystem>
#include <numbers>
#include <random>
#include <regex>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "calibrate/faults.hpp"

namespace slom::app::calib {
namespace {

using testing::corner_header;
using testing::expectDataRefused;
using testing::expectRefused;
using testing::Files;
using testing::filtered;
using testing::imu_header;
using testing::replaced;
using testing::runIn;
using testing::TemporaryFolder;
using testing::usual;
using testing::withLine;

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
  EXPECT_EQ(result.errors,
            "slom: " + folder.path().string() + ": cannot be read (Is a directory); check the path\n");
  EXPECT_EQ(result.exit_code, 2);
}
TEST(CalibrateFaults, EmptyFile) {
  Files files;
  files.left = "";
  expectDataRefused(
      files,
      "left.csv:1: the file is empty; its first line must be "
      "\"image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px\", with one row for each measurement below");
}
/// Only a table has a header to be told of.
TEST(CalibrateFaults, EmptyFileOfAnotherFormat) {
  const slom::testing::TemporaryFolder folder;
  for (const std::string name : {"empty.vnl", "empty.yml", "empty.json", "empty.xml"}) {
    slom::testing::writeFile(folder / name, "");
    const auto result = testing::runCalibrate({"--camera", "cam=" + (folder / name).string()});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.errors.find(name + ":1: the file is empty; write it again, or leave it out\n"),
              std::string::npos)
        << result.errors;
  }
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
                    "left.csv:1: the header is \"image,corner,x,world_y_m,world_z_m,u_px,v_px\"; it must "
                    "be \"image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px\"");
}
TEST(CalibrateFaults, PhotographForATable) {
  using namespace std::string_literals;
  for (const std::string& beginning : {"\xFF\xD8\xFF\xE0\0\x10JFIF"s, "\x89PNG\r\n"s, "II*\0"s, "MM\0*"s,
                                       "BM\0\1"s, "P5\n2 1\n255\n\xFF\0"s}) {
    Files files;
    files.left = beginning + files.left;
    expectDataRefused(
        files,
        "left.csv: this is a photograph instead of a table with the header "
        "\"image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px\"; slom calibrate takes photographs by "
        "--images");
  }
  Files files;
  files.left = "a\0b"s + files.left;
  expectDataRefused(
      files,
      "left.csv:1: the header is \"a?bimage,corner,world_x_m,world_y_m,world_z_m,u_px,v_px\"; it must be "
      "\"image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px\"");
}
TEST(CalibrateFaults, ImuFileForACamera) {
  expectRefused(Files(), {"--camera", "left=DIR/imu.csv"},
                "imu.csv:1: the header is \"image,ax_m_s2,ay_m_s2,az_m_s2,valid\"; it must be "
                "\"image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px\"");
}
TEST(CalibrateFaults, HeaderWithTimesOrWithoutPlaces) {
  Files files;
  files.left = "t_ns,corner,u,v\n0,0,1,2\n";
  expectDataRefused(files,
                    "left.csv:1: the header is \"t_ns,corner,u,v\"; it must be \"t_ns,corner,u_px,v_px\"");
  files.left = "image,id,u_px,v_px\n0,0,1,2\n";
  expectDataRefused(
      files, "left.csv:1: the header is \"image,id,u_px,v_px\"; it must be \"image,corner,u_px,v_px\"");
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
  expectDataRefused(files,
                    "right.csv:7: world_x_m is \"nan\"; write a finite number there, or remove the row");
}
TEST(CalibrateFaults, Infinity) {
  Files files;
  files.right = withLine(files.right, 7, "1,6,0.08,0.08,0,100,-inf");
  expectDataRefused(files, "right.csv:7: v_px is \"-inf\"; write a finite number there, or remove the row");
}
TEST(CalibrateFaults, CoordinatesThatCannotBe) {
  Files files;
  files.right = withLine(files.right, 7, "1,6,0.08,0.08,0,100,1e155");
  expectDataRefused(
      files, "right.csv:7: v_px is \"1e155\"; write a number from -1e+06 to 1e+06 there, or remove the row");
  files.right = withLine(files.right, 7, "1,6,0.08,0.08,0,-1000001,100");
  expectDataRefused(
      files,
      "right.csv:7: u_px is \"-1000001\"; write a number from -1e+06 to 1e+06 there, or remove the row");
  files.right = withLine(files.right, 7, "1,6,0.08,-1e200,0,100,100");
  expectDataRefused(
      files,
      "right.csv:7: world_y_m is \"-1e200\"; write a number from -1e+06 to 1e+06 there, or remove the row");
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
  expectDataRefused(
      files, "left.csv:5: corner 3 of image 1 was listed in line 4 already; remove one of the two rows");
}
TEST(CalibrateFaults, FewerThanFourCorners) {
  Files files;
  files.left = filtered(files.left, [](int image, int corner) { return image != 2 || corner <= 3; });
  expectDataRefused(
      files,
      "left.csv:18: image 2 has only 3 corners; a pose needs at least 4, so add corners or remove the image");
}
TEST(CalibrateFaults, OneCorner) {
  Files files;
  files.left = filtered(files.left, [](int image, int corner) { return image != 2 || corner == 7; });
  expectDataRefused(
      files,
      "left.csv:18: image 2 has only 1 corner; a pose needs at least 4, so add corners or remove the image");
}
TEST(CalibrateFaults, AllPointsOnALine) {
  Files files;
  files.left = filtered(files.left, [](int image, int corner) { return image != 2 || corner <= 4; });
  expectDataRefused(
      files,
      "left.csv:18: image 2: all world points, or all but one, lie on a line; a pose needs at least two "
      "points off the line, so add corners or remove the image");
}
TEST(CalibrateFaults, AllPointsButOneOnALine) {
  Files files;
  files.left = filtered(files.left, [](int image, int corner) { return image != 2 || corner <= 5; });
  expectDataRefused(
      files,
      "left.csv:18: image 2: all world points, or all but one, lie on a line; a pose needs at least two "
      "points off the line, so add corners or remove the image");
}
TEST(CalibrateFaults, AllPixelsOnALine) {
  Files files;
  for (int line = 18; line <= 33; ++line) {
    const int k = line - 18;
    files.left = withLine(
        files.left, line,
        fmt::format("2,{},{},{},0,{},{}", k + 1, 0.08 * (k % 4), 0.08 * (k / 4), 100 + 10 * k, 200 + 5 * k));
  }
  expectDataRefused(
      files,
      "left.csv:18: image 2: all pixels, or all but one, lie on a line, as if the board were seen edge-on; "
      "remove the image");
}
TEST(CalibrateFaults, PointsNotInAPlane) {
  Files files;
  files.left = withLine(files.left, 20, "2,3,0.16,0,0.15,100,100");
  expectDataRefused(
      files,
      "left.csv:18: image 2: the world points do not lie in a plane (they are off by 0.033 m); the start "
      "values need a flat board, so correct the points or remove the image");
}
TEST(CalibrateFaults, OneImage) {
  Files files;
  files.right = filtered(files.right, [](int image, int) { return image == 2; });
  expectDataRefused(
      files,
      "right.csv:2: image 2 is the only one of camera right; its intrinsics need at least 2 images from "
      "different directions, so add images");
}
TEST(CalibrateFaults, TooFewCornersForTheModel) {
  Files files;
  files.left = filtered(files.left, [](int image, int corner) {
    return image < 3 && (corner == 1 || corner == 4 || corner == 13 || corner == 16);
  });
  expectRefused(files, {"--camera", "left=DIR/left.csv", "--json", "DIR/result.json", "--quiet"},
                "left.csv:2: the corners give 16 numbers for 21 unknowns of the model opencv5; add images "
                "or corners, or choose a model with fewer parameters by --intrinsics");
}
/// Returns eight images of a board that is always tilted by the same angle about the camera's x axis, but turned and
/// moved. The noise is 0.2 px.
std::string parallelBoards(double tilt_deg) {
  std::mt19937 engine(3);
  std::normal_distribution<double> noise(0, 0.2);
  std::uniform_real_distribution<double> uniform;
  const SO3 tilt = SO3::exp(vec3(tilt_deg * std::numbers::pi / 180, 0, 0));
  std::string text = corner_header;
  for (int image = 1; image <= 8; ++image) {
    const SO3 turn = SO3::exp(vec3(0, 0, 0.3 * image));
    const vec3 place(0.15 * uniform(engine) - 0.1, 0.12 * uniform(engine) - 0.1, 0.5 + 0.4 * uniform(engine));
    for (int corner = 0; corner < 54; ++corner) {
      const vec3 world(0.025 * (corner % 9), 0.025 * (corner / 9), 0);
      const vec3 p = tilt * (turn * (world - vec3(0.1, 0.06, 0))) + place;
      text += fmt::format("{},{},{:.4f},{:.4f},0,{:.3f},{:.3f}\n", image, corner + 1, world[0], world[1],
                          600 * p[0] / p[2] + 320 + noise(engine), 600 * p[1] / p[2] + 240 + noise(engine));
    }
  }
  return text;
}
TEST(CalibrateFaults, AllViewsParallel) {
  for (const double tilt : {0.0, 20.0}) {
    Files files;
    files.left = parallelBoards(tilt);
    const TemporaryFolder folder;
    const auto result =
        runIn(folder, files, {"--camera", "left=DIR/left.csv", "--json", "DIR/result.json", "--quiet"});
    const std::regex sentence(
        "slom: the calibration failed: the data do not determine all parameters: all 8 images show the board at the same "
        "tilt, within (0\\.\\d+|1(\\.\\d)?) degrees, which leaves the focal length open\n");
    EXPECT_TRUE(std::regex_match(result.errors, sentence)) << result.errors;
    EXPECT_EQ(result.exit_code, 1);
    const auto json = nlohmann::json::parse(slom::testing::readFile(folder / "result.json"));
    EXPECT_TRUE(json["undetermined"].get<std::string>().starts_with("all 8 images show"));
    EXPECT_LE(json["iterations"], 20) << "a fit that is known to fail goes on";
  }
}
TEST(CalibrateFaults, CameraWithoutCommonImage) {
  Files files;
  files.right = replaced(replaced(replaced(files.right, "\n1,", "\n11,"), "\n2,", "\n12,"), "\n3,", "\n13,");
  expectDataRefused(
      files,
      "right.csv:2: no common images connect camera right with camera left, not even through other "
      "cameras; take images of the board with both at the same time, or calibrate them separately");
}
TEST(CalibrateFaults, ImuRowForAnUnknownImage) {
  Files files;
  files.imu += "7,0,0,9.81,1\n";
  expectDataRefused(
      files,
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
  expectDataRefused(
      files, "imu.csv:5: image 2 has a valid reading in line 3 already; keep one, or the mean of both");
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
TEST(CalibrateFaults, ImuReadingThatCannotBe) {
  Files files;
  files.imu = withLine(files.imu, 2, "1,0,1e200,9.8,1");
  expectDataRefused(
      files, "imu.csv:2: ay_m_s2 is \"1e200\"; write a number from -1e+06 to 1e+06 there, or remove the row");
}
TEST(CalibrateFaults, ImuWithoutValidRow) {
  Files files;
  files.imu = imu_header + "1,0,0,0,0\n2,0,0,0,0\n";
  expectDataRefused(files, "imu.csv:3: no row has valid = 1; drop --imu, or mark usable readings");
}
TEST(CalibrateFaults, ImuNotDetermined) {
  Files files;
  files.imu = withLine(withLine(files.imu, 3, ""), 3, "");
  expectDataRefused(
      files,
      "imu.csv:2: 1 valid reading of tilts that spread by 0 deg do not determine the orientation of the "
      "IMU, acc_bias, gravity; add readings at other tilts, about more than one axis");
}

}  // namespace
}  // namespace slom::app::calib
