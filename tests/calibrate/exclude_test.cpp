// `--exclude`: what is left out, where it is recorded, and what cannot be left out. Also the clustered standard
// deviations in the JSON.
#include <cmath>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calibrate/calibrate_command.hpp"
#include "calibrate/library.hpp"

namespace slom::app::calib {
namespace {

using nlohmann::json;
using testing::CommandResult;
using testing::RigOptions;
using testing::TemporaryFolder;

struct FilesOfOneCamera {
  explicit FilesOfOneCamera(int images = 12) {
    RigOptions options;
    options.images = images;
    std::mt19937_64 random(2);
    data = simulateMeasurements(simulateTruth(options, random), options, random);
    slom::testing::writeFile(folder / "a.csv", testing::cornerFile(data.cameras[0]));
    slom::testing::writeFile(folder / "b.csv", testing::cornerFile(data.cameras[1]));
  }
  std::string path(const std::string& name) const { return (folder / name).string(); }
  CommandResult run(std::vector<std::string> options, bool both = true) const {
    options.insert(options.begin(), {"--camera", "a=" + path("a.csv")});
    if (both) options.insert(options.begin(), {"--camera", "b=" + path("b.csv")});
    return testing::runCalibrate(options);
  }
  TemporaryFolder folder;
  Dataset data;
};

TEST(Exclude, LeavesOutImagesAndCorners) {
  const FilesOfOneCamera files;
  const std::string out = files.path("r.json");
  const CommandResult result =
      files.run({"--exclude", "3", "--exclude", "a.5:7", "--exclude", "b.6", "--json", out});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("  a: left out, by --exclude: image 3, corner 7 of image 5\n"),
            std::string::npos)
      << result.output;
  EXPECT_NE(result.output.find("  b: left out, by --exclude: image 3, image 6\n"), std::string::npos)
      << result.output;
  const json report = json::parse(std::ifstream(out));
  EXPECT_EQ(report["cameras"]["a"]["excluded"],
            json::parse(R"([{"image": 3, "corner": null}, {"image": 5, "corner": 7}])"));
  EXPECT_EQ(report["cameras"]["a"]["images"], 11);
  EXPECT_EQ(report["cameras"]["b"]["images"], 10);
  EXPECT_EQ(report["cameras"]["a"]["corners"].get<std::size_t>(),
            files.data.cameras[0].cornerCount() - files.data.cameras[0].find(3)->corners.size() - 1);
}

TEST(Exclude, RefusesWhatIsNotThere) {
  const FilesOfOneCamera files;
  const auto error = [&](const std::string& text, bool both = true) {
    const CommandResult result = files.run({"--exclude", text}, both);
    EXPECT_EQ(result.exit_code, 2);
    return result.errors;
  };
  EXPECT_EQ(error("17"), "slom: --exclude 17: there is no image 17; the nearest are 10, 11, 12\n");
  EXPECT_EQ(error("a.0"), "slom: --exclude a.0: that camera has no image 0; the nearest are 1, 2, 3\n");
  EXPECT_EQ(error("c.3"), "slom: --exclude c.3: there is no camera c; name one of b, a\n");
  EXPECT_EQ(error("3:5"),
            "slom: --exclude 3:5: several cameras have that image, and each numbers corners in its own way; "
            "name the camera, as in b.3:5\n");
  EXPECT_EQ(error("3:99", false),
            "slom: --exclude 3:99: image 3 of camera a has no corner 99; the nearest are 46, 47, 48\n");
  for (const std::string text : {"x", "3:", ":5", "3:5:1", "3.5x", ""}) {
    EXPECT_EQ(error(text, false),
              "slom: --exclude " + text +
                  ": write IMAGE, IMAGE:CORNER or CAMERA.IMAGE:CORNER, as in --exclude 17 or "
                  "--exclude a.17:5\n");
  }
}

TEST(Exclude, TakesReadingsWithTheImagesThatNoCameraHasThen) {
  Dataset data = FilesOfOneCamera().data;
  exclude(data, {{"", 3, {}}, {"a", 4, {}}});
  EXPECT_EQ(data.imu->readings.size(), 11u);
  EXPECT_EQ(data.cameras[0].find(4), nullptr);
  EXPECT_NE(data.cameras[1].find(4), nullptr);
  const Dataset before = data;
  try {
    exclude(data, {{"", 5, {}}, {"", 3, {}}});
    FAIL();
  } catch (const DataError& error) {
    EXPECT_EQ(error.id(), "slom.calibration.nothing-to-exclude");
    EXPECT_EQ(error.sentence(), "exclusion 3: there is no image 3; the nearest are 1, 2, 4");
  }
  EXPECT_NE(data.cameras[0].find(5), nullptr);  // as it was before
}

TEST(Exclude, SaysWhatIsExcludedTwice) {
  Dataset data = FilesOfOneCamera().data;
  const auto sentence = [&](const std::vector<Exclusion>& exclusions) -> std::string {
    try {
      exclude(data, exclusions);
    } catch (const DataError& error) {
      return std::string(error.sentence());
    }
    return "no error";
  };
  EXPECT_EQ(sentence({{"", 5, {}}, {"", 5, {}}}),
            "exclusion 5: another exclusion already leaves that out; give one of the two");
  EXPECT_EQ(sentence({{"a", 5, {}}, {"a", 5, 7}}),
            "exclusion a.5:7: another exclusion already leaves that out; give one of the two");
  EXPECT_EQ(sentence({{"a", 5, 7}, {"a", 5, 7}}),
            "exclusion a.5:7: another exclusion already leaves that out; give one of the two");
  EXPECT_EQ(sentence({{"a", 5, {}}, {"", 5, {}}}), "no error");
}

TEST(ClusteredOutput, IsBesideTheStatedStandardDeviations) {
  const FilesOfOneCamera files;
  const std::string out = files.path("r.json");
  const CommandResult result = files.run({"--json", out});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("                             stated       clustered\n  fx  "),
            std::string::npos)
      << result.output;
  const json report = json::parse(std::ifstream(out));
  const json& clustered = report["clustered"];
  for (const char* name : {"images", "board_points", "block_length", "blocks", "levels_off", "extrapolation",
                           "ratio_by_image", "ratio_by_block", "ratio", "is_reliable", "notes", "covariance"})
    EXPECT_TRUE(clustered.contains(name)) << name;
  EXPECT_EQ(clustered["images"], 12);
  EXPECT_EQ(clustered["board_points"], 48);
  EXPECT_EQ(clustered["is_reliable"], true);
  ASSERT_EQ(clustered["covariance"].size(), 9u + 9u + 6u);
  for (const auto& [name, parameter] : report["cameras"]["a"]["parameters"].items()) {
    EXPECT_GT(parameter["std_clustered"].get<double>(), 0.3 * parameter["std"].get<double>()) << name;
    EXPECT_LT(parameter["std_clustered"].get<double>(), 3 * parameter["std"].get<double>()) << name;
    EXPECT_GT(parameter["dof"].get<double>(), 1) << name;
  }
  EXPECT_EQ(report["cameras"]["a"]["pose_from_b"]["std_clustered"].size(), 6u);
  EXPECT_EQ(report["cameras"]["a"]["pose_from_b"]["dof"].size(), 6u);
  EXPECT_EQ(report["quality"]["is_clustered"], true);
  EXPECT_EQ(report["quality"]["cameras"]["a"]["projection_stated"].size(), 2u);
  EXPECT_TRUE(report["gross_corners"].empty());
  EXPECT_TRUE(report["rejected_corners"].empty());
}

