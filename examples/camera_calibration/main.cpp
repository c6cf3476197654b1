// Calibrates a stereo camera from corners of a board that a program has in memory, and says how far the result can be trusted.
#include <fstream>
#include <iostream>
#include <sstream>

#include <slom/calibration.hpp>

using namespace slom::calibration;

// Corners come from your detector; here from a table: image, corner, its place on the board [m], its pixel.
CameraData seenBy(const std::string& name) {
  CameraData camera;
  camera.name = name;
  camera.image_size = ImageSize{640, 480};
  std::ifstream table(SLOM_DATA_DIR "/opencv_stereo/" + name + "_corners.csv");
  std::string line;
  for (std::getline(table, line); std::getline(table, line);) {
    std::istringstream numbers(line);
    double x[7];
    for (double& number : x) (numbers >> number).ignore();
    if (camera.views.empty() || camera.views.back().image != int(x[0]))
      camera.views.push_back({int(x[0]), {}});
    camera.views.back().corners.push_back({int(x[1]), vec3(x[2], x[3], x[4]), vec2(x[5], x[6])});
  }
  return camera;
}

int main() {
  const Dataset data{{seenBy("left"), seenBy("right")}, {}};
  Settings settings;
  settings.model = Model("opencv4");
  settings.sigma_px = 0.2;

  Result result = calibrate(data, settings);
  result.quality = assess(data, settings, result);
  for (const CameraResult& camera : result.cameras) {
    for (const Parameter& p : camera.parameters) {
      const auto [value, std] = withStd(p.value, p.std);
      std::cout << camera.name << "." << p.name << " = " << value << " +- " << std << "\n";
    }
  }
  std::cout << verdictOf(result).sentence << "\n";
}
