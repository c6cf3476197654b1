// The double-sphere model: its formula, points without an image, calibration of such a lens, and the command.
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calibrate/calibrate_command.hpp"
#include "calibrate/library.hpp"
#include "calibration/models/lens.hpp"
#include "calibration/simulated_views.hpp"

namespace slom::app::calib {
namespace {

using nlohmann::json;
using slom::testing::readFile;

CameraResult cameraOf(const std::vector<double>& values) {
  CameraResult camera;
  camera.model = "double_sphere";
  const std::vector<std::string>& names = Model("double_sphere").parameters();
  for (std::size_t i = 0; i < names.size(); ++i) camera.parameters.push_back({names[i], values.at(i), 1});
  return camera;
}

const std::vector<double> fisheye_lens{230, 232, 322, 243, -0.18, 0.59};

/// Written down once more from the paper, with more digits.
vec2 pixelByFormula(const std::vector<double>& c, const vec3& p) {
  const long double x = p.x(), y = p.y(), z = p.z(), xi = c[4], alpha = c[5];
  const long double d1 = std::sqrt(x * x + y * y + z * z);
  const long double d2 = std::sqrt(x * x + y * y + (xi * d1 + z) * (xi * d1 + z));
  const long double w = alpha * d2 + (1 - alpha) * (xi * d1 + z);
  return vec2(double(c[0] * x / w + c[2]), double(c[1] * y / w + c[3]));
}

TEST(DoubleSphere, AgreesWithItsFormula) {
  for (const auto& [xi, alpha] : {std::pair(-0.18, 0.59), {0., 0.5}, {0.3, 0.2}, {0., 0.}, {-0.4, 0.8}}) {
    const std::vector<double> c{300, 310, 320, 240, xi, alpha};
    const CameraResult lens = cameraOf(c);
    for (const vec3& p : {vec3(0.1, -0.2, 1.), vec3(-1.1, -0.9, 1.2), vec3(0., 0., 1.), vec3(1e-9, 0., 2.),
                          vec3(1., 0.5, 0.4)})
      EXPECT_LT((lens.project(p) - pixelByFormula(c, p)).norm(), 1e-10)
          << xi << " " << alpha << " " << p.transpose();
  }
}

TEST(DoubleSphere, IsAPinholeWithoutSphereAndShift) {
  const vec2 pixel = cameraOf({500, 510, 320, 240, 0, 0}).project(vec3(0.3, -0.2, 1.5));
  EXPECT_LT((pixel - vec2(500 * 0.2 + 320, -510 * 0.2 / 1.5 + 240)).norm(), 1e-10);
}

TEST(DoubleSphere, SeesBeyondItsSideAndNothingOutOfItsDomain) {
  // z > -w2 |p| with w1 = (1 - 0.59) / 0.59: 126 degrees off the axis.
  const double w1 = 0.41 / 0.59, w2 = (w1 - 0.18) / std::sqrt(-2 * w1 * 0.18 + 0.18 * 0.18 + 1);
  const CameraResult lens = cameraOf(fisheye_lens);
  for (const double angle : {std::acos(-w2) - 1e-3, 1.7, 1.0})
    EXPECT_TRUE(lens.project(vec3(std::sin(angle), 0., std::cos(angle))).allFinite()) << angle;
  for (const double angle : {std::acos(-w2) + 1e-3, 2.5, M_PI})
    EXPECT_FALSE(lens.project(vec3(std::sin(angle), 0., std::cos(angle))).allFinite()) << angle;
}

TEST(DoubleSphere, ARayIsSeenAtItsPixel) {
  const CameraResult lens = cameraOf(fisheye_lens);
  for (double u = 0; u <= 640; u += 80) {
    for (double v = 0; v <= 480; v += 80) {
      const auto ray = lens.ray(vec2(u, v));
      ASSERT_TRUE(ray) << u << ", " << v;
      EXPECT_LT((lens.project(*ray) - vec2(u, v)).norm(), 1e-6);
    }
  }
}

Result calibrated(const std::vector<double>& truth, const testing::Scene& scene, unsigned seed,
                  const std::vector<LensConstraint>& constraints = {}) {
  Settings settings;
  settings.model = Model("double_sphere");
  settings.sigma_px = std::max(scene.sigma_px, 0.01);
  settings.lens = constraints;
  return calibrate(testing::simulated(lensOf(cameraOf(truth)), scene, seed), settings);
}

const std::vector<std::vector<double>> lenses{fisheye_lens,
                                              {420, 425, 322, 243, 0.1, 0.35},
                                              {300, 302, 322, 243, 0.2, 0.55},
                                              {300, 302, 322, 243, -0.3, 0.7}};

/// Lenses with xi < 0 and with xi > 0 bend alike to a few thousandths of a pixel. The truth is still distinguished from
/// its double.
TEST(DoubleSphere, FindsTheTruthWithoutNoise) {
  testing::Scene scene;
  scene.nearest = 0.12;
  scene.images = 20;
  scene.sigma_px = 0;
  for (const std::vector<double>& truth : lenses) {
    for (unsigned seed = 0; seed < 2; ++seed) {
      const Result result = calibrated(truth, scene, seed);
      ASSERT_TRUE(result.success()) << result.message << result.undetermined << " seed " << seed;
      for (std::size_t i = 0; i < truth.size(); ++i) {
        const Parameter& p = result.cameras[0].parameters.at(i);
        EXPECT_NEAR(p.value, truth[i], 1e-4 * p.std + 1e-7)
            << p.name << " of " << truth[0] << " seed " << seed;
      }
    }
  }
}

/// With xi known there is one minimum: parameters within 4.5 standard deviations.
TEST(DoubleSphere, FindsTheTruthWithNoiseWhereXiIsKnown) {
  testing::Scene scene;
  scene.nearest = 0.12;
  for (const std::vector<double>& truth : lenses) {
    for (unsigned seed = 0; seed < 3; ++seed) {
      const Result result = calibrated(truth, scene, seed, {{"", "xi", truth[4], truth[4]}});
      ASSERT_TRUE(result.success()) << result.message << result.undetermined << " seed " << seed;
      EXPECT_NEAR(result.chi2PerDof(), 1, 0.2);
      for (std::size_t i = 0; i < truth.size(); ++i) {
        const Parameter& p = result.cameras[0].parameters.at(i);
        EXPECT_NEAR(p.value, truth[i], 4.5 * p.std) << p.name << " of " << truth[0] << " seed " << seed;
      }
    }
  }
}

/// At xi = 0, changing xi has the effect of changing focal lengths and alpha, so they cannot be distinguished.
TEST(DoubleSphere, SaysWhereXiIsOpen) {
  testing::Scene scene;
  scene.nearest = 0.12;
  scene.images = 20;
  for (unsigned seed = 0; seed < 3; ++seed) {
    const Result result = calibrated({420, 425, 322, 243, 0, 0.4}, scene, seed);
    const Parameter& xi = result.cameras[0].parameters.at(4);
    if (!result.undetermined.empty()) continue;
    EXPECT_LT(std::abs(xi.value), 4 * xi.std) << "seed " << seed;
    EXPECT_GT(xi.std, 0.03) << "seed " << seed;  // xi lies between -1 and 1
  }
}

/// With noise, either of the two may fit better. The images of points are determined.
TEST(DoubleSphere, SeesAsTheTruthDoesWithNoise) {
  testing::Scene scene;
  scene.nearest = 0.12;
  scene.images = 20;
  for (const std::vector<double>& truth : lenses) {
    if (truth[4] == 0.1) continue;  // xi is too near to 0 to be distinguished from it
    for (unsigned seed = 0; seed < 3; ++seed) {
      const Result result = calibrated(truth, scene, seed);
      ASSERT_TRUE(result.success()) << result.message << result.undetermined << " seed " << seed;
      EXPECT_NEAR(result.chi2PerDof(), 1, 0.2);
      const CameraResult &found = result.cameras[0], lens = cameraOf(truth);
      const vec2 centre = found.project(vec3(0., 0., 1.)), true_centre = lens.project(vec3(0., 0., 1.));
      for (const double angle : {0.2, 0.4, 0.6}) {
        const vec3 ray(std::sin(angle), 0., std::cos(angle));
        EXPECT_NEAR(found.project(ray).x() - centre.x(), lens.project(ray).x() - true_centre.x(), 0.3)
            << angle << " of " << truth[0] << " seed " << seed;
      }
    }
  }
}

struct Command : ::testing::Test {
  Command() {
    testing::Scene scene;
    scene.nearest = 0.12;
    slom::testing::writeFile(
        folder / "cam.csv",
        "# image_size_px: 640 x 480\n" +
            testing::cornerFile(testing::simulated(lensOf(cameraOf(fisheye_lens)), scene, 1).cameras[0]));
  }
  testing::CommandResult run(std::vector<std::string> options) const {
    options.insert(options.begin(),
                   {"--camera", "cam=" + (folder / "cam.csv").string(), "--sigma-px", "0.2"});
    return testing::runCalibrate(options);
  }
  std::string file(const std::string& name) const { return (folder / name).string(); }

