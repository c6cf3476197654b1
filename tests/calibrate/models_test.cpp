// The camera models, calibrations of data from one of them, and the choice of --compare.
#include <functional>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <slom/slom.hpp>

#include "calibrate/calibrate_command.hpp"
#include "calibrate/library.hpp"
#include "calibrate/output/notes.hpp"
#include "calibration/fit/measurements.hpp"
#include "calibration/models/fisheye.hpp"
#include "calibration/models/opencv.hpp"
#include "calibration/procedure/judge.hpp"
#include "calibration/simulated_views.hpp"
#include "support/paths.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace slom::app::calib {
namespace {

using nlohmann::json;
using testing::Scene;
using testing::simulated;

const std::vector<vec3> points{{0.1, -0.2, 1.},   {-0.5, 0.3, 0.8}, {0.02, 0.01, 2.},  {0.7, 0.6, 1.},
                               {-1.1, -0.9, 1.2}, {0., 0., 1.},     {1e-9, -1e-9, 1.}, {0., 0.4, 0.5}};

/// Written down once more, from OpenCV's documentation: g divided, tangential part, focal lengths.
vec2 rationalPixel(const Eigen::VectorXd& c, const vec3& p) {
  const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = std::pow(std::hypot(x, y), 2), r4 = r2 * r2,
               r6 = r4 * r2;
  const double g = (1 + c[4] * r2 + c[5] * r4 + c[8] * r6) / (1 + c[9] * r2 + c[10] * r4 + c[11] * r6);
  return vec2(c[0] * (x * g + 2 * c[6] * x * y + c[7] * (r2 + 2 * x * x)) + c[2],
              c[1] * (y * g + c[6] * (r2 + 2 * y * y) + 2 * c[7] * x * y) + c[3]);
}

Eigen::VectorXd numbers(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), Eigen::Index(values.size()));
}

/// Derivatives by hand and by dual numbers, by all parameters and the point, against central differences.
template <template <class> class Camera>
void checkDerivatives(const Camera<double>& camera, const std::vector<vec3>& at) {
  constexpr int n = Camera<double>::DOF;
  using S = mtk::Dual<double, n + 3>;
  for (const vec3& point : at) {
    Camera<S> lens;
    mtk::vect<3, S> p;
    for (int i = 0; i < n; ++i) lens[i].seed(camera[i], i);
    for (int i = 0; i < 3; ++i) p[i].seed(point[i], n + i);
    const mtk::vect<2, S> pixel = lens.project(p);
    const LensDerivatives<n> by_hand = differentiate(camera, point);
    EXPECT_LT((by_hand.pixel - camera.project(point)).norm(), 1e-12 * by_hand.pixel.norm());
    for (int i = 0; i < n + 3; ++i) {
      const auto moved = [&](double step) {
        Camera<double> c = camera;
        vec3 q = point;
        (i < n ? c[i] : q[i - n]) += step;
        return vec2(c.project(q));
      };
      const double step = 1e-6 * std::max(1.0, i < n ? std::abs(camera[i]) : 0.0);
      const vec2 difference((moved(step) - moved(-step)) / (2 * step));
      for (int row = 0; row < 2; ++row) {
        EXPECT_NEAR(pixel[row].partial(i), difference[row], 1e-5 * (1 + difference.norm()))
            << "parameter " << i << " at " << point.transpose();
        const double written = i < n ? by_hand.by_parameters(row, i) : by_hand.by_point(row, i - n);
        EXPECT_NEAR(written, pixel[row].partial(i), 1e-11 * (1 + std::abs(difference.norm())))
            << "by hand, parameter " << i << " at " << point.transpose();
      }
    }
  }
}

const Opencv8<> rational{500., 510., 320., 240., 0.3, -0.1, 0.001, -0.002, 0.02, 0.5, -0.05, 0.01};

TEST(CameraModels, AgreeWithTheirFormulas) {
  for (const vec3& p : points) {
    EXPECT_LT((vec2(rational.project(p)) - rationalPixel(rational, p)).norm(), 1e-10);
    const Opencv5<> five{500., 510., 320., 240., 0.3, -0.1, 0.001, -0.002, 0.02};
    EXPECT_LT((vec2(five.project(p)) -
               rationalPixel(numbers({500, 510, 320, 240, 0.3, -0.1, 0.001, -0.002, 0.02, 0, 0, 0}), p))
                  .norm(),
              1e-10);
    const Opencv4<> four{500., 510., 320., 240., 0.3, -0.1, 0.001, -0.002};
    EXPECT_LT((vec2(four.project(p)) -
               rationalPixel(numbers({500, 510, 320, 240, 0.3, -0.1, 0.001, -0.002, 0, 0, 0, 0}), p))
                  .norm(),
              1e-10);
    const Radial1<> one{500., 320., 240., -0.2};
    EXPECT_LT(
        (vec2(one.project(p)) - rationalPixel(numbers({500, 500, 320, 240, -0.2, 0, 0, 0, 0, 0, 0, 0}), p))
            .norm(),
        1e-10);
  }
}

