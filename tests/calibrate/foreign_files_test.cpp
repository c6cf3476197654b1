// Corner files of mrcal and OpenCV, and Kalibr's targets. The same simulated corners give the same calibration in every
// format, to the last bit.
#include <filesystem>
#include <functional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calibrate/calibrate_command.hpp"
#include "calibrate/detect/board.hpp"
#include "support/replaced.hpp"

namespace slom::app::calib {
namespace {

using testing::CommandResult;
using testing::runCalibrate;
using testing::TemporaryFolder;

constexpr int columns = 7, rows = 5;
constexpr double square_m = 0.05;

/// Returns views of a whole board, so that every format can hold them.
CameraData completeViews(unsigned seed) {
  testing::RigOptions options;
  options.cameras = 1;
  options.images = 9;
  options.columns = columns, options.rows = rows;
  options.square_m = square_m;
  options.distance = 0.9;
  std::mt19937_64 random(seed);
  const testing::RigTruth truth = testing::simulateTruth(options, random);
  CameraData camera = testing::simulateMeasurements(truth, options, random).cameras[0];
  std::erase_if(camera.views, [](const View& view) { return view.corners.size() != columns * rows; });
  camera.image_size = ImageSize{640, 480};
  return camera;
}

std::string pixelsOf(const View& view, const char* separator) {
  std::string text;
  for (const Corner& corner : view.corners)
    text +=
        fmt::format("{}{}{}{}", text.empty() ? "" : separator, corner.pixel.x(), separator, corner.pixel.y());
  return text;
}

std::string worldOf(const View& view, const char* separator) {
  std::string text;
  for (const Corner& corner : view.corners)
    text += fmt::format("{}{}{}{}{}{}", text.empty() ? "" : separator, corner.world.x(), separator,
                        corner.world.y(), separator, corner.world.z());
  return text;
}

/// A list with an entry for each image.
std::string listed(const CameraData& camera, const std::function<std::string(const View&)>& entry,
                   const char* between) {
  std::string text;
  for (const View& view : camera.views) text += (text.empty() ? "" : between) + entry(view);
  return text;
}

std::string vnlog(const CameraData& camera, const char* last_column) {
  std::string text = fmt::format("## generated\n# filename x y{}{}\n", *last_column ? " " : "", last_column);
  const std::string value = *last_column == '\0' ? "" : *last_column == 'l' ? " 0" : " 1";
  for (const View& view : camera.views) {
    for (const Corner& corner : view.corners)
      text += fmt::format("shots/frame{:06}-cam0.png {} {}{}\n", view.image, corner.pixel.x(),
                          corner.pixel.y(), value);
  }
  return text + "shots/frame000099-cam0.png - -\n";
}

/// Returns the file that OpenCV's calibration sample writes with cv::FileStorage.
std::string sampleYaml(const CameraData& camera) {
  return fmt::format(
      "%YAML:1.0\n---\ncalibration_time: \"Sat Nov 28 12:00:00 2026\"\nimage_width: 640\nimage_height: 480\nboard_width: {}\n"
      "board_height: {}\nsquare_size: {}\n# flags: 0\nflags: 0\ncamera_matrix: !!opencv-matrix\n   rows: 1\n   cols: 1\n   dt: d\n"
      "   data: [ 1. ]\nimage_points: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: \"2f\"\n   data: [ {} ]\n",
      columns, rows, square_m, camera.views.size(), columns * rows,
      listed(
          camera, [](const View& view) { return pixelsOf(view, ",\n       "); }, ", "));
}

std::string sampleXml(const CameraData& camera) {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>640</image_width>\n<image_height>480</image_height>\n"
      "<board_width>{}</board_width>\n<board_height>{}</board_height>\n<square_size>{}</square_size>\n<!-- flags -->\n"
      "<image_points type_id=\"opencv-matrix\">\n  <rows>{}</rows>\n  <cols>{}</cols>\n  <dt>\"2f\"</dt>\n  <data>\n    "
      "{}</data></image_points>\n</opencv_storage>\n",
      columns, rows, square_m, camera.views.size(), columns * rows,
      listed(
          camera, [](const View& view) { return pixelsOf(view, " "); }, "\n    "));
}

/// With object points and names of the images, a matrix for each image.
std::string handWrittenJson(const CameraData& camera) {
  const auto matrix = [](const std::string& numbers, int channels) {
    return fmt::format(R"({{"type_id": "opencv-matrix", "rows": {}, "cols": {}, "dt": "f", "data": [{}]}})",
                       columns * rows, channels, numbers);
  };
  return fmt::format(
      R"({{"imageSize": [640, 480], "image_names": [{}], "imagePoints": [{}], "objectPoints": [{}]}})",
      listed(
          camera, [](const View& view) { return fmt::format("\"left{:02}.jpg\"", view.image); }, ", "),
      listed(
          camera, [&](const View& view) { return matrix(pixelsOf(view, ", "), 2); }, ", "),
      listed(
          camera, [&](const View& view) { return matrix(worldOf(view, ", "), 3); }, ", "));
}

/// Lists of points, as json.dump writes arrays, and one board for all images.
std::string listsJson(const CameraData& camera) {
  const auto points = [](const View& view) {
    std::string text;
    for (const Corner& c : view.corners)
      text += fmt::format("{}[[{}, {}]]", text.empty() ? "" : ", ", c.pixel.x(), c.pixel.y());
    return "[" + text + "]";
  };
  std::string board;
  for (int k = 0; k < columns * rows; ++k)
    board += fmt::format("{}[{}, {}, 0]", board.empty() ? "" : ", ", k % columns, k / columns);
  return fmt::format(R"({{"image_points": [{}], "object_points": [{}]}})", listed(camera, points, ", "),
                     board);
}

/// Sequences of plain numbers in a file without %YAML.
std::string listsYaml(const CameraData& camera) {
  return "# my corners\nimage_size: [640, 480]\nimage_points:\n" +
         listed(
             camera, [](const View& view) { return "- [" + pixelsOf(view, ", ") + "]\n"; }, "");
}

struct Format {
  std::string file, text;
  std::vector<std::string> options;
};

std::vector<Format> formatsOf(const CameraData& camera) {
  const std::vector<std::string> board{"--board", fmt::format("{}x{}", columns, rows), "--square",
                                       fmt::format("{}", square_m)};
  return {{"corners.vnl", vnlog(camera, "level"), board},
          {"weights.vnl", vnlog(camera, "weight"), board},
          {"plain.txt", vnlog(camera, ""), board},
          {"sample.yml", sampleYaml(camera), {}},
          {"sample.xml", sampleXml(camera), {}},
          {"hand.json", handWrittenJson(camera), {}},
          {"lists.json", listsJson(camera), {"--square", fmt::format("{}", square_m)}},
          {"no_name", listsYaml(camera), board},
          {"tab.csv", slom::testing::replaced(testing::cornerFile(camera), ",", "\t"), {}},
          {"semicolon.csv", slom::testing::replaced(testing::cornerFile(camera), ",", ";"), {}}};
}

CommandResult calibrated(const TemporaryFolder& folder, const Format& format) {
  slom::testing::writeFile(folder / format.file, format.text);
  std::vector<std::string> options{"--camera", "cam=" + (folder / format.file).string(), "--json",
                                   (folder / "r.json").string(), "--quiet"};
  options.insert(options.end(), format.options.begin(), format.options.end());
  std::filesystem::remove(folder / "r.json");
  CommandResult result = runCalibrate(options);
  result.errors = slom::testing::replaced(result.errors, folder.path().string() + "/", "");
  return result;
}

nlohmann::json jsonIn(const TemporaryFolder& folder) {
  return nlohmann::json::parse(slom::testing::readFile(folder / "r.json"));
}

TEST(ForeignFiles, AllFormatsGiveTheCalibrationOfTheTable) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    CameraData camera = completeViews(seed);
    ASSERT_GE(camera.views.size(), 5u);
    for (std::size_t i = 0; i < camera.views.size(); ++i) camera.views[i].image = int(i) + 1;
    const TemporaryFolder folder;
    const CommandResult table = calibrated(folder, {"table.csv", testing::cornerFile(camera), {}});
    ASSERT_EQ(table.exit_code, 0) << table.errors;
    const nlohmann::json expected = jsonIn(folder);
    for (const Format& format : formatsOf(camera)) {
      const CommandResult result = calibrated(folder, format);
      ASSERT_EQ(result.exit_code, 0) << format.file << ": " << result.errors;
      const nlohmann::json found = jsonIn(folder);
      EXPECT_EQ(found["cameras"]["cam"]["parameters"], expected["cameras"]["cam"]["parameters"])
          << format.file;
      EXPECT_EQ(found["rss"], expected["rss"]) << format.file;
      EXPECT_EQ(found["cameras"]["cam"]["images"], expected["cameras"]["cam"]["images"]) << format.file;
    }
  }
}

