// Data that no lens explains: which image, or which kind of mistake, is named. Seeds are fixed.
#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "calibrate/calibrate_command.hpp"
#include "calibration/simulated_rig.hpp"
#include "calibration/simulated_views.hpp"
#include "support/fresh_seed.hpp"

namespace slom::app::calib {
namespace {

using testing::RigOptions;

/// Views of a whole board by one camera.
Dataset wholeBoards(unsigned seed, int columns = 9, int rows = 6, double distance = 0.6, int images = 10) {
  RigOptions options;
  options.cameras = 1;
  options.images = images;
  options.columns = columns, options.rows = rows;
  options.square_m = 0.03;
  options.distance = distance;
  std::mt19937_64 random(seed);
  const testing::RigTruth truth = testing::simulateTruth(options, random);
  Dataset data = testing::simulateMeasurements(truth, options, random);
  data.imu.reset();
  return data;
}

/// Focal length and the image that is left out.
void expectLeftOut(const Dataset& data, int image, unsigned seed) {
  const Result result = calibrate(data, Settings());
  ASSERT_TRUE(result.success()) << seed << " " << result.message;
  ASSERT_EQ(result.strays.size(), 1u) << seed;
  EXPECT_EQ(result.strays[0].image, image) << seed;
  EXPECT_TRUE(result.strays[0].is_left_out) << seed;
  EXPECT_NEAR(result.cameras[0].parameters[0].value, 600, 12) << seed;
  EXPECT_NE(verdictOf([&] {
              Result assessed = result;
              assessed.quality = assess(data, Settings(), result);
              return assessed;
            }())
                .level,
            Verdict::Level::trustworthy);
}

TEST(SecondLook, ATornViewIsLeftOut) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Dataset data = wholeBoards(seed);
    auto& views = data.cameras[0].views;
    auto& torn = views[4].corners;
    const auto& next = views[5].corners;
    for (std::size_t k = torn.size() / 2; k < std::min(torn.size(), next.size()); ++k) {
      const auto other = std::find_if(next.begin(), next.end(),
                                      [&](const Corner& one) { return one.number == torn[k].number; });
      if (other != next.end()) torn[k].pixel = other->pixel;
    }
    expectLeftOut(data, views[4].image, seed);
  }
}

TEST(SecondLook, AViewWithShuffledCornersIsLeftOut) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Dataset data = wholeBoards(seed);
    auto& corners = data.cameras[0].views[3].corners;
    std::vector<vec2> pixels;
    for (const Corner& corner : corners) pixels.push_back(corner.pixel);
    std::mt19937 random(seed);
    std::shuffle(pixels.begin(), pixels.end(), random);
    for (std::size_t k = 0; k < pixels.size(); ++k) corners[k].pixel = pixels[k];
    expectLeftOut(data, data.cameras[0].views[3].image, seed);
  }
}

void scaleViews(Dataset& data, const std::vector<std::size_t>& views, double size) {
  for (const std::size_t i : views) {
    for (Corner& corner : data.cameras[0].views[i].corners) corner.pixel *= size;
  }
}

TEST(SecondLook, ImagesOfAnotherSizeAreNamedAsAWhole) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const double size = seed <= 12 ? 0.5 : seed <= 16 ? 0.25 : 0.75;
    Dataset data = wholeBoards(seed, 9, 6, 0.35);
    const std::vector<std::size_t> scaled =
        seed % 4 == 0 && size == 0.5 ? std::vector<std::size_t>{2, 5, 8} : std::vector<std::size_t>{3, 6};
    scaleViews(data, scaled, size);
    const Result result = calibrate(data, Settings());
    ASSERT_EQ(result.strays.size(), scaled.size()) << seed;
    for (std::size_t i = 0; i < scaled.size(); ++i) {
      EXPECT_EQ(result.strays[i].image, data.cameras[0].views[scaled[i]].image) << seed;
      EXPECT_EQ(result.strays[i].size, size) << seed;
      EXPECT_TRUE(result.strays[i].is_left_out) << seed;
    }
    const Parameter& fx = result.cameras[0].parameters[0];
    EXPECT_NEAR(fx.value, 600, 4 * fx.std) << seed;
  }
}

/// From afar the boards are small, and a lens with another principal point nearly explains images of half the size.
TEST(SecondLook, ImagesOfAnotherSizeAreNamedFromAfarToo) {
  int named = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Dataset data = wholeBoards(seed, 9, 6, 0.6);
    scaleViews(data, {3, 6}, 0.5);
    const Result result = calibrate(data, Settings());
    for (const Stray& stray : result.strays) {
      const bool is_scaled =
          stray.image == data.cameras[0].views[3].image || stray.image == data.cameras[0].views[6].image;
      EXPECT_TRUE(is_scaled && stray.size == 0.5) << seed << ": image " << stray.image;
    }
    named += result.strays.size() == 2 ? 1 : 0;
  }
  EXPECT_GE(named, 18);
}

