// Views of a board through a lens of any model, and the expected result of a calibration from them.
#pragma once

#include <random>

#include <slom/calibration.hpp>

namespace slom::calibration::testing {

struct Scene {
  int images = 12, columns = 10, rows = 7;
  double square_m = 0.04, sigma_px = 0.2, nearest = 0.25;
  double width = 640, height = 480;
};

/// Views of a board that fill the image of a lens, corners outside of it missing.
template <class Camera>
Dataset simulated(const Camera& lens, const Scene& scene, unsigned seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random);
  };
  std::normal_distribution<> normal;
  CameraData camera;
  camera.name = "cam";
  camera.file = "cam.csv";
  camera.image_size = ImageSize{int(scene.width), int(scene.height)};
  int line = 1;
  for (int image = 1; image <= scene.images; ++image) {
    const SO3 orient = SO3::exp(vec3(uniform(-0.6, 0.6), uniform(-0.6, 0.6), uniform(-0.5, 0.5)));
    const double distance = scene.nearest * uniform(1, 1.8);
    const vec3 centre(distance * uniform(-0.5, 0.5), distance * uniform(-0.4, 0.4), distance);
    const vec3 middle(scene.square_m * (scene.columns - 1) / 2, scene.square_m * (scene.rows - 1) / 2, 0.);
    View view;
    view.image = image;
    for (int k = 0; k < scene.columns * scene.rows; ++k) {
      const vec3 world(scene.square_m * (k % scene.columns), scene.square_m * (k / scene.columns), 0.);
      const vec3 point(orient * vec3(world - middle) + centre);
      const vec2 pixel(vec2(lens.project(point)) + scene.sigma_px * vec2(normal(random), normal(random)));
      const bool inside =
          pixel.x() > 0 && pixel.y() > 0 && pixel.x() < scene.width && pixel.y() < scene.height;
      if (point.z() > 0.02 && inside) view.corners.push_back({k + 1, world, pixel, ++line});
    }
    if (view.corners.size() >= 12) camera.views.push_back(view);
  }
  Dataset data;
  data.cameras.push_back(camera);
  return data;
}

}  // namespace slom::calibration::testing