/// Files that OpenCV itself writes, of recorded corners.
TEST(ForeignFiles, WhatOpenCvWritesIsRead) {
  const std::string table = slom::testing::sourcePath("data/opencv_stereo/left_corners.csv");
  const TemporaryFolder folder;
  const CommandResult written = slom::testing::runCommand(
      {"/usr/bin/python3", slom::testing::sourcePath("tests/calibrate_reference/file_storage.py").string(),
       table, folder.path().string()});
  if (written.exit_code == 3) GTEST_SKIP() << written.errors;
  ASSERT_EQ(written.exit_code, 0) << written.errors;
  ASSERT_EQ(
      runCalibrate({"--camera", "cam=" + table, "--json", (folder / "r.json").string(), "--quiet"}).exit_code,
      0);
  const nlohmann::json expected = jsonIn(folder);
  for (const std::string name :
       {"sample.xml", "sample.yml", "sample.json", "hand.xml", "hand.yml", "hand.json"}) {
    const CommandResult result = runCalibrate(
        {"--camera", "cam=" + (folder / name).string(), "--json", (folder / "r.json").string(), "--quiet"});
    ASSERT_EQ(result.exit_code, 0) << name << ": " << result.errors;
    const nlohmann::json found = jsonIn(folder);
    EXPECT_NEAR(found["rss"], expected["rss"], 1e-9) << name;  // places of corners round to other bits
    for (const auto& [key, value] : expected["cameras"]["cam"]["parameters"].items())
      EXPECT_NEAR(found["cameras"]["cam"]["parameters"][key]["value"], value["value"].get<double>(),
                  1e-7 * value["std"].get<double>())
          << name << " " << key;
  }
}

