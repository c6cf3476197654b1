// Calibrates from arrays in memory: simulates a lens, and estimates it.
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include <slom/calibration.hpp>

namespace {

using namespace slom::calibration;

void require(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(what);
}

/// Five images of a board of 8 x 6 corners by a pinhole with f = 500 px.
CameraData simulated() {
  CameraData camera;
  camera.name = "cam";
  camera.image_size = ImageSize{640, 480};
  for (int image = 0; image < 5; ++image) {
    const SE3 world2camera(SO3::exp(vec3(0.4 * std::sin(image), 0.4 * std::cos(2 * image), 0.1 * image)),
                           vec3(-0.1, -0.1, 0.5 + 0.02 * image));
    View view;
    view.image = image;
    for (int i = 0; i < 48; ++i) {
      const vec3 corner(0.03 * (i % 8), 0.03 * (i / 8), 0.), p = world2camera * corner;
      view.corners.push_back({i, corner, vec2(500 * p.x() / p.z() + 320, 500 * p.y() / p.z() + 240)});
    }
    camera.views.push_back(view);
  }
  return camera;
}

}  // namespace

int main() try {
  Dataset data;
  data.cameras.push_back(simulated());
  Settings settings;
  settings.model = Model("opencv4");
  Result result = calibrate(data, settings);
  require(result.success(), "the calibration failed");
  const CameraResult& camera = result.cameras.front();
  require(std::abs(camera.parameters[0].value - 500) < 1e-4, "another focal length");
  require(std::abs(camera.project(vec3(0.1, 0., 1.)).x() - 370) < 1e-4, "another pixel");
  const std::optional<vec3> ray = camera.ray(vec2(370, 240));
  require(ray && std::abs(ray->x() / ray->z() - 0.1) < 1e-6, "another ray");
  result.quality = assess(data, settings, result);
  require(result.quality->hasProjection() && result.quality->correlations.size() == 8, "no assessment");
  std::printf("%s\n", verdictOf(result).sentence.c_str());
  data.cameras[0].views.resize(1);
  try {
    calibrate(data, settings);
    require(false, "one image was accepted");
  } catch (const mtk::Error& error) {
    require(error.id() == "slom.calibration.too-few-views", error.what());
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
