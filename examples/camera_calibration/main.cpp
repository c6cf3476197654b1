// Calibrates a stereo camera from files of corners, and says how far the result can be trusted.
#include <iostream>
#include <string>

#include <slom/calibration.hpp>

using namespace slom::calibration;

int main() {
  // Corners from your own detector go into CameraData::views instead: image by image, their places on the board [m] and their pixels.
  const std::string folder = SLOM_DATA_DIR "/opencv_stereo/";
  Dataset data{{readCorners("left", folder + "left_corners.csv"), readCorners("right", folder + "right_corners.csv")}, {}};
  for (CameraData& camera : data.cameras) camera.image_size = ImageSize{640, 480};
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