TEST(BoardShapeOption, EstimatesTheBoard) {
  const FilesOfOneCamera files;
  const std::string out = files.path("r.json");
  ASSERT_EQ(files.run({"--board-shape", "free", "--json", out}).exit_code, 0);
  json report = json::parse(std::ifstream(out));
  const json board = report["board"];
  EXPECT_EQ(board["shape"], "free");
  ASSERT_EQ(board["corners"].size(), 48u);
  double square = 0;
  for (const json& corner : board["corners"]) {
    square += std::pow(corner["displacement_m"][2].get<double>(), 2);
    EXPECT_GT(corner["std_m"][0].get<double>(), 0);
    EXPECT_EQ(corner["world_m"][2], 0);
  }
  EXPECT_NEAR(board["off_plane_m"].get<double>(), std::sqrt(square / 48), 1e-9);
  const CommandResult bent = files.run({"--board-shape", "bent", "--json", out}, false);
  ASSERT_EQ(bent.exit_code, 0);
  report = json::parse(std::ifstream(out));
  EXPECT_EQ(report["board"]["shape"], "bent");
  EXPECT_NE(bent.output.find("\nboard: bent, 48 corners, RMS from their stated positions: "),
            std::string::npos)
      << bent.output;
  ASSERT_EQ(files.run({"--json", out}, false).exit_code, 0);
  EXPECT_EQ(json::parse(std::ifstream(out))["board"], nullptr);
}

