// Corner files of slom calibrate, and what is checked before a fit.
#include <slom/calibration.hpp>

#include "calibration/data/check.hpp"
#include "fuzz/target.hpp"

SLOM_FUZZ_TARGET(corners) {
  using namespace slom::calibration;
  const MemoryFile file(input);
  CameraData camera;
  if (!accepted([&] { camera = readCorners("left", file.name()); })) return;
  require(!camera.image_size || isPlausible(*camera.image_size), "an image size that cannot be");
  for (const View& view : camera.views) {
    require(!view.corners.empty() && camera.find(view.image) == &view, "a view is empty or not found");
    for (const Corner& corner : view.corners)
      require(corner.world.allFinite() && corner.pixel.allFinite(), "a corner is not finite");
  }
  accepted([&] { checkViews(camera); });
}