TEST(ForeignFiles, LevelsDoubleTheStandardDeviation) {
  const CameraData camera = completeViews(4);
  const TemporaryFolder folder;
  std::string levels = "# filename x y level\n", weights = "# filename x y weight\n";
  CameraData without = camera;
  for (std::size_t v = 0; v < camera.views.size(); ++v) {
    for (const Corner& c : camera.views[v].corners) {
      const int level = c.number % 4 - 1;
      const std::string place = fmt::format("f{}.png {} {}", camera.views[v].image, c.pixel.x(), c.pixel.y());
      levels += fmt::format("{} {}\n", place, level < 0 ? "-" : std::to_string(level));
      weights += fmt::format("{} {}\n", place, level < 0 ? -1 : std::exp2(-level));
    }
    std::erase_if(without.views[v].corners, [](const Corner& c) { return c.number % 4 == 0; });
    for (Corner& c : without.views[v].corners) c.sigma = std::exp2(c.number % 4 - 1);
  }
  slom::testing::writeFile(folder / "levels.vnl", levels);
  slom::testing::writeFile(folder / "weights.vnl", weights);
  for (const char* const name : {"levels.vnl", "weights.vnl"}) {
    const Dataset data =
        readRig({{"cam", {(folder / name).string()}}}, "", BoardOfFiles{columns, rows, square_m});
    const CameraData& found = data.cameras[0];
    ASSERT_EQ(found.views.size(), without.views.size());
    for (std::size_t v = 0; v < found.views.size(); ++v) {
      ASSERT_EQ(found.views[v].corners.size(), without.views[v].corners.size());
      for (std::size_t k = 0; k < found.views[v].corners.size(); ++k) {
        EXPECT_EQ(found.views[v].corners[k].sigma, without.views[v].corners[k].sigma);
        EXPECT_EQ(found.views[v].corners[k].number, without.views[v].corners[k].number);
        EXPECT_TRUE(found.views[v].corners[k].pixel == without.views[v].corners[k].pixel);
        EXPECT_LT((found.views[v].corners[k].world - without.views[v].corners[k].world).norm(), 1e-15);
      }
    }
  }
}