  testing::TemporaryFolder folder;
};
using DoubleSphereCommand = Command;

TEST_F(DoubleSphereCommand, WritesJsonAndKalibrsCamchain) {
  const auto result = run({"--intrinsics", "double_sphere", "--json", file("r.json"), "--output",
                           file("camchain.yaml"), "--quiet"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const json stored = json::parse(readFile(file("r.json")));
  const json& camera = stored["cameras"]["cam"];
  EXPECT_EQ(camera["model"], "double_sphere");
  EXPECT_EQ(stored["quality"]["verdict"]["level"], "trustworthy") << stored["quality"]["verdict"];
  const std::string yaml = readFile(file("camchain.yaml"));
  EXPECT_NE(yaml.find("camera_model: ds\n"), std::string::npos) << yaml;
  EXPECT_NE(yaml.find("distortion_model: none\n"), std::string::npos) << yaml;
  EXPECT_NE(
      yaml.find(fmt::format("intrinsics: [{}, {}, {}, ", camera["parameters"]["xi"]["value"].get<double>(),
                            camera["parameters"]["alpha"]["value"].get<double>(),
                            camera["parameters"]["fx"]["value"].get<double>())),
      std::string::npos)
      << yaml;
}

TEST_F(DoubleSphereCommand, RefusesFilesOfProgramsThatHaveNoSuchLens) {
  const std::string remedy =
      " has no lens like double_sphere; calibrate with --intrinsics opencv4 or opencv5 or opencv8 or fisheye or radial1, or "
      "write Kalibr's camchain by --format kalibr\n";
  EXPECT_EQ(run({"--intrinsics", "double_sphere", "--output", "r.yaml"}).errors,
            "slom: --output r.yaml: OpenCV" + remedy);
  EXPECT_EQ(run({"--intrinsics", "double_sphere", "--output", "{name}.yaml"}).errors,
            "slom: --output {name}.yaml: ROS" + remedy);
}

TEST_F(DoubleSphereCommand, IsComparedWhereItIsNamed) {
  const auto result = run({"--compare", "opencv4,double_sphere", "--json", file("r.json"), "--quiet"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(json::parse(readFile(file("r.json")))["comparison"]["chosen"], "double_sphere");
  for (const Model& model : comparedModels()) EXPECT_NE(model.name(), "double_sphere");
}

TEST_F(DoubleSphereCommand, HoldsAndBoundsItsParameters) {
  const auto result = run({"--intrinsics", "double_sphere", "--fix", "xi=-0.18", "--bound", "alpha=0,1",
                           "--json", file("r.json"), "--quiet"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const json parameters = json::parse(readFile(file("r.json")))["cameras"]["cam"]["parameters"];
  EXPECT_EQ(parameters["xi"]["value"], -0.18);
  EXPECT_EQ(parameters["xi"]["std"], 0);
  EXPECT_NEAR(parameters["alpha"]["value"], 0.59, 4.5 * parameters["alpha"]["std"].get<double>());
}

}  // namespace
}  // namespace slom::app::calib