/// In a rig, the view of the other camera at the same time seems to contradict.
TEST(SecondLook, ImagesOfAnotherSizeAreNamedInARig) {
  std::mt19937_64 random(slom::testing::freshSeed());
  int named = 0;
  for (int repetition = 0; repetition < 12; ++repetition) {
    RigOptions options;
    options.cameras = 2;
    options.images = 12;
    options.columns = 9, options.rows = 6;
    options.square_m = 0.03;
    options.distance = 0.4;
    const testing::RigTruth truth = testing::simulateTruth(options, random);
    Dataset data = testing::simulateMeasurements(truth, options, random);
    data.imu.reset();
    const std::size_t camera = random() % 2, i = random() % data.cameras[camera].views.size();
    const double size = random() % 2 == 0 ? 0.5 : 2;
    View& view = data.cameras[camera].views[i];
    for (Corner& corner : view.corners) corner.pixel *= size;
    const Result result = calibrate(data, Settings());
    ASSERT_EQ(result.strays.size(), 1u)
        << camera << " " << view.image << " " << size << " " << result.message;
    const Stray& stray = result.strays[0];
    EXPECT_EQ(stray.image, view.image);
    if (!stray.is_left_out) continue;  // a board far away, seen from the front, fits at any size
    ++named;
    EXPECT_EQ(stray.camera, data.cameras[camera].name);
    EXPECT_EQ(stray.size, size);
  }
  EXPECT_GE(named, 10);
}

/// A few of many images hardly change the lens, so that the fit of all shows them.
TEST(SecondLook, ImagesOfAnotherSizeAreNamedAmongMany) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const double size = seed % 2 == 0 ? 0.75 : 0.5;
    const int images = seed <= 4 ? 100 : 310;
    Dataset data = wholeBoards(seed, 9, 6, 0.35, images);
    const std::vector<std::size_t> scaled{7, 50, 51};
    scaleViews(data, scaled, size);
    const Result result = calibrate(data, Settings());
    ASSERT_EQ(result.strays.size(), scaled.size()) << seed;
    for (std::size_t i = 0; i < scaled.size(); ++i) {
      EXPECT_EQ(result.strays[i].image, data.cameras[0].views[scaled[i]].image) << seed;
      EXPECT_EQ(result.strays[i].size, size) << seed;
    }
  }
}

TEST(SecondLook, NoImageOfManyGoodOnesIsOfAnotherSize) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Result result = calibrate(wholeBoards(seed, 9, 6, seed % 2 == 0 ? 0.35 : 0.6, 100), Settings());
    ASSERT_TRUE(result.success()) << seed;
    EXPECT_TRUE(result.strays.empty()) << seed;
  }
}

TEST(SecondLook, NoImageOfGoodDataIsOfAnotherSize) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const Result result = calibrate(wholeBoards(seed, 9, 6, seed % 2 == 0 ? 0.35 : 0.6), Settings());
    ASSERT_TRUE(result.success()) << seed;
    EXPECT_TRUE(result.strays.empty()) << seed;
  }
}

testing::CommandResult calibratedByCommand(const Dataset& data, const testing::TemporaryFolder& folder,
                                           std::vector<std::string> more = {}) {
  slom::testing::writeFile(folder / "cam.csv", testing::cornerFile(data.cameras[0]));
  more.insert(more.begin(), {"--camera", "cam=" + (folder / "cam.csv").string(), "--output",
                             (folder / "c.yaml").string(), "--json", (folder / "r.json").string()});
  return testing::runCalibrate(more);
}

TEST(SecondLook, TheCommandSaysHowToLeaveOutImagesOfAnotherSize) {
  Dataset data = wholeBoards(3, 9, 6, 0.35);
  scaleViews(data, {3, 4}, 0.5);
  const testing::TemporaryFolder folder;
  const testing::CommandResult result = calibratedByCommand(data, folder);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "c.yaml"));
  EXPECT_NE(
      result.errors.find(
          "images 4 and 5 of cam are at half the size of the others: pass --exclude 4 --exclude 5, or scale them"),
      std::string::npos)
      << result.errors;
  EXPECT_EQ(calibratedByCommand(data, folder, {"--exclude", "4", "--exclude", "5", "--quiet"}).errors, "");
}

