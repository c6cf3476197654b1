// A bundle adjustment for tests.
#pragma once

#include <cmath>
#include <random>
#include <string>

#include <slom/io/bal.hpp>

namespace slom::testing {

/// Returns a scene in BAL's format: cameras on a path, and points before them.
inline std::string bundleText() {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  io::Scene scene;
  for (int i = 0; i < 12; ++i) {
    io::Camera camera;
    camera.pose = {
        mtk::SO3<>::exp(mtk::vect<3>(0.02 * normal(random), 0.02 * normal(random), 0.05 * normal(random))),
        mtk::vect<3>(-0.5 * i, 0.1 * normal(random), 0.1 * normal(random))};
    camera.lens = SnavelyIntrinsics<>(mtk::vect<3>(500, 0, 0));
    scene.cameras.push_back(camera);
  }
  for (int k = 0; k < 300; ++k) {
    const mtk::vect<3> point(5.5 * k / 300, 2 * normal(random), -8 - std::abs(normal(random)));
    scene.points.push_back(point);
    for (int i = 0; i < 12; ++i) {
      if (std::abs(0.5 * i - point[0]) > 1.8) continue;
      io::Observation observation;
      observation.camera = i;
      observation.point = k;
      const mtk::vect<2> seen = io::CameraProjection()(scene.cameras[std::size_t(i)], point);
      observation.pixel = mtk::vect<2>(seen[0] + 0.5 * normal(random), seen[1] + 0.5 * normal(random));
      scene.observations.push_back(observation);
    }
  }
  for (auto& point : scene.points) {
    for (int c = 0; c < 3; ++c) point[c] += 0.05 * normal(random);
  }
  return io::toBal(scene);
}

}  // namespace slom::testing
