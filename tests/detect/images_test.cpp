// slom calibrate on photographs: whole runs, and every mistake.
#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/stat.h>

#include "detect/rendered_board.hpp"
#include "support/paths.hpp"
#include "support/run_command.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace slom::app::calib {
namespace {

using nlohmann::json;
using slom::testing::CommandResult;
using slom::testing::readFile;
using slom::testing::TemporaryFolder;
using slom::testing::writeFile;
using testing::chessboard;
using testing::chessboardPicture;
using testing::placed;
using testing::Viewer;

const std::string opencv_samples = "/usr/share/doc/opencv-doc/examples/data";

/// A stereo camera looks at a board from six sides: left01.pgm, right01.pgm and so on.
struct StereoPhotos {
  Board board = chessboard(9, 6);
  Viewer left, right{{690, 690, 310, 245}, {640, 480}, false};
  SE3 left2right{SO3::exp(vec3(0.01, -0.04, 0.005)), vec3(-0.06, 0.001, 0.002)};

  std::vector<SE3> places() const {
    std::vector<SE3> result;
    for (const auto& [x, y] :
         {std::pair(0.05, 0.1), {0.6, 0.1}, {-0.5, 0.3}, {0.2, -0.6}, {-0.3, 0.5}, {0.4, 0.4}})
      result.push_back(
          placed(board, vec3(0.03 + 0.05 * x, -0.04 * y, 0.5 + 0.1 * x), x, y, 0.3 * x - 0.2 * y));
    return result;
  }

  /// Photographs are drawn once for all tests, which then copy them.
  static const TemporaryFolder& drawn() {
    static const TemporaryFolder folder;
    static const bool once = [] {
      const StereoPhotos photos;
      const auto places = photos.places();
      for (std::size_t i = 0; i < places.size(); ++i) {
        const auto picture = chessboardPicture(photos.board);
        testing::writePgm(folder / ("left0" + std::to_string(i + 1) + ".pgm"),
                          photos.left.photograph(places[i], picture));
        testing::writePgm(folder / ("right0" + std::to_string(i + 1) + ".pgm"),
                          photos.right.photograph(photos.left2right * places[i], picture));
      }
      return true;
    }();
    (void)once;
    return folder;
  }
};

struct Images : ::testing::Test {
  TemporaryFolder folder;

  void SetUp() override {
    for (const auto& entry : std::filesystem::directory_iterator(StereoPhotos::drawn().path()))
      std::filesystem::copy_file(entry.path(), folder / entry.path().filename());
  }

  /// In the folder; the pattern of each camera is `left*.pgm` and so on.
  CommandResult run(std::vector<std::string> options) const {
    std::vector<std::string> words{"/usr/bin/env", "-C", folder.path().string(),
                                   slom::testing::commandPath().string(), "calibrate"};
    words.insert(words.end(), options.begin(), options.end());
    return slom::testing::runCommand(words);
  }
  static std::vector<std::string> stereo(std::vector<std::string> more = {}) {
    std::vector<std::string> options{"--board", "9x6",      "--square",       "0.03",     "--intrinsics",
                                     "radial1", "--images", "left=left*.pgm", "--images", "right=right*.pgm"};
    options.insert(options.end(), more.begin(), more.end());
    return options;
  }
  json calibrated(std::vector<std::string> options) const {
    options.insert(options.end(), {"--json", "result.json", "--quiet"});
    const CommandResult result = run(options);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(result.errors, "");
    return json::parse(readFile(folder / "result.json"));
  }
  void expectRefused(const std::vector<std::string>& options, const std::string& sentence) const {
    const CommandResult result = run(options);
    EXPECT_EQ(result.errors, "slom: " + sentence + "\n");
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.output, "");
  }
};

TEST_F(Images, AreCalibratedFrom) {
  const json result = calibrated(stereo({"--fix", "k1"}));
  const StereoPhotos truth;
  for (const auto& [name, viewer] : {std::pair("left", truth.left), {"right", truth.right}}) {
    const json& camera = result["cameras"][name];
    EXPECT_EQ(camera["images"], 6);
    EXPECT_EQ(camera["corners"], 6 * 54);
    EXPECT_EQ(camera["image_size"], json({640, 480}));
    EXPECT_LT(result["rms_px"][name], 0.1);
    EXPECT_NEAR(camera["parameters"]["f"]["value"], viewer.camera.fx, 6);
    EXPECT_NEAR(camera["parameters"]["cx"]["value"], viewer.camera.cx, 5);
  }
  const json& pose = result["cameras"]["right"]["pose_from_left"];
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(pose["translation"][i], truth.left2right.pos[i], 1e-3);
}

