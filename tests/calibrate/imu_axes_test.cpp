// Readings of an IMU in another unit or along wrong axes, for rigs of several seeds. Exit code, verdict and JSON name
// the cause.
#include <functional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calibrate/calibrate_command.hpp"
#include "calibrate/soundness.hpp"

namespace slom::app::calib {
namespace {

using testing::CommandResult;
using testing::TemporaryFolder;

using Change = std::function<vec3(const vec3&)>;

struct CalibratedRig {
  CommandResult result;
  nlohmann::json json;
  bool has_yaml = false;
};

/// The rig of a seed with changed readings, by the command.
CalibratedRig calibrated(unsigned seed, const Change& change, const std::vector<std::string>& more = {}) {
  testing::RigOptions options;
  options.images = 12;
  options.z_down = seed % 2 == 0;
  std::mt19937_64 random(seed);
  testing::RigTruth truth = testing::simulateTruth(options, random);
  if (options.z_down) truth.gravity = -truth.gravity;  // readings point up
  Dataset data = testing::simulateMeasurements(truth, options, random);
  for (ImuReading& reading : data.imu->readings) reading.acc = change(reading.acc);
  const TemporaryFolder folder;
  slom::testing::writeFile(folder / "left.csv", testing::cornerFile(data.cameras[0]));
  slom::testing::writeFile(folder / "right.csv", testing::cornerFile(data.cameras[1]));
  slom::testing::writeFile(folder / "imu.csv", testing::imuFile(*data.imu));
  std::vector<std::string> words{"--camera", "left=" + (folder / "left.csv").string(),
                                 "--camera", "right=" + (folder / "right.csv").string(),
                                 "--imu",    (folder / "imu.csv").string(),
                                 "--json",   (folder / "r.json").string(),
                                 "--output", (folder / "c.yaml").string(),
                                 "--quiet"};
  words.insert(words.end(), more.begin(), more.end());
  CalibratedRig run{testing::runCalibrate(words), {}, std::filesystem::exists(folder / "c.yaml")};
  run.json = nlohmann::json::parse(slom::testing::readFile(folder / "r.json"));
  return run;
}

bool says(const nlohmann::json& sentences, const std::string& part) {
  return std::any_of(sentences.begin(), sentences.end(), [&](const nlohmann::json& one) {
    return one.get<std::string>().find(part) != std::string::npos;
  });
}

/// Exit code 1, no YAML, and the cause in the sentence, the notes and the verdict.
void expectNamed(const CalibratedRig& run, const std::string& fault, const std::string& which) {
  EXPECT_EQ(run.result.exit_code, 1) << which;
  EXPECT_FALSE(run.has_yaml) << which;
  EXPECT_NE(run.result.errors.find(fault), std::string::npos) << which << ": " << run.result.errors;
  EXPECT_NE(run.json["quality"]["verdict"]["level"], "trustworthy") << which;
  EXPECT_TRUE(says(run.json["quality"]["verdict"]["doubts"], fault)) << which;
  EXPECT_TRUE(says(run.json["notes"], fault.substr(4))) << which;  // which begins with a capital letter
}

const Change unchanged = [](const vec3& a) { return a; };
const Change inverted = [](const vec3& a) { return vec3(-a); };

TEST(ImuAxes, GoodReadingsAreKept) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const CalibratedRig run = calibrated(seed, unchanged);
    EXPECT_EQ(run.result.exit_code, 0) << seed << ": " << run.result.errors;
    EXPECT_TRUE(run.has_yaml) << seed;
    EXPECT_NEAR(std::abs(run.json["imu"]["gravity"].get<double>()), 9.81, 0.5) << seed;
  }
}

TEST(ImuAxes, LeftHandedAxesAreNamedWithGravity) {
  const std::pair<const char*, Change> changes[] = {
      {"x inverted", [](const vec3& a) { return vec3(-a.x(), a.y(), a.z()); }},
      {"z inverted", [](const vec3& a) { return vec3(a.x(), a.y(), -a.z()); }},
      {"all inverted", inverted},
      {"x and y exchanged", [](const vec3& a) { return vec3(a.y(), a.x(), a.z()); }}};
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const auto& [what, change] = changes[seed % 4];
    const std::string which = std::string(what) + ", seed " + std::to_string(seed);
    const CalibratedRig run = calibrated(seed, change);
    expectNamed(run, "the readings of the IMU point down by", which);
    const double gravity = std::abs(run.json["imu"]["gravity"].get<double>());
    EXPECT_NE(run.result.errors.find(fmt::format("point down by {} m/s^2 at rest", twoDigits(gravity))),
              std::string::npos)
        << run.result.errors;
    EXPECT_NE(run.result.errors.find("pass --imu-reads gravity"), std::string::npos) << which;
  }
}

TEST(ImuAxes, ASensorThatReadsGravityIsStated) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const CalibratedRig run = calibrated(seed, inverted, {"--imu-reads", "gravity"});
    EXPECT_EQ(run.result.exit_code, 0) << seed << ": " << run.result.errors;
    EXPECT_TRUE(run.has_yaml) << seed;
    expectNamed(calibrated(seed, unchanged, {"--imu-reads", "gravity"}),
                "the readings of the IMU point up by", std::to_string(seed));
  }
}

TEST(ImuAxes, ReadingsInGAreNamed) {
  static constexpr double g = 9.80665;
  for (unsigned seed = 1; seed <= 9; ++seed) {
    const CalibratedRig run = calibrated(seed, [](const vec3& a) { return vec3(a / g); });
    const std::string which = "seed " + std::to_string(seed),
                      remedy = "eadings seem to be in g: multiply them by 9.80665";
    EXPECT_EQ(run.result.exit_code, 1) << which;
    EXPECT_FALSE(run.has_yaml) << which;
    EXPECT_NE(run.result.errors.find(remedy), std::string::npos) << which << ": " << run.result.errors;
    EXPECT_TRUE(says(run.json["notes"], remedy)) << which;
    EXPECT_TRUE(says(run.json["quality"]["verdict"]["doubts"], remedy)) << which;
  }
}

}  // namespace
}  // namespace slom::app::calib