TEST(BoardShapeOption, IsComparedUnlessItIsGiven) {
  const FilesOfOneCamera files;
  const std::string out = files.path("r.json");
  const CommandResult all = files.run({"--compare", "opencv4,opencv5", "--json", out}, false);
  ASSERT_EQ(all.exit_code, 0) << all.errors;
  const json shapes = json::parse(std::ifstream(out))["board_comparison"];
  ASSERT_EQ(shapes["models"].size(), 3u);
  EXPECT_EQ(shapes["models"][1]["board_shape"], "bent");
  EXPECT_EQ(shapes["chosen_board_shape"], "flat");
  EXPECT_NE(all.output.find("\nshapes of the board compared, with "), std::string::npos);
  EXPECT_NE(all.output.find("The data support no other board than the stated one."), std::string::npos)
      << all.output;
  ASSERT_EQ(files.run({"--compare", "opencv5", "--board-shape", "bent", "--json", out}, false).exit_code, 0);
  const json report = json::parse(std::ifstream(out));
  EXPECT_EQ(report["board_comparison"], nullptr);
  EXPECT_EQ(report["board"]["shape"], "bent");
  EXPECT_EQ(report["comparison"]["models"][0]["board_shape"], "bent");
}

TEST(BoardShapeOption, RefusesWhatMakesNoSense) {
  const FilesOfOneCamera files;
  const auto error = [&](std::vector<std::string> options) {
    const CommandResult result = files.run(std::move(options), false);
    EXPECT_EQ(result.exit_code, 2);
    return result.errors;
  };
  EXPECT_EQ(error({"--board-shape", "round"}),
            "slom: --board-shape round: unknown shape; give flat, bent or free\n");
  EXPECT_EQ(error({"--board-shape", "free", "--sigma-board", "0"}),
            "slom: --sigma-board 0: a standard deviation must be positive\n");
  EXPECT_EQ(error({"--board-shape", "free", "--sigma-board", "1e-12"}),
            "slom: --sigma-board 1e-12: standard deviation out of range; give 1e-09 to 1e+06 m\n");
  EXPECT_EQ(error({"--sigma-board", "0.001"}),
            "slom: --sigma-board 0.001: applies only to a free board; add --board-shape free\n");
}