TEST_F(Images, StoredCornersGiveTheSameCalibration) {
  json from_photos = calibrated(stereo({"--corners-out", "."}));
  EXPECT_TRUE(readFile(folder / "left_corners.csv").starts_with("# image_size_px: 640 x 480\nimage,corner,"))
      << "size and header";
  json from_corners = calibrated({"--intrinsics", "radial1", "--camera", "left=left_corners.csv", "--camera",
                                  "right=right_corners.csv"});
  for (json* result : {&from_photos, &from_corners}) {
    for (const std::string name : {"left", "right"}) (*result)["cameras"][name].erase("file");
    for (json& image : (*result)["images"])
      image["worst_corner"].erase("line"), image["worst_corner"].erase("place");
    (*result)["quality"].erase("seconds");
    for (json& corner : (*result)["quality"]["worst_corners"]) corner.erase("line"), corner.erase("place");
  }
  EXPECT_EQ(from_photos, from_corners);
}

TEST_F(Images, FilesMayBeListedAndCamerasNamedAgain) {
  const json by_pattern = calibrated(stereo());
  const json by_name = calibrated({"--board", "9x6", "--square", "0.03", "--intrinsics", "radial1",
                                   "--images", "left=left01.pgm", "left02.pgm", "left03.pgm",
                                   "right=right*.pgm", "--images", "left=left0[4-6].pgm"});
  EXPECT_EQ(by_name["rss"], by_pattern["rss"]);
}

TEST_F(Images, WithoutABoardOrUnreadableAreListedAndLeftOut) {
  const auto grey =
      StereoPhotos().left.photograph(StereoPhotos().places()[0], [](double, double) { return 0.4; });
  testing::writePgm(folder / "left07.pgm", grey);
  writeFile(folder / "left08.pgm", "");
  writeFile(folder / "left09.pgm", "P5\n640 480\n255\nsomething else");
  writeFile(folder / "right10.pgm", "this is no image");
  const CommandResult result = run(stereo({"--json", "result.json"}));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  EXPECT_NE(result.output.find("  left: left out, because it is empty: left08.pgm\n"), std::string::npos)
      << result.output;
  EXPECT_NE(result.output.find("  left: left out, because it shows no board: left07.pgm"), std::string::npos);
  EXPECT_NE(result.output.find(
                "  right: left out, because it is not an image that can be read (JPEG, PNG, BMP, PGM), "
                "or is damaged: right10.pgm\n"),
            std::string::npos);
  const json left = json::parse(readFile(folder / "result.json"))["cameras"]["left"];
  ASSERT_EQ(left["unused"].size(), 3u);
  EXPECT_EQ(left["unused"][1], json({{"image", 8}, {"file", "left08.pgm"}, {"reason", "is empty"}}));
}

/// Writes a PNG of width x height black pixels, packed by Python.
void writeBlackPng(const std::filesystem::path& path, int width, int height) {
  const auto result =
      slom::testing::runCommand({"/usr/bin/python3", "-c",
                                 "import struct, sys, zlib\n"
                                 "w, h = int(sys.argv[2]), int(sys.argv[3])\n"
                                 "def chunk(name, data): return struct.pack('>I', len(data)) + name + data + "
                                 "struct.pack('>I', zlib.crc32(name + data))\n"
                                 "packer, data = zlib.compressobj(9), b''\n"
                                 "for _ in range(h): data += packer.compress(bytes(w + 1))\n"
                                 "data += packer.flush()\n"
                                 "open(sys.argv[1], 'wb').write(b'\\x89PNG\\r\\n\\x1a\\n' + chunk(b'IHDR', "
                                 "struct.pack('>IIBBBBB', w, h, 8, 0, 0, 0, 0)) +\n"
                                 "    chunk(b'IDAT', data) + chunk(b'IEND', b''))",
                                 path.string(), std::to_string(width), std::to_string(height)});
  ASSERT_EQ(result.errors, "");
}

