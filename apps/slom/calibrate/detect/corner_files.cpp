#include "calibrate/detect/corner_files.hpp"

#include <iterator>

#include <fmt/format.h>

#include "printable.hpp"

namespace slom::app::calib {

std::string toCornerFile(const CameraData& camera) {
  std::string text;
  if (camera.image_size)
    text += fmt::format("# image_size_px: {} x {}\n", camera.image_size->width, camera.image_size->height);
  for (const UnusedPhoto& photo : camera.unused)
    text += fmt::format("# {}: {}\n", oneLine(photo.file), photo.reason);
  text += "image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px\n";
  for (const View& view : camera.views) {
    text += fmt::format("# photo {}: {}\n", view.image, oneLine(view.photo));
    for (const Corner& c : view.corners) {
      fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{}\n", view.image, c.number, c.world.x(),
                     c.world.y(), c.world.z(), c.pixel.x(), c.pixel.y());
    }
  }
  return text;
}

}  // namespace slom::app::calib
