// Corner files of slom calibrate, and the checks before a fit.
#include <slom/calibration.hpp>

#include "calibration/data/check.hpp"
#include "fuzz/target.hpp"

SLOM_FUZZ_TARGET(corners) {
  using namespace slom::calibration;
  const MemoryFile file(input);
  CameraData camera;
  accepted([&] { (void)readKalibrTarget(file.name()); });
  const BoardOfFiles board{3, 2, 0.05};  // that of the seeds
  if (!accepted([&] { camera = readCorners("left", file.name()); }) && !accepted([&] {
        camera = readRig({{"left", {file.name()}}}, "", board).cameras.front();
      }))
    return;
  require(!camera.image_size || isPlausible(*camera.image_size), "an image size that cannot be");
  for (const View& view : camera.views) {
    require(!view.corners.empty() && camera.find(view.image) == &view, "a view is empty or not found");
    for (const Corner& corner : view.corners)
      require(corner.world.allFinite() && corner.pixel.allFinite(), "a corner is not finite");
  }
  accepted([&] { checkViews(camera); });
}