TEST_F(Images, OfOddSizesAreListedAndLeftOut) {
  writeBlackPng(folder / "left07.png", 20000, 20000);
  writeBlackPng(folder / "left08.png", 16777215, 1);
  writeBlackPng(folder / "left09.png", 0, 0);
  writeBlackPng(folder / "left10.png", 99999, 1);
  ASSERT_EQ(::mkfifo((folder / "left11.png").c_str(), 0600), 0);
  std::filesystem::create_symlink("/dev/zero", folder / "left12.png");
  std::filesystem::create_directory(folder / "left13.png");
  const CommandResult result = run({"--board", "9x6", "--square", "0.03", "--intrinsics", "radial1",
                                    "--images", "left=left*", "--json", "result.json"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  const json unused = json::parse(readFile(folder / "result.json"))["cameras"]["left"]["unused"];
  const std::string most = " pixels, more than 100000 on a side or 300000000 in all";
  const auto photo = [](int image, const std::string& reason) {
    return json({{"image", image},
                 {"file", "left" + std::string(image < 10 ? "0" : "") + std::to_string(image) + ".png"},
                 {"reason", reason}});
  };
  EXPECT_EQ(unused, json({photo(7, "has 20000 x 20000" + most), photo(8, "has 16777215 x 1" + most),
                          photo(9, "is not an image that can be read (JPEG, PNG, BMP, PGM), or is damaged"),
                          photo(10, "has 99999 x 1 pixels, too few to show a board"),
                          photo(11, "is not a regular file"), photo(12, "is not a regular file")}));
  EXPECT_NE(result.output.find("  left: left out, because it has 16777215 x 1" + most + ": left08.png\n"),
            std::string::npos)
      << result.output;
}

TEST_F(Images, OfThePublicDataThatFilledTheMemory) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("hostile/bomb1.png");
  const auto hostile = slom::testing::sharedDataPath("hostile");
  const CommandResult result =
      run({"--board", "9x6", "--square", "0.03", "--intrinsics", "radial1", "--images", "left=left*",
           (hostile / "bomb1.png").string(), "--images", "right=right*", "--quiet"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.errors, "slom: " + (hostile / "bomb1.png").string() +
                               ": camera left already has image 1, left01.pgm; the last number in the "
                               "name must distinguish its photographs\n");
}

/// A corner file may name any file as a photograph. Such a file is never opened, so a pipe that nobody writes to blocks
/// nothing.
TEST_F(Images, ThatACornerFileNamesAreNotOpened) {
  calibrated(stereo({"--corners-out", "."}));
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  for (const std::string name : {"left", "right"}) {
    std::string text = readFile(folder / (name + "_corners.csv"));
    for (std::size_t at = 0; (at = text.find("# photo ", at)) != std::string::npos; ++at) {
      const std::size_t begin = text.find(": ", at) + 2;
      text.replace(begin, text.find('\n', begin) - begin, "pipe");
    }
    writeFile(folder / (name + "_corners.csv"), text);
  }
  const CommandResult result = slom::testing::runCommand(
      {"/usr/bin/timeout", "60", "/usr/bin/env", "-C", folder.path().string(),
       slom::testing::commandPath().string(), "calibrate", "--camera", "left=left_corners.csv", "--camera",
       "right=right_corners.csv", "--intrinsics", "radial1", "--report", "page.html", "--quiet"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(readFile(folder / "page.html").find("data:image/png"), std::string::npos);
}

TEST_F(Images, FaultsOfAllPhotographsAreErrors) {
  for (int i = 1; i <= 6; ++i) writeFile(folder / ("left0" + std::to_string(i) + ".pgm"), "");
  expectRefused(stereo(),
                "left01.pgm: the file is empty, like all photographs of camera left; check the pattern");
}

struct OddImages : Images {
  /// Draws these photographs of the left camera again, narrower ones.
  void narrow(std::initializer_list<int> images) const {
    StereoPhotos photos;
    photos.left.size = {600, 480};
    for (const int image : images)
      testing::writePgm(
          folder / fmt::format("left0{}.pgm", image),
          photos.left.photograph(photos.places()[std::size_t(image - 1)], chessboardPicture(photos.board)));
  }
};

TEST_F(OddImages, OfAnotherSizeAreListedAndLeftOut) {
  narrow({3});
  const CommandResult result = run(stereo({"--json", "result.json"}));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const std::string reason = "has 600 x 480 pixels, but most have 640 x 480";
  EXPECT_NE(result.output.find("  left: left out, because it " + reason + ": left03.pgm\n"),
            std::string::npos)
      << result.output;
  const json cameras = json::parse(readFile(folder / "result.json"))["cameras"];
  EXPECT_EQ(cameras["left"]["unused"], json({{{"image", 3}, {"file", "left03.pgm"}, {"reason", reason}}}));
  EXPECT_EQ(cameras["left"]["images"], 5);
  EXPECT_EQ(cameras["left"]["image_size"], json({640, 480}));
  EXPECT_EQ(cameras["right"]["images"], 6);
}

TEST_F(OddImages, OfDifferentSizesWithoutAMajorityAreRefused) {
  narrow({2, 3, 5});
  expectRefused(
      stereo(),
      "left01.pgm: has 640 x 480 pixels, but 3 other photographs of camera left have 600 x 480; most "
      "photographs of a camera must have the same size, so leave out the others, or scale no photograph");
}

TEST_F(Images, GivenTwiceAreLeftOut) {
  std::filesystem::copy_file(folder / "left01.pgm", folder / "left07.pgm");
  std::filesystem::create_symlink("left02.pgm", folder / "left08.pgm");
  std::filesystem::create_hard_link(folder / "left03.pgm", folder / "left09.pgm");
  const CommandResult result = run(stereo({"--json", "result.json"}));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const json found = json::parse(readFile(folder / "result.json"));
  EXPECT_EQ(found["cameras"]["left"]["images"], 6);
  EXPECT_EQ(found["notes"][0],
            "Camera left: image 7 (left07.pgm) repeats image 1 (left01.pgm), image 8 (left08.pgm) repeats "
            "image 2 (left02.pgm), image 9 (left09.pgm) repeats image 3 (left03.pgm) to within 0.000 px, "
            "so they are left out; a copy is not a second measurement.");
}

TEST_F(Images, OfABoardOfAnotherSizeAreToldWhichOneItIs) {
  const auto options = [](const std::string& board) {
    return std::vector<std::string>{"--board", board, "--square", "0.03", "--images", "left=left*.pgm"};
  };
  for (const std::string size : {"10x7", "9x5", "8x6", "7x6", "6x5", "5x4"}) {
    expectRefused(options(size), "left01.pgm: shows a chessboard of 9x6 inner corners, not " + size +
                                     "; count them where four squares meet, and give --board 9x6");
  }
  for (int i = 3; i <= 6; ++i) std::filesystem::remove(folder / ("left0" + std::to_string(i) + ".pgm"));
  expectRefused(
      options("5x17"),
      "left01.pgm: shows a chessboard of 6x9 inner corners, not 5x17; count them where four squares meet, "
      "and give --board 6x9");
}

TEST_F(Images, OfABoardGivenByRowsAreCalibratedFromAsWell) {
  std::vector<std::string> options = stereo();
  options[1] = "6x9";
  const json by_rows = calibrated(options), by_columns = calibrated(stereo());
  EXPECT_NEAR(by_rows["rss"], by_columns["rss"], 1e-6 * by_columns["rss"].get<double>());
}

TEST_F(Images, OfABoardInAKalibrFileAreCalibratedFrom) {
  writeFile(
      folder / "target.yaml",
      "target_type: 'checkerboard'\ntargetCols: 9 # inner corners\ntargetRows: 6\nrowSpacingMeters: 0.03\n"
      "colSpacingMeters: 0.03\n");
  std::vector<std::string> options = stereo();
  options.erase(options.begin() + 2, options.begin() + 4);
  options[1] = "target.yaml";
  EXPECT_EQ(calibrated(options)["cameras"]["left"]["parameters"],
            calibrated(stereo())["cameras"]["left"]["parameters"]);
}

TEST_F(Images, TooFewAreRefused) {
  for (int i = 2; i <= 6; ++i) std::filesystem::remove(folder / ("left0" + std::to_string(i) + ".pgm"));
  const CommandResult result = run(stereo());
  EXPECT_EQ(result.errors,
            "slom: left01.pgm: image 1 is the only one of camera left; its intrinsics need at least 2 images "
            "from different "
            "directions, so add images\n");
  EXPECT_EQ(result.exit_code, 2);
}

TEST_F(Images, ResultsDoNotReplacePhotographs) {
  expectRefused(stereo({"--json", "left02.pgm"}),
                "--json left02.pgm: this is the file of --images left too; give another one");
}

TEST_F(Images, OptionsThatDoNotBelongTogetherAreRefused) {
  const std::string board =
      "; write 9x6 (inner corners of a chessboard), charuco:8x5:4x4_50 (squares, dictionary), "
      "aprilgrid:6x6 (tags), or the YAML file of a Kalibr target";
  const auto with = [](std::vector<std::string> more) {
    more.insert(more.begin(), {"--images", "left=left*.pgm"});
    return more;
  };
  expectRefused(with({}),
                "--images needs --board, as in --board 9x6 for 9 x 6 inner corners of a chessboard");
  expectRefused(with({"--board", "9x6"}), "--board 9x6 needs --square, as in --square 0.025 [m]");
  expectRefused(with({"--board", "9by6", "--square", "1"}),
                "--board 9by6: write 9x6 (inner corners of a chessboard), charuco:8x5:4x4_50 "
                "(squares, dictionary), aprilgrid:6x6 (tags), or the YAML file of a Kalibr target");
  expectRefused(with({"--board", "2x6", "--square", "1"}),
                "--board 2x6: 2 x 6 inner corners cannot be detected; give 3 to 100 in each direction");
  for (const std::string value : {"1e+300", "1e-300"}) {
    expectRefused(with({"--board", "9x6", "--square", value}),
                  "--square " + value + ": out of range for a printed board; give 1e-06 to 1000 m");
    expectRefused(with({"--board", "charuco:8x5:4x4_50", "--square", "0.04", "--marker", value}),
                  "--marker " + value + ": out of range for a printed board; give 1e-06 to 1000 m");
    expectRefused(with({"--board", "aprilgrid:6x6", "--square", "0.04", "--spacing", value}),
                  "--spacing " + value + ": out of range for a printed board; give 0.001 to 10");
  }
  expectRefused(
      with({"--board", "9x6", "--square", "30"}),
      "--square 30: the board would be 283 m across; is the number in millimetres? give metres: --square 0.03");
  expectRefused(
      with({"--board", "aprilgrid:6x6", "--square", "88", "--spacing", "0.3"}),
      "--square 88: the board would be 933 m across; is the number in millimetres? give metres: --square 0.088");
  expectRefused(
      with({"--board", "charuco:8x5:4x4_50", "--square", "0.04", "--marker", "30"}),
      "--marker 30: the marker would be 30 m across; is the number in millimetres? give metres: --marker 0.03");
  expectRefused(with({"--board", "9x6", "--square", "-1"}), "--square -1: give a positive number");
  expectRefused(with({"--board", "9x6", "--square", "1", "--marker", "0.5"}),
                "--marker 0.5: --board 9x6 has no such length; drop this option");
  expectRefused(with({"--board", "charuco:8x5", "--square", "1", "--marker", "0.5"}),
                "--board charuco:8x5: the dictionary of the markers is missing; give it, as in --board "
                "charuco:8x5:4x4_50");
  expectRefused(with({"--board", "charuco:8x5:4x4_50", "--square", "1"}),
                "--board charuco:8x5:4x4_50 needs --marker, as in --marker 0.018 [m]");
  expectRefused(with({"--board", "charuco:8x5:4x4_50", "--square", "1", "--marker", "2"}),
                "--marker 2: a marker lies within a square of 1 m; give a smaller one");
  expectRefused(with({"--board", "charuco:20x10:4x4_50", "--square", "0.1", "--marker", "0.05"}),
                "--board charuco:20x10:4x4_50: its 100 markers are more than the 50 of the dictionary; "
                "correct the size or the dictionary");
  expectRefused(with({"--board", "charuco:8x5:9x9", "--square", "1", "--marker", "0.5"}),
                "--board charuco:8x5:9x9: there is no dictionary 9x9; there are 4x4_100, 4x4_1000, 4x4_250, "
                "4x4_50, 5x5_100, 5x5_1000, 5x5_250, "
                "5x5_50, 6x6_100, 6x6_1000, 6x6_250, 6x6_50, 7x7_100, 7x7_1000, 7x7_250, 7x7_50, original");
  expectRefused(with({"--board", "aprilgrid:6x6", "--square", "1"}),
                "--board aprilgrid:6x6 needs --spacing, as in --spacing 0.3 (of a tag's side)");
  expectRefused(with({"--board", "9x6", "--square", "1", "--camera", "left=left.csv"}),
                "--images left=left*.pgm: give --images or --camera, not both; --corners-out makes corner "
                "files of photographs");
  expectRefused({"--images", "left01.pgm", "--board", "9x6", "--square", "1"},
                "--images left01.pgm: write NAME=PATTERN, as in --images left='left*.jpg'");
  expectRefused(with({"--board", "circles.yaml"}),
                "circles.yaml: cannot be read (No such file or directory); check the path");
  writeFile(
      folder / "circles.yaml",
      "target_type: circlegrid\ntargetCols: 4\ntargetRows: 11\nspacingMeters: 0.02\nasymmetricGrid: 1\n");
  expectRefused(
      with({"--board", "circles.yaml"}),
      "--board circles.yaml: circles cannot be found in photographs; give corner files by --camera, or "
      "photographs of a chessboard, ChArUco board or AprilGrid");
  expectRefused(with({"--board", "circles.yaml", "--square", "0.02"}),
                "--square 0.02: circles.yaml already states the lengths of the board; drop this option");
  expectRefused({"--camera", "left=left.csv", "--corners-out", "."},
                "--corners-out .: needs photographs, none are given; add --images or drop this option");
  expectRefused(stereo({"--corners-out", "no/such"}),
                "cannot write no/such/left_corners.csv: No such file or directory; name a file in a folder "
                "that exists and may be written");
}

TEST_F(Images, SwappedPhotographsAreNamed) {
  std::filesystem::rename(folder / "right02.pgm", folder / "other");
  std::filesystem::rename(folder / "right04.pgm", folder / "right02.pgm");
  std::filesystem::rename(folder / "other", folder / "right04.pgm");
  const CommandResult result = run(stereo());
  std::string text;  // as one line
  for (const char c : result.output) {
    if (c != '\n') text += c;
  }
  for (const std::string number : {"2", "4"}) {
    EXPECT_NE(
        text.find("Image " + number + " of camera right (right0" + number + ".pgm) contradicts the others"),
        std::string::npos)
        << result.output;
  }
  EXPECT_EQ(text.find("Image 3 of camera"), std::string::npos);
}

TEST_F(Images, AreShownAroundACorner) {
  // The worst corner of the report has its place in the photograph.
  const CommandResult result = run(stereo());
  EXPECT_NE(result.output.find(".pgm)\n"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("px, corner "), std::string::npos) << result.output;
}

/// Copies of the photographs under higher numbers.
void multiply(const TemporaryFolder& folder, int count) {
  for (int i = 7; i <= count; ++i) {
    for (const std::string side : {"left", "right"}) {
      std::filesystem::create_hard_link(folder / (side + "0" + std::to_string((i - 1) % 6 + 1) + ".pgm"),
                                        folder / (side + std::to_string(i) + ".pgm"));
    }
  }
}

TEST_F(Images, AnInterruptLeavesNoFileBehind) {
  multiply(folder, 120);
  const auto files = [&] {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
      names.insert(entry.path().filename());
    return names;
  };
  const auto before = files();
  for (const int milliseconds : {60, 250, 600}) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      if (::chdir(folder.path().c_str()) != 0) ::_exit(3);
      std::vector<std::string> words = stereo({"--json", "result.json", "--output", "out.yaml", "--quiet"});
      words.insert(words.begin(), {slom::testing::commandPath().string(), "calibrate"});
      std::vector<char*> arguments;
      for (std::string& word : words) arguments.push_back(word.data());
      arguments.push_back(nullptr);
      ::execv(arguments[0], arguments.data());
      ::_exit(4);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    ::kill(child, SIGINT);
    int status = 0;
    ::waitpid(child, &status, 0);
    if (WIFSIGNALED(status)) {
      EXPECT_EQ(WTERMSIG(status), SIGINT);
      EXPECT_EQ(files(), before) << "interrupted after " << milliseconds << " ms";
    }
  }
}

/// Peak memory of the largest child so far [kB].
long peakMemory() {
  rusage usage{};
  ::getrusage(RUSAGE_CHILDREN, &usage);
  return usage.ru_maxrss;
}

TEST_F(Images, ManyTakeNoMoreMemoryThanFew) {
  if (slom::testing::hasSanitizers()) GTEST_SKIP() << "sanitizers keep freed memory";
  const json few = calibrated(stereo());
  const long memory_of_few = peakMemory();
  multiply(folder, 100);
  const json many = calibrated(stereo());
  EXPECT_EQ(many["cameras"]["left"]["images"], 6);
  EXPECT_EQ(many["cameras"]["left"]["copies"].size(), 94u);
  // 188 more photographs of 0.3 MB; what is added are corners.
  EXPECT_LT(peakMemory() - memory_of_few, 25000) << memory_of_few;
}

TEST(SampleImages, AreAsGoodAsWhatOpenCVFindsInThem) {
  if (!std::filesystem::exists(opencv_samples + "/left01.jpg")) GTEST_SKIP() << "needs Debian's opencv-doc";
  const TemporaryFolder folder;
  const CommandResult result = slom::testing::runCommand(
      {slom::testing::commandPath().string(), "calibrate", "--board", "9x6", "--square", "1", "--images",
       "left=" + opencv_samples + "/left[01]*.jpg", "--images", "right=" + opencv_samples + "/right[01]*.jpg",
       "--corners-out", folder.path().string(), "--json", (folder / "result.json").string(), "--quiet"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json slom_says = json::parse(readFile(folder / "result.json"));
  for (const std::string name : {"left", "right"}) {
    EXPECT_EQ(slom_says["cameras"][name]["images"], 13);
    EXPECT_EQ(slom_says["cameras"][name]["corners"], 702);
    // findChessboardCorners and cornerSubPix as in OpenCV's own sample give 0.20 px.
    EXPECT_LT(slom_says["cameras"][name]["rms_px_alone"], 0.19);
  }
  // OpenCV on the same corners.
  const CommandResult reference = slom::testing::runCommand(
      {"/usr/bin/python3", slom::testing::sourcePath("tests/calibrate_reference/opencv_stereo.py").string(),
       (folder / "left_corners.csv").string(), (folder / "right_corners.csv").string()});
  if (reference.exit_code == 3) GTEST_SKIP() << reference.errors;
  ASSERT_EQ(reference.exit_code, 0) << reference.errors;
  const json opencv = json::parse(reference.output);
  for (const std::string name : {"left", "right"}) {
    EXPECT_NEAR(slom_says["rms_px"][name], opencv["rms_px"][name].get<double>(), 1e-3);
    for (const auto& [key, value] : opencv["cameras"][name].items()) {
      const json& p = slom_says["cameras"][name]["parameters"][key];
      EXPECT_NEAR(p["value"], value.get<double>(), 0.05 * p["std"].get<double>()) << name << " " << key;
    }
  }
}

TEST(SampleImages, AreComparedAsThePageShows) {
  if (!std::filesystem::exists(opencv_samples + "/left01.jpg")) GTEST_SKIP() << "needs Debian's opencv-doc";
  const CommandResult result = slom::testing::runCommand(
      {slom::testing::commandPath().string(), "calibrate", "--board", "9x6", "--square", "1", "--images",
       "left=" + opencv_samples + "/left[01]*.jpg", "--images", "right=" + opencv_samples + "/right[01]*.jpg",
       "--compare", "radial1,opencv4,fisheye,opencv5"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::size_t begin = result.output.find("models compared"),
                    end = result.output.find("\n\neach camera");
  ASSERT_NE(begin, std::string::npos);
  const std::string page = readFile(slom::testing::sourcePath("docs/calibrate/models.md"));
  EXPECT_NE(page.find("```text\n" + result.output.substr(begin, end - begin) + "\n```"), std::string::npos)
      << result.output.substr(begin, end - begin);
}

}  // namespace
}  // namespace slom::app::calib