TEST(CameraModels, HaveExactDerivatives) {
  checkDerivatives(rational, points);
  checkDerivatives(Opencv5<>{500., 510., 320., 240., 0.3, -0.1, 0.001, -0.002, 0.02}, points);
  checkDerivatives(Opencv4<>{500., 510., 320., 240., 0.3, -0.1, 0.001, -0.002}, points);
  checkDerivatives(Radial1<>{500., 320., 240., -0.2}, points);
  std::vector<vec3> sideways = points;
  sideways.insert(sideways.end(), {vec3(1., 0.5, 0.1), vec3(-0.4, 1., -0.2)});
  checkDerivatives(Fisheye<>{300., 310., 320., 240., 0.05, -0.01, 3e-3, -4e-4}, sideways);
}

/// Views as measurements, with a camera and poses that are estimated or known.
TEST(CameraModels, DifferentiateViews) {
  View view;
  for (const vec3& p : points)
    view.corners.push_back({1, vec3(0.1 * p.x(), 0.1 * p.y(), 0.), vec2(3., 5.), 0});
  const SE3 left2world(SO3::exp(vec3(0.3, -0.2, 0.1)) * SO3::exp(vec3(M_PI, 0., 0.)), vec3(0.05, -0.02, 1.));
  const SE3 left2camera(SO3::exp(vec3(-0.05, 0.1, 0.02)), vec3(-0.1, 0.01, 0.03));
  Estimator est;
  const Lens lens(Model("opencv8"), {rational.begin(), rational.end()});
  const auto camera = est.insertRV(lens, true, "camera");
  const auto pose = est.insertRV(left2world, true, "left2world");
  const auto other = est.insertRV(left2camera, true, "left2camera");
  est.insertMeasurement(ViewOfLeft(view), camera, pose, named("left"));
  est.insertMeasurement(ViewOfLeft(view), lens, pose, named("left, known camera"));
  est.insertMeasurement(ViewOfOther(view), camera, other, pose, named("other"));
  est.insertMeasurement(ViewOfOther(view, 1, 2), lens, left2camera, pose, named("other, known camera"));
  const DerivativeCheck check = slom::checkDerivatives(est);
  EXPECT_TRUE(check.ok()) << check;
  EXPECT_EQ(check.groups.size(), 4u);
}

TEST(CameraModels, SeeNothingBehindThem) {
  EXPECT_FALSE(std::isfinite(rational.project(vec3(0.1, 0.1, -1.))[0]));
  EXPECT_FALSE(std::isfinite(Radial1<>(500., 320., 240., -0.2).project(vec3(0.1, 0.1, 0.))[0]));
}

template <class Camera>
void expectTruth(const Camera& truth, const Model& model, const Scene& scene, unsigned seed) {
  Settings settings;
  settings.model = model;
  settings.sigma_px = std::max(scene.sigma_px, 0.01);
  const Result result = calibrate(simulated(truth, scene, seed), settings);
  ASSERT_TRUE(result.success()) << result.message << result.undetermined;
  const auto& parameters = result.cameras[0].parameters;
  ASSERT_EQ(parameters.size(), std::size_t(Camera::DOF));
  for (int i = 0; i < Camera::DOF; ++i) {
    const Parameter& p = parameters[std::size_t(i)];
    EXPECT_NEAR(p.value, truth[i], scene.sigma_px > 0 ? 4.5 * p.std : 1e-4 * p.std + 1e-7)
        << p.name << " seed " << seed;
  }
  if (scene.sigma_px > 0) {
    EXPECT_NEAR(result.chi2PerDof(), 1, 0.2);
  }
}

const Fisheye<> fisheye{230., 232., 322., 243., 0.03, -0.012, 0.004, -0.0008};