/// A corner that stays in the fit is named, and no other cause is looked for.
TEST(SecondLook, ASingleGrossCornerIsTheCause) {
  for (const char* const robust : {"none", "huber", "cauchy"}) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
      for (const double off : {18., 150.}) {
        Dataset data = wholeBoards(seed);
        data.cameras[0].views[2].corners[10].pixel += vec2(off, -0.7 * off);
        const testing::TemporaryFolder folder;
        const testing::CommandResult result = calibratedByCommand(data, folder, {"--robust", robust});
        const std::string said = result.output + result.errors;
        EXPECT_EQ(said.find("no usual cause is found"), std::string::npos)
            << robust << " " << seed << " " << off << "\n"
            << said;
        EXPECT_NE(said.find(fmt::format("corner {}", data.cameras[0].views[2].corners[10].number)),
                  std::string::npos)
            << robust << said;
      }
    }
  }
}

std::string refusal(const Dataset& data) {
  try {
    (void)calibrate(data, Settings());
  } catch (const DataError& error) {
    return std::string(error.sentence());
  }
  return "";
}

TEST(SecondLook, RowsAndColumnsExchangedAreNamed) {
  for (const auto& [columns, rows] : {std::pair(6, 5), std::pair(9, 6)}) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
      Dataset data = wholeBoards(seed, columns, rows);
      for (View& view : data.cameras[0].views) {
        for (Corner& corner : view.corners) {
          const int k = corner.number - 1;
          corner.world = vec3(0.03 * (k % rows), 0.03 * (k / rows), 0.);
        }
      }
      const std::string sentence = refusal(data);
      EXPECT_NE(sentence.find("rows and columns are exchanged"), std::string::npos)
          << seed << ": " << sentence;
    }
  }
}

TEST(SecondLook, AnAsymmetricGridOfCirclesIsNamed) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    RigOptions options;
    options.cameras = 1;
    std::mt19937_64 random(seed);
    const testing::RigTruth truth = testing::simulateTruth(options, random);
    Dataset data = testing::simulateMeasurements(truth, options, random);
    data.imu.reset();
    for (View& view : data.cameras[0].views) {
      const SE3 left2world = truth.left2world.at(view.image);
      for (int k = 0; k < int(view.corners.size()); ++k) {
        Corner& corner = view.corners[std::size_t(k)];
        const int i = (corner.number - 1) % 8, j = (corner.number - 1) / 8;
        const vec3 there(0.04 * i + 0.02 * (j % 2), 0.04 * j, 0.);
        corner.pixel = vec2(truth.cameras[0].project(vec3(left2world.inverse() * there)));
        corner.world = vec3(0.04 * i, 0.04 * j, 0.);
      }
    }
    const std::string sentence = refusal(data);
    EXPECT_NE(sentence.find("asymmetric grid of circles"), std::string::npos) << seed << ": " << sentence;
  }
}

TEST(SecondLook, GoodDataAreNotLookedAtTwice) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Result result = calibrate(wholeBoards(seed), Settings());
    EXPECT_TRUE(result.strays.empty() && result.causes.empty() && !result.better_model) << seed;
  }
}

TEST(SecondLook, NearlyParallelBoardsAreTheCause) {
  RigOptions options;
  options.cameras = 1;
  options.tilt = 0.02;
  std::mt19937_64 random(1);
  const testing::RigTruth truth = testing::simulateTruth(options, random);
  Dataset data = testing::simulateMeasurements(truth, options, random);
  data.imu.reset();
  const Result result = calibrate(data, Settings());
  EXPECT_FALSE(result.success());
  EXPECT_NE(result.undetermined.find("same tilt"), std::string::npos) << result.undetermined;
  EXPECT_EQ(result.causes, std::vector<std::string>{result.undetermined});
}

TEST(SecondLook, ABoardCountedFromItsOtherEndIsNamed) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    RigOptions options;
    options.columns = 7, options.rows = 5;
    std::mt19937_64 random(seed);
    const testing::RigTruth truth = testing::simulateTruth(options, random);
    Dataset data = testing::simulateMeasurements(truth, options, random);
    data.imu.reset();
    for (View& view : data.cameras[1].views) {
      for (Corner& corner : view.corners)
        corner.world = vec3(0.05 * 6 - corner.world.x(), 0.05 * 4 - corner.world.y(), 0.);
    }
    const Result result = calibrate(data, Settings());
    ASSERT_FALSE(result.strays.empty()) << seed;
    EXPECT_NE(result.strays.front().why.find("another end of the board: turned by 180 degrees"),
              std::string::npos)
        << seed << ": " << result.strays.front().why;
  }
}

/// The command ends with 1, writes no YAML and names the image.
TEST(SecondLook, TheCommandWritesNoYamlOfATornView) {
  Dataset data = wholeBoards(2);
  auto& corners = data.cameras[0].views[4].corners;
  for (std::size_t k = corners.size() / 2; k < corners.size(); ++k) corners[k].pixel += vec2(60., -35.);
  const auto result = testing::runWithUnusableResult(data.cameras[0]);
  EXPECT_NE(result.errors.find(": corners disagree by "), std::string::npos) << result.errors;
}

}  // namespace
}  // namespace slom::app::calib