TEST(BoardShapeOption, ModelsAreComparedAgainOnTheBoardThatIsChosen) {
  FilesOfOneCamera files;
  for (View& view : files.data.cameras[0].views) {
    for (Corner& corner : view.corners)
      corner.world += 1e-3 * vec3(std::sin(5. * corner.number), std::cos(7. * corner.number),
                                  std::sin(11. * corner.number));
  }
  slom::testing::writeFile(files.folder / "a.csv", testing::cornerFile(files.data.cameras[0]));
  const std::string out = files.path("r.json");
  const CommandResult result = files.run({"--compare", "radial1,opencv5,opencv8", "--json", out}, false);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json report = json::parse(std::ifstream(out));
  EXPECT_EQ(report["board"]["shape"], "free");
  EXPECT_NE(result.output.find("\nwith a free board:\n\nmodels compared\n"), std::string::npos)
      << result.output;
  ASSERT_EQ(report["comparison"]["models"].size(), 2u) << "opencv8 is not tried again";
  EXPECT_EQ(report["comparison"]["models"][1]["model"], "opencv5");
  EXPECT_EQ(report["comparison"]["models"][1]["board_shape"], "free");
  ASSERT_EQ(report["noise_comparison"]["trials"].size(), 4u);
  EXPECT_EQ(report["noise_comparison"]["trials"][0]["by"], "constant");
  EXPECT_NE(result.output.find("\nnoise of corners compared\n"), std::string::npos);
}

TEST(RobustOption, RejectsGrossCornersUnlessItIsNone) {
  FilesOfOneCamera files;
  Corner& wrong = files.data.cameras[0].views[3].corners[10];
  wrong.pixel.x() += 13;
  slom::testing::writeFile(files.folder / "a.csv", testing::cornerFile(files.data.cameras[0]));
  const std::string out = files.path("r.json");
  const CommandResult rejected = files.run({"--json", out}, false);
  ASSERT_EQ(rejected.exit_code, 0) << rejected.errors;
  const std::string sentence =
      "One corner was left out of the fit, because the others contradict it: corner " +
      std::to_string(wrong.number) + " of image 4 of camera a (";
  const json report = json::parse(std::ifstream(out));
  ASSERT_EQ(report["notes"].size(), 2u) << report["notes"];
  const std::string note = report["notes"][0];
  EXPECT_EQ(note.substr(0, sentence.size()), sentence);
  ASSERT_EQ(report["rejected_corners"].size(), 1u);
  const double error = report["rejected_corners"][0]["error_without_px"];
  EXPECT_NEAR(error, 13, 1);
  EXPECT_TRUE(note.ends_with(fmt::format(") by {:.1f} px. --robust none keeps it.", error))) << note;
  EXPECT_EQ(report["rejected_corners"][0]["image"], 4);
  EXPECT_EQ(report["rejected_corners"][0]["corner"], wrong.number);
  ASSERT_EQ(files.run({"--robust", "none", "--json", out}, false).exit_code, 0);
  const json kept = json::parse(std::ifstream(out));
  EXPECT_TRUE(kept["rejected_corners"].empty());
  ASSERT_EQ(kept["gross_corners"].size(), 1u);
  EXPECT_EQ(kept["gross_corners"][0]["corner"], wrong.number);
  for (const auto& [loss, text] : {std::pair("huber", "Huber(1.5)"), std::pair("cauchy", "Cauchy(2.55)")}) {
    const CommandResult result = files.run({"--robust", loss, "--sigma-by", "slant", "--json", out}, false);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(result.output.find(fmt::format("\nrobust loss {}: ", text)), std::string::npos)
        << result.output;
    const json robust = json::parse(std::ifstream(out));
    EXPECT_EQ(robust["downweighted"]["loss"], text);
    EXPECT_EQ(robust["cameras"]["a"]["noise"]["by"], "slant");
    EXPECT_TRUE(robust["rejected_corners"].empty());
  }
  const CommandResult unknown = files.run({"--robust", "huge"}, false);
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_EQ(unknown.errors,
            "slom: --robust huge: unknown treatment of gross corners; give none, reject, huber or "
            "cauchy\n");
}

}  // namespace
}  // namespace slom::app::calib