TEST(Fisheye, FindsItsTruth) {
  Scene scene;
  scene.nearest = 0.12;
  for (unsigned seed = 0; seed < 5; ++seed) expectTruth(fisheye, Model("fisheye"), scene, seed);
  scene.sigma_px = 0;
  for (unsigned seed = 0; seed < 3; ++seed) expectTruth(fisheye, Model("fisheye"), scene, seed);
}

TEST(Fisheye, FindsItsTruthOnARig) {
  // The second camera sees the same boards from 5 cm aside.
  Scene scene;
  scene.nearest = 0.15;
  Dataset data = simulated(fisheye, scene, 1);
  Settings settings;
  settings.model = Model("fisheye");
  CameraData other = data.cameras[0];
  other.name = "right";
  data.cameras.push_back(other);
  const Result result = calibrate(data, settings);
  ASSERT_TRUE(result.success()) << result.message;
  EXPECT_LT(result.cameras[1].left2camera.pos.norm(), 1e-6);
}

TEST(Opencv8, FindsItsTruth) {
  // k1 and k4, and the others of numerator and denominator, nearly do the same: what is determined is where
  // points are seen.
  const Opencv8<> truth{400., 402., 322., 243., 0.4, -0.1, 0.001, -0.002, 0.02, 0.6, -0.05, 0.01};
  Scene scene;
  scene.images = 20;
  scene.sigma_px = 0;
  Settings settings;
  settings.model = Model("opencv8");
  settings.sigma_px = 0.2;
  const Result result = calibrate(simulated(truth, scene, 1), settings);
  ASSERT_TRUE(result.success()) << result.message << result.undetermined;
  EXPECT_LT(result.cameras[0].rms_px, 1e-4);
  ASSERT_EQ(result.cameras[0].parameters.size(), 12u);
  Opencv8<> found;
  for (int i = 0; i < 12; ++i) found[i] = result.cameras[0].parameters[std::size_t(i)].value;
  for (const double x : {-0.6, -0.3, 0., 0.3, 0.6}) {
    for (const double y : {-0.4, 0., 0.4})
      EXPECT_LT((found.project(vec3(x, y, 1.)) - truth.project(vec3(x, y, 1.))).norm(), 1e-3);
  }
}

/// OpenCV's sample images: numerator and denominator nearly do the same on them.
TEST(Opencv8, IsHeldNearZeroWhereTheImagesLeaveItOpen) {
  const auto folder = slom::testing::sourcePath("data/opencv_stereo");
  Dataset data;
  for (const std::string name : {"left", "right"})
    data.cameras.push_back(readCorners(name, (folder / (name + "_corners.csv")).string()));
  Settings settings;
  const Result simpler = calibrate(data, settings);
  settings.model = Model("opencv8");
  const Result result = calibrate(data, settings);
  ASSERT_TRUE(result.success()) << result.message << result.undetermined;
  EXPECT_EQ(result.sigma_denominator, 1);
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_NEAR(result.cameras[c].rms_px, simpler.cameras[c].rms_px, 1e-3);
    for (const std::size_t k : {9, 10, 11}) {
      EXPECT_LT(std::abs(result.cameras[c].parameters[k].value), 1);
      EXPECT_LT(result.cameras[c].parameters[k].std, 1);
    }
    // What the lenses have in common is as sure as with the simpler model.
    for (const std::size_t k : {0, 1, 2, 3})
      EXPECT_NEAR(result.cameras[c].parameters[k].std / simpler.cameras[c].parameters[k].std, 1, 0.1);
  }
  EXPECT_EQ(
      notes(result).front(),
      "The images do not determine k4, k5, k6, because numerator and denominator of opencv8 have the same "
      "effect there. These were held at 0 +- 1 each; the standard deviations hold if they stay there. A "
      "model with fewer parameters does as well: --intrinsics opencv5, or --compare.");
  const Comparison comparison = compareModels(data, settings, {Model("opencv5"), Model("opencv8")});
  for (const ModelTrial& trial : comparison.trials) EXPECT_EQ(trial.failure, "");
}

Comparison compared(const Dataset& data) {
  Settings settings;
  settings.sigma_px = 0.2;
  return compareModels(
      data, settings,
      {Model("radial1"), Model("opencv4"), Model("opencv5"), Model("opencv8"), Model("fisheye")});
}

