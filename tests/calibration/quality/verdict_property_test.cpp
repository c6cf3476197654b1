// No verdict contradicts the rest of the assessment, over simulated, shipped and public data. Seeds are fixed.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <slom/calibration.hpp>

#include "calibration/simulated_rig.hpp"
#include "support/paths.hpp"

namespace slom::calibration {
namespace {

using slom::testing::sharedDataPath;
using slom::testing::sourcePath;

Verdict assessed(const Dataset& data, const Settings& settings, Result& result) {
  result = calibrate(data, settings);
  result.quality = assess(data, settings, result);
  return verdictOf(result);
}

/// What the report says below the verdict and nobody may trust.
std::vector<std::string> linesAgainst(const Result& result) {
  std::vector<std::string> lines;
  if (!result.success() || !result.strays.empty() || !result.causes.empty() || result.better_model)
    lines.push_back("result");
  if (!result.quality->hasProjection()) return lines;
  const Quality& quality = *result.quality;
  for (std::size_t c = 0; c < quality.cameras.size(); ++c) {
    for (const ProjectionUncertainty& map : quality.cameras[c].projection) {
      if (!(map.worst_px <= 3)) lines.push_back("projection");
    }
    for (const Parameter& p : result.cameras[c].parameters) {
      if (p.name.starts_with("f") && p.std > 0.02 * p.value) lines.push_back(p.name);
    }
  }
  if (!quality.split_half.why_not.empty()) lines.push_back("halves");
  for (const ImuFinding& finding : imuFindings(result)) {
    if (finding.is_unusable) lines.push_back("imu");
  }
  return lines;
}

void expectNoContradiction(const Verdict& verdict, const Result& result, const std::string& which) {
  const std::vector<std::string> lines = linesAgainst(result);
  EXPECT_TRUE(verdict.level != Verdict::Level::trustworthy || lines.empty())
      << which << ": " << lines.front();
  EXPECT_EQ(verdict.level == Verdict::Level::trustworthy, verdict.doubts.empty() && result.success())
      << which;
}

/// One camera before boards that are tilted by at most this angle [rad].
Dataset boardsTiltedBy(double tilt, int images, unsigned seed) {
  testing::RigOptions options;
  options.cameras = 1;
  options.images = images;
  options.columns = 9, options.rows = 6;
  options.sigma_px = 0.2;
  options.tilt = tilt;
  std::mt19937_64 random(seed);
  Dataset data = testing::simulateMeasurements(testing::simulateTruth(options, random), options, random);
  for (CameraData& camera : data.cameras) camera.image_size = ImageSize{640, 480};
  data.imu.reset();
  return data;
}

Settings precise() {
  Settings settings;
  settings.sigma_px = 0.2;
  return settings;
}

TEST(VerdictProperty, NearlyParallelBoardsAreNeverTrustworthy) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    Result result;
    const Verdict verdict = assessed(boardsTiltedBy(0.06, 12, seed), precise(), result);
    EXPECT_NE(verdict.level, Verdict::Level::trustworthy) << seed << ": " << verdict.sentence;
    expectNoContradiction(verdict, result, "seed " + std::to_string(seed));
    if (!result.success()) continue;
    const bool names_tilt =
        std::any_of(verdict.doubts.begin(), verdict.doubts.end(), [](const std::string& doubt) {
          return doubt.find("nearly parallel") != std::string::npos &&
                 doubt.find("tilted by 40 degrees") != std::string::npos;
        });
    EXPECT_TRUE(names_tilt) << seed << ": " << verdict.sentence;
  }
}

TEST(VerdictProperty, HoldsForAnyTilt) {
  for (const double tilt : {0.1, 0.2, 0.4, 0.7}) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
      Result result;
      const Verdict verdict = assessed(boardsTiltedBy(tilt, 14, seed), precise(), result);
      expectNoContradiction(verdict, result, std::to_string(tilt) + ", seed " + std::to_string(seed));
    }
  }
}

TEST(VerdictProperty, HoldsForRecordedData) {
  const auto check = [](const std::vector<std::filesystem::path>& cameras, const std::filesystem::path& imu) {
    if (!std::filesystem::exists(cameras.front())) return;
    Dataset data;
    for (const auto& file : cameras) data.cameras.push_back(readCorners(file.stem().string(), file.string()));
    if (!imu.empty()) data.imu = readImu(imu.string());
    Result result;
    const Verdict verdict = assessed(data, Settings(), result);
    expectNoContradiction(verdict, result, cameras.front().string());
  };
  check(
      {sourcePath("data/opencv_stereo/left_corners.csv"), sourcePath("data/opencv_stereo/right_corners.csv")},
      {});
  check({sourcePath("data/simulated_stereo_imu/left_corners.csv"),
         sourcePath("data/simulated_stereo_imu/right_corners.csv")},
        sourcePath("data/simulated_stereo_imu/imu.csv"));
  check({sharedDataPath("mono/corners.csv")}, {});
  check({sharedDataPath("zhang1998/corners.csv")}, {});
  check({sharedDataPath("justin/left_corners.csv"), sharedDataPath("justin/right_corners.csv")},
        sharedDataPath("justin/imu.csv"));
}

}  // namespace
}  // namespace slom::calibration