TEST(ForeignFiles, KalibrTargetsAreBoards) {
  const CameraData camera = completeViews(5);
  const TemporaryFolder folder;
  const auto target = [&](const std::string& text) {
    slom::testing::writeFile(folder / "target.yaml", text);
    return std::vector<std::string>{"--board", (folder / "target.yaml").string()};
  };
  ASSERT_EQ(calibrated(folder, {"t.csv", testing::cornerFile(camera), {}}).exit_code, 0);
  const nlohmann::json expected = jsonIn(folder)["cameras"]["cam"]["parameters"];
  const Format with_target{
      "c.vnl", vnlog(camera, "level"),
      target(
          "target_type: 'checkerboard' #gridtype\ntargetCols: 7               #internal corners\ntargetRows: 5\n"
          "rowSpacingMeters: 0.05\ncolSpacingMeters: 0.05\n")};
  const CommandResult result = calibrated(folder, with_target);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(jsonIn(folder)["cameras"]["cam"]["parameters"], expected);

  target(
      "target_type: 'circlegrid'\ntargetCols: 4\ntargetRows: 3\nspacingMeters: 0.02\nasymmetricGrid: True\n");
  const KalibrTarget circles = readKalibrTarget((folder / "target.yaml").string());
  EXPECT_TRUE(circles.kind == KalibrTarget::Kind::circlegrid && circles.is_asymmetric);
  const auto known = parseBoardOfFiles({.board = (folder / "target.yaml").string()});
  ASSERT_TRUE(known);
  ASSERT_EQ(known->points.size(), 12u);
  EXPECT_LT((known->points[5] - vec3(0.06, 0.02, 0.)).norm(),
            1e-15);  // row 1, column 1: (2 + 1) and 1 spacings
  target("target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 5\ntagSize: 0.088\ntagSpacing: 0.3\n");
  const Board tags = parseBoard({.board = (folder / "target.yaml").string()});
  EXPECT_TRUE(tags.kind == BoardKind::aprilgrid);
  EXPECT_EQ(tags.columns, 6);
  EXPECT_EQ(tags.rows, 5);
  EXPECT_EQ(tags.square_m, 0.088);
  EXPECT_EQ(tags.spacing, 0.3);
}

struct Fault {
  const char* what;
  Format format;
  std::string sentence;
};

void expectRefused(const Fault& fault) {
  const TemporaryFolder folder;
  const CommandResult result = calibrated(folder, fault.format);
  EXPECT_EQ(result.exit_code, 2) << fault.what;
  EXPECT_EQ(result.errors, "slom: " + fault.sentence + "\n") << fault.what;
  EXPECT_FALSE(std::filesystem::exists(folder / "r.json")) << fault.what;
}

TEST(ForeignFiles, WithoutABoardTheOptionsAreNamed) {
  const CameraData camera = completeViews(6);
  const std::string vnl = vnlog(camera, "level"), lists = listsYaml(camera);
  expectRefused(
      {"no board",
       {"c.vnl", vnl, {}},
       "c.vnl: the file does not say how many corners the board has in a row, and how long a square is; pass --board "
       "COLUMNSxROWS, its inner corners, and --square METRES"});
  expectRefused({"no square",
                 {"c.vnl", vnl, {"--board", "7x5"}},
                 "c.vnl: the file does not say how long a square is; pass --square METRES"});
  expectRefused(
      {"no size",
       {"c.yml", lists, {"--square", "0.05"}},
       "c.yml: the file does not say how many corners the board has in a row; pass --board COLUMNSxROWS, its inner corners"});
  expectRefused({"not needed",
                 {"t.csv", testing::cornerFile(camera), {"--board", "7x5", "--square", "0.05"}},
                 "t.csv: the corner files already state where their corners lie; drop --board"});
  expectRefused(
      {"squares of 50 mm",
       {"s.yml", slom::testing::replaced(sampleYaml(camera), "square_size: 0.05", "square_size: 50"), {}},
       "s.yml:8: square_size is 50 without a unit, and metres are unlikely; pass --square METRES"});
  std::string json = listsJson(camera);
  expectRefused({"points that count squares",
                 {"l.json", json, {}},
                 "l.json:1: object_points are 1 apart without a unit, and metres are unlikely; pass --square "
                 "METRES"});
}

TEST(ForeignFiles, ABoardWithRowsAndColumnsExchangedIsNamed) {
  const CameraData camera = completeViews(7);
  const TemporaryFolder folder;
  const CommandResult result =
      calibrated(folder, {"c.vnl", vnlog(camera, "level"), {"--board", "5x7", "--square", "0.05"}});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.errors.find("rows and columns are exchanged"), std::string::npos) << result.errors;
  EXPECT_TRUE(result.errors.ends_with("; give --board 7x5\n")) << result.errors;
}

TEST(ForeignFiles, LengthsInMillimetresAreRefused) {
  const CameraData camera = completeViews(7);
  expectRefused(
      {"a board that the options state",
       {"c.vnl", vnlog(camera, "level"), {"--board", "7x5", "--square", "50"}},
       "--square 50: the board would be 361 m across; is the number in millimetres? give metres: --square 0.05"});
  expectRefused(
      {"a board that the file states",
       {"s.yml", sampleYaml(camera), {"--square", "50"}},
       "--square 50: the board would be 361 m across; is the number in millimetres? give metres: --square 0.05"});
}

