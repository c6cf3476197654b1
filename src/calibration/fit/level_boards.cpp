#include <cmath>
#include <map>

#include "calibration/fit/calibrate_model.hpp"
#include "slom/calibration/board.hpp"

namespace slom::calibration {

int upOfLevelBoards(const Dataset& data, const Result& result) {
  constexpr double level = 0.87;  // cosine of 30 degrees
  std::map<int, SE3> left2world;
  for (const ImageResult& image : result.images) left2world.emplace(image.image, image.left2world);
  int up = 0;
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    for (const View& view : data.cameras[c].views) {
      const SE3 plane2world = fitPlane(view.corners).plane2world;
      if (std::abs((plane2world.orient * vec3(0., 0., 1.)).z()) < level) return 0;
      const SE3 camera2world = left2world.at(view.image) * result.cameras[c].left2camera.inverse();
      const int side = camera2world.pos.z() > plane2world.pos.z() ? 1 : -1;
      if (up != 0 && side != up) return 0;
      up = side;
    }
  }
  return up;
}

}  // namespace slom::calibration
