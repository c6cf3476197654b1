// A rig of two cameras and an IMU in the memory of a program, without files and lines.
#pragma once

#include <cmath>
#include <limits>
#include <string>

#include <slom/calibration.hpp>

namespace slom::calibration::testing {

inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// Returns images, usually six, of a board of 7 x 5 corners by two pinholes with f = 500 px, 0.1 m apart, and an IMU reading for
/// each. Noise of about 0.1 px and 0.01 m/s^2 is the same in each run.
inline Dataset rigInMemory(int images = 6) {
  double phase = 0;
  const auto noise = [&](double size) { return size * std::sin(phase += 1.7); };
  Dataset data;
  for (const char* name : {"left", "right"}) {
    CameraData camera;
    camera.name = name;
    camera.image_size = ImageSize{640, 480};
    data.cameras.push_back(camera);
  }
  data.imu.emplace();
  for (int image = 0; image < images; ++image) {
    const SE3 world2left(SO3::exp(vec3(0.4 * std::sin(image), 0.4 * std::cos(2 * image), 0.1 * image)) *
                             SO3::exp(vec3(3.14159265, 0., 0.)),
                         vec3(-0.1, 0.1, 0.6 + 0.02 * image));
    for (CameraData& camera : data.cameras) {
      const double baseline = camera.name == "left" ? 0 : 0.1;
      View view;
      view.image = image;
      for (int i = 0; i < 35; ++i) {
        const vec3 corner(0.04 * (i % 7), 0.04 * (i / 7), 0.), p = world2left * corner;
        view.corners.push_back({i, corner,
                                vec2(500 * (p.x() - baseline) / p.z() + 320 + noise(0.1),
                                     500 * p.y() / p.z() + 240 + noise(0.1))});
      }
      camera.views.push_back(view);
    }
    const vec3 up = world2left.orient * vec3(0., 0., 9.81);
    data.imu->readings.push_back({image, vec3(up.x() + noise(0.01), up.y() + noise(0.01), up.z())});
  }
  return data;
}

inline Settings pinholeWithDistortion() {
  Settings settings;
  settings.model = Model("opencv4");
  return settings;
}

}  // namespace slom::calibration::testing
