// The page and the JSON as files: self-contained, of bounded size, and open about what is missing.
#include <map>
#include <regex>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calibrate/calibrate_command.hpp"
#include "calibrate/html/page.hpp"
#include "calibrate/library.hpp"
#include "calibration/quality/calibrated_rig.hpp"

namespace slom::app::calib {
namespace {

using slom::testing::readFile;
using slom::testing::sourcePath;
using slom::testing::TemporaryFolder;

std::vector<std::string> stereo(std::vector<std::string> more) {
  std::vector<std::string> options;
  for (const std::string camera : {"left", "right"}) {
    options.insert(
        options.end(),
        {"--camera", camera + "=" + sourcePath("data/opencv_stereo/" + camera + "_corners.csv").string()});
  }
  options.insert(options.end(), more.begin(), more.end());
  return options;
}

/// The JSON block of a page.
nlohmann::json dataOf(const std::string& page) {
  const std::string mark = "<script type=\"application/json\" id=\"data\">";
  const std::size_t begin = page.find(mark) + mark.size();
  return nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

TEST(Report, NeedsNothingButItself) {
  const TemporaryFolder folder;
  const auto ran = testing::runCalibrate(stereo({"--report", folder / "report.html"}));
  ASSERT_EQ(ran.exit_code, 0) << ran.errors;
  EXPECT_NE(ran.output.find("written: " + (folder / "report.html").string() + "\n"), std::string::npos);
  const std::string page = readFile(folder / "report.html");
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
  EXPECT_EQ(page.find("@file:"), std::string::npos);
  EXPECT_EQ(page.find("@data@"), std::string::npos);
  EXPECT_FALSE(std::regex_search(page, std::regex(R"(<(script|img|iframe|link)[^>]*(src|href)="(?!data:))")));
  EXPECT_FALSE(std::regex_search(page, std::regex(R"(@import|url\()")));
  EXPECT_LT(page.size(), 400'000u);
  EXPECT_EQ(dataOf(page)["cameras"].size(), 2u);
}

TEST(Report, TheSameIsInTheJson) {
  const TemporaryFolder folder;
  const auto ran = testing::runCalibrate(
      stereo({"--quiet", "--report", folder / "report.html", "--json", folder / "result.json"}));
  ASSERT_EQ(ran.exit_code, 0) << ran.errors;
  const auto page = dataOf(readFile(folder / "report.html"));
  const auto quality = nlohmann::json::parse(readFile(folder / "result.json"))["quality"];
  EXPECT_EQ(page["verdict"], quality["verdict"]);
  for (std::size_t c = 0; c < 2; ++c) {
    const auto& in_page = page["cameras"][c];
    const auto& in_json = quality["cameras"][in_page["name"].get<std::string>()];
    EXPECT_EQ(in_page["projection"][0]["worst"], in_json["projection"][0]["worst_px"]);
    EXPECT_EQ(in_page["split"]["rms"], quality["split_half"][in_page["name"].get<std::string>()]["rms_px"]);
    EXPECT_TRUE(in_json["image_size_is_assumed"].get<bool>());
  }
  EXPECT_EQ(quality["further_views"].size(), 3u);
  EXPECT_EQ(quality["worst_corners"].size(), 20u);
  EXPECT_EQ(quality["correlations"]["names"].size(), 24u);
  for (const char* phase : {"residuals", "covariance", "projection", "split_half", "further_views"})
    EXPECT_TRUE(quality["seconds"].contains(phase)) << phase;
}

/// Line `number` of a text, from 1 on.
std::string lineOf(const std::string& text, int number) {
  std::istringstream lines(text);
  std::string line;
  for (int i = 0; i < number; ++i) std::getline(lines, line);
  return line;
}

TEST(Report, WorstCornersStandWhereTheySay) {
  const TemporaryFolder folder;
  const std::string left = readFile(sourcePath("data/opencv_stereo/left_corners.csv"));
  const std::size_t header = left.find('\n') + 1, middle = left.find("\n7,1,") + 1;
  slom::testing::writeFile(folder / "first.csv", left.substr(0, middle));
  slom::testing::writeFile(folder / "second.csv", left.substr(0, header) + left.substr(middle));
  const std::string right = sourcePath("data/opencv_stereo/right_corners.csv").string();
  const auto ran = testing::runCalibrate({"--camera", "left=" + (folder / "first.csv").string(), "--camera",
                                          "left=" + (folder / "second.csv").string(), "--camera",
                                          "right=" + right, "--quiet", "--report", folder / "report.html",
                                          "--json", folder / "result.json"});
  ASSERT_EQ(ran.exit_code, 0) << ran.errors;
  const auto in_page = dataOf(readFile(folder / "report.html"))["worst"];
  const auto corners = nlohmann::json::parse(readFile(folder / "result.json"))["quality"]["worst_corners"];
  ASSERT_EQ(in_page.size(), corners.size());
  std::map<std::string, int> of_file;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto& corner = corners[i];
    const std::string place = corner["place"];
    const std::size_t colon = place.rfind(':');
    const std::string file = place.substr(0, colon);
    ++of_file[file];
    EXPECT_EQ(place.substr(colon + 1), std::to_string(corner["line"].get<int>()));
    const std::string line = lineOf(readFile(file), corner["line"]);
    EXPECT_TRUE(
        line.starts_with(fmt::format("{},{},", corner["image"].get<int>(), corner["corner"].get<int>())))
        << line;
    EXPECT_TRUE(line.ends_with(
        fmt::format(",{:.4f},{:.4f}", corner["pixel"][0].get<double>(), corner["pixel"][1].get<double>())))
        << line << " " << corner["pixel"];
    if (corner["camera"] == "left")
      EXPECT_EQ(in_page[i]["line"], place);
    else
      EXPECT_EQ(in_page[i]["line"], corner["line"]);
  }
  EXPECT_EQ(of_file.size(), 3u) << "so that each file has some";
}

TEST(Report, OfFiveHundredImagesIsSmall) {
  testing::RigOptions options = testing::smallBoards();
  options.images = 500;
  options.cameras = 1;
  options.columns = options.rows = 6;
  testing::CalibratedRig r = testing::calibratedRig(options, testing::opencv4(), 1);
  ASSERT_TRUE(r.result.success());
  r.result.quality = assess(r.data, r.settings, r.result);
  const std::string page = toHtml(r.data, r.result);
  EXPECT_LT(page.size(), 600'000u);
  const auto data = dataOf(page);
  EXPECT_EQ(data["cameras"][0]["residuals"]["total"], r.result.cameras[0].corners);
  EXPECT_GT(data["cameras"][0]["residuals"]["every"], 1);
  EXPECT_LE(data["cameras"][0]["residuals"]["numbers"].size(), 4u * 4000);
}

TEST(Report, TellsAnAssumedSizeFromAKnownOne) {
  testing::CalibratedRig r = testing::calibratedRig(testing::smallBoards(), testing::opencv4(), 2);
  r.data.cameras[1].image_size.reset();
  const Quality quality = assess(r.data, r.settings, r.result);
  EXPECT_FALSE(quality.cameras[0].grid.box.is_assumed);
  EXPECT_EQ(quality.cameras[0].grid.box.width, 640);
  EXPECT_TRUE(quality.cameras[1].grid.box.is_assumed);
  EXPECT_EQ(quality.cameras[1].grid.box.width,
            640);  // a usual size that the optical axis, 330, 240, is near the centre of
  EXPECT_EQ(quality.cameras[1].grid.box.height, 480);
}

TEST(Report, SaysWhyThereAreNoHalves) {
  testing::RigOptions options = testing::smallBoards();
  options.images = 3;
  testing::CalibratedRig r = testing::calibratedRig(options, testing::opencv4(), 3);
  const Quality quality = assess(r.data, r.settings, r.result);
  EXPECT_EQ(quality.split_half.why_not, "the second half has fewer than 2 images of camera a");
  EXPECT_TRUE(quality.split_half.cameras.empty());
}

TEST(Report, IsWrittenOfAFitThatFailed) {
  const TemporaryFolder folder;
  const auto ran =
      testing::runCalibrate(stereo({"--quiet", "--max-iterations", "1", "--report", folder / "report.html"}));
  EXPECT_EQ(ran.exit_code, 1);
  const auto data = dataOf(readFile(folder / "report.html"));
  EXPECT_FALSE(data["success"].get<bool>());
  EXPECT_EQ(data["verdict"]["level"], "failed");
  EXPECT_TRUE(data["cameras"][0]["projection"].empty());
}

TEST(Report, MustNotReplaceAnotherFile) {
  const TemporaryFolder folder;
  const std::string file = folder / "result";
  const auto ran = testing::runCalibrate(stereo({"--report", file, "--json", file}));
  EXPECT_EQ(ran.exit_code, 2);
  EXPECT_EQ(ran.errors, "slom: --report " + file + ": this is the file of --json too; give another one\n");
}

}  // namespace
}  // namespace slom::app::calib
