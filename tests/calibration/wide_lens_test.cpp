// Lenses of 170 and 190 degrees: no good corner is left out, the focal length holds within its standard deviation, and
// a pinhole model is named as wrong.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <slom/calibration.hpp>

#include "calibration/models/fisheye.hpp"

namespace slom::calibration {
namespace {

constexpr int width = 1280, height = 960;
constexpr double radians = std::numbers::pi / 180;

/// A lens that sees `half_angle` to the sides of the image, all around.
CameraResult wideLens(const std::string& model, double half_angle) {
  CameraResult camera;
  camera.model = model;
  const double f = width / 2 / half_angle;
  const std::vector<double> values =
      model == "fisheye" ? std::vector<double>{f, f * 1.004, 634, 487, 0.02, -0.006, 0.001, -0.0003}
                         : std::vector<double>{0.93 * f, 0.934 * f, 634, 487, -0.15, 0.6};
  const std::vector<std::string>& names = Model(model).parameters();
  for (std::size_t i = 0; i < names.size(); ++i) camera.parameters.push_back({names[i], values[i], 1});
  return camera;
}

/// Boards all around the lens, at up to `half_angle` from its axis, that face it with tilts of up to 35 degrees.
Dataset boardsAround(const CameraResult& lens, double half_angle, unsigned seed) {
  constexpr int columns = 9, rows = 7, images = 24;
  constexpr double square_m = 0.03, sigma_px = 0.2;
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random);
  };
  std::normal_distribution<> normal;
  CameraData camera;
  camera.name = "cam", camera.file = "cam.csv";
  camera.image_size = ImageSize{width, height};
  for (int image = 1; image <= images; ++image) {
    const double away = half_angle * std::sqrt(uniform(0, 1)), around = uniform(0, 2 * std::numbers::pi);
    const SO3 aim = SO3::exp(vec3(-std::sin(around) * away, std::cos(around) * away, 0.));
    const SO3 tilt = SO3::exp(vec3(uniform(-0.6, 0.6), uniform(-0.6, 0.6), uniform(-1, 1)));
    const vec3 centre(aim * vec3(0., 0., uniform(0.25, 0.4)));
    const vec3 middle(square_m * (columns - 1) / 2, square_m * (rows - 1) / 2, 0.);
    View view;
    view.image = image;
    for (int k = 0; k < columns * rows; ++k) {
      const vec3 world(square_m * (k % columns), square_m * (k / columns), 0.);
      const vec3 point(aim * (tilt * vec3(world - middle)) + centre);
      if (std::atan2(std::hypot(point.x(), point.y()), point.z()) > half_angle) continue;
      const vec2 pixel(lens.project(point) + sigma_px * vec2(normal(random), normal(random)));
      if (pixel.x() > 0 && pixel.y() > 0 && pixel.x() < width && pixel.y() < height)
        view.corners.push_back({k + 1, world, pixel});
    }
    if (view.corners.size() >= 12) camera.views.push_back(view);
  }
  return Dataset{{camera}, {}};
}

Settings of(const std::string& model) {
  Settings settings;
  settings.model = Model(model);
  settings.sigma_px = 0.2;
  return settings;
}

TEST(WideLens, KeepsAllGoodCornersAndItsFocalLength) {
  for (const double degrees : {170., 190.}) {
    for (const std::string model : {"fisheye", "double_sphere"}) {
      const CameraResult truth = wideLens(model, degrees / 2 * radians);
      for (unsigned seed = 1; seed <= 8; ++seed) {
        const std::string which =
            model + ", " + std::to_string(int(degrees)) + " degrees, seed " + std::to_string(seed);
        const Result result = calibrate(boardsAround(truth, degrees / 2 * radians, seed), of(model));
        ASSERT_TRUE(result.success()) << which << " " << result.message;
        EXPECT_TRUE(result.rejected.empty() && result.strays.empty())
            << which << " " << result.rejected.size();
        EXPECT_LT(result.cameras[0].rms_px, 0.2 * std::sqrt(2.) * 1.05) << which;
        const Parameter& fx = result.cameras[0].parameters[0];
        if (model == "fisheye") {  // a double sphere has a twin
          EXPECT_LT(std::abs(fx.value - truth.parameters[0].value), 4 * fx.std) << which;
        }
        for (const double angle : {0.3, 0.9, degrees / 2 * radians - 0.05}) {
          const vec3 p(std::sin(angle) * 0.8, std::sin(angle) * 0.6, std::cos(angle));
          EXPECT_LT((result.cameras[0].project(p) - truth.project(p)).norm(), 1) << which << " " << angle;
        }
      }
    }
  }
}

TEST(WideLens, OfAPinholeModelTheFisheyeIsNamed) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const CameraResult truth = wideLens("fisheye", 85 * radians);
    const Result result = calibrate(boardsAround(truth, 85 * radians, seed), of("opencv5"));
    ASSERT_TRUE(result.better_model) << seed << " " << result.message;
    EXPECT_EQ(result.better_model->name, "fisheye") << seed;
    EXPECT_LT(result.better_model->rms_px, 0.3) << seed;
  }
}

}  // namespace
}  // namespace slom::calibration