TEST(Comparison, ChoosesTheModelThatMadeTheData) {
  int too_large = 0;
  for (unsigned seed = 0; seed < (slom::testing::hasSanitizers() ? 1 : 5); ++seed) {
    const Dataset data =
        simulated(Opencv4<>{420., 425., 322., 243., -0.28, 0.09, 0.001, -0.0015}, Scene{}, seed);
    const Comparison comparison = compared(data);
    ASSERT_TRUE(comparison.chosen);
    EXPECT_EQ(comparison.chosenTrial().model, Model("opencv4")) << seed;
    EXPECT_GT(comparison.standard_errors[0], 3) << "radial1 is not distinguished";
    too_large += comparison.standard_errors[1] > 2;
    // Prediction of corners with sigma 0.2 px by poses from half of them.
    EXPECT_NEAR(comparison.chosenTrial().heldOutRms(), 0.2 * std::sqrt(2), 0.03);
  }
  EXPECT_EQ(too_large, 0);
}

TEST(Comparison, ChoosesAFisheyeForOne) {
  Scene scene;
  scene.nearest = 0.12;
  for (unsigned seed = 0; seed < (slom::testing::hasSanitizers() ? 1 : 3); ++seed) {
    const Comparison comparison = compared(simulated(fisheye, scene, seed));
    ASSERT_TRUE(comparison.chosen);
    EXPECT_EQ(comparison.chosenTrial().model, Model("fisheye")) << seed;
  }
}

TEST(Comparison, ChoosesTheSimplestThatIsNotClearlyWorse) {
  const auto trial = [](const Model& model, int unknowns, const std::vector<double>& squares) {
    ModelTrial t{model};
    t.unknowns = unknowns;
    t.held_out_squares = squares;
    return t;
  };
  Comparison comparison;
  comparison.trials = {trial(Model("radial1"), 10, {4, 5, 6, 5}),
                       trial(Model("opencv4"), 14, {0.9, 2, 3.4, 1.8}),
                       trial(Model("opencv5"), 15, {1, 2, 3, 2}), trial(Model("opencv8"), 18, {})};
  comparison.trials[3].failure = "did not converge";
  judge(comparison);
  EXPECT_EQ(comparison.best, 2u);
  EXPECT_EQ(comparison.chosen, 1u);
  EXPECT_EQ(comparison.standard_errors[2], 0);
  // Logarithms of the ratios 0.9, 1, 3.4 / 3, 0.9: their mean over their standard deviation, by the square
  // root of 4.
  EXPECT_NEAR(comparison.standard_errors[1], -0.390314, 1e-6);
  EXPECT_TRUE(std::isnan(comparison.standard_errors[3]));
}

TEST(Comparison, IsPrintedAndStored) {
  const slom::testing::TemporaryFolder folder;
  slom::testing::writeFile(
      folder / "cam.csv",
      testing::cornerFile(
          simulated(Opencv4<>{420., 425., 322., 243., -0.28, 0.09, 0.001, -0.0015}, Scene{}, 1).cameras[0]));
  const std::string camera = "cam=" + (folder / "cam.csv").string(),
                    json_file = (folder / "result.json").string();
  auto result =
      testing::runCalibrate({"--camera", camera, "--sigma-px", "0.2", "--compare", "--json", json_file});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("\nmodels compared\n  model     parameters  unknowns          RSS   RSS/dof   "
                               " RMS px  predicted px  behind best [se]\n"),
            std::string::npos)
      << result.output;
  EXPECT_NE(result.output.find("  * The data support opencv4: "), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("\neach camera alone, model opencv4\n"), std::string::npos);
  const json stored = json::parse(slom::testing::readFile(folder / "result.json"));
  EXPECT_EQ(stored["comparison"]["chosen"], "opencv4");
  EXPECT_EQ(stored["comparison"]["models"].size(), 5u);
  EXPECT_EQ(stored["cameras"]["cam"]["model"], "opencv4");

  result = testing::runCalibrate({"--camera", camera, "--compare", "radial1,opencv4", "--intrinsics",
                                  "opencv5", "--json", json_file, "--quiet"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const json other = json::parse(slom::testing::readFile(folder / "result.json"));
  EXPECT_EQ(other["comparison"]["models"].size(), 2u);
  EXPECT_EQ(other["cameras"]["cam"]["model"], "opencv5");

  result = testing::runCalibrate({"--camera", camera, "--compare", "opencv4,pinhole"});
  EXPECT_EQ(
      result.errors,
      "slom: --compare pinhole: the models are opencv4, opencv5, opencv8, fisheye, radial1 and double_sphere\n");
}

}  // namespace
}  // namespace slom::app::calib