TEST(ForeignFiles, BadOnesAreRefusedInOneSentence) {
  using slom::testing::replaced;
  const std::vector<std::string> board{"--board", "7x5", "--square", "0.05"};
  const CameraData camera = completeViews(7);
  const std::string vnl = vnlog(camera, "level"), yaml = sampleYaml(camera), xml = sampleXml(camera);
  const std::string first = fmt::format("shots/frame{:06}-cam0.png", camera.views[0].image);
  const std::string u = fmt::format("{}", camera.views[0].corners[0].pixel.x());
  const std::string row = fmt::format("{} {} {} 0\n", first, u, camera.views[0].corners[0].pixel.y());
  expectRefused(
      {"a corner too few",
       {"c.vnl", replaced(vnl, row, ""), board},
       fmt::format(
           "c.vnl:3: image {} has 34 corners, and the board has 35; correct the size of the board, or copy the file "
           "again if it is cut off",
           first)});
  expectRefused(
      {"another board",
       {"c.vnl", vnl, {"--board", "6x5", "--square", "0.05"}},
       fmt::format(
           "c.vnl:33: this is corner 31 of image {}, and the board has 30; correct the size of the board",
           first)});
  expectRefused({"NaN",
                 {"c.vnl", replaced(vnl, " " + u + " ", " nan "), board},
                 "c.vnl:3: x is \"nan\"; write a finite number, or - for a corner that was not found"});
  expectRefused(
      {"an image twice",
       {"c.vnl", vnl + row, board},
       fmt::format(
           "c.vnl:{}: image {} has rows above, from line 3 on, and again here; keep one detection of it",
           35 * camera.views.size() + 4, first)});
  expectRefused(
      {"two cameras",
       {"c.vnl", vnl + replaced(vnl, "cam0", "cam1"), board},
       fmt::format(
           "c.vnl: images {} and {} have the same number in their names; put the images of each camera into a file of "
           "its own, and give each image a number of its own",
           first, replaced(first, "cam0", "cam1"))});
  expectRefused(
      {"cut off",
       {"s.yml", yaml.substr(0, yaml.size() / 2), {}},
       "s.yml:20: the brackets that begin here do not end; the file seems to be cut off, so copy it again"});
  expectRefused({"cut off",
                 {"s.xml", xml.substr(0, xml.size() / 2), {}},
                 "s.xml:13: <data> does not end; the file seems to be cut off, so copy it again"});
  expectRefused(
      {"a number too few",
       {"s.yml", replaced(yaml, "[ " + u + ",\n", "[\n"), {}},
       fmt::format(
           "s.yml:20: image_points has {} numbers, but rows, cols and dt give {}; copy the file again",
           70 * camera.views.size() - 1, 70 * camera.views.size())});
  expectRefused({"NaN",
                 {"s.yml", replaced(yaml, "[ " + u, "[ .Nan"), {}},
                 "s.yml:20: image_points is \".Nan\"; write a finite number there, or remove the image"});
  expectRefused({"two boards",
                 {"s.yml", yaml, {"--board", "5x7"}},
                 "s.yml:6: the file has a board of 7 x 5 corners, but 5 x 7 are stated; correct one of "
                 "them"});
  expectRefused(
      {"no corners",
       {"s.yml", replaced(yaml, "image_points", "extrinsics"), {}},
       "s.yml:3: the file has no key image_points, only calibration_time, image_width, image_height, "
       "board_width,...; write the corners too, as OpenCV's calibration sample does with -op"});
  expectRefused({"a target",
                 {"t.yaml", "target_type: 'checkerboard'\n", {}},
                 "t.yaml:1: this is a target of Kalibr, without corners; give it as the board"});
  expectRefused({"a key twice",
                 {"s.yml", replaced(yaml, "flags: 0\ncamera", "flags: 0\nflags: 0\ncamera"), {}},
                 "s.yml:11: flags is there twice; remove one"});
  expectRefused(
      {"an image twice",
       {"h.json",
        replaced(handWrittenJson(camera), fmt::format("left{:02}", camera.views[1].image),
                 fmt::format("left{:02}", camera.views[0].image)),
        {}},
       fmt::format(
           "h.json: images left{0:02}.jpg and left{0:02}.jpg have the same number in their names; put the images of each "
           "camera into a file of its own, and give each image a number of its own",
           camera.views[0].image)});
}

}  // namespace
}  // namespace slom::app::calib
