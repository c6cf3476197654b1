#include <algorithm>
#include <cstdint>
#include <iterator>

#include <fmt/format.h>

#include "slom/calibration/files.hpp"

namespace slom::calibration {
namespace {

/// Escapes characters that would end a line or a comment: newline as \x0a.
std::string oneLine(std::string_view text) {
  std::string line;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) {
      line += fmt::format("\\x{:02x}", byte);
    } else {
      line += c;
    }
  }
  return line;
}

}  // namespace

std::string toCornerFile(const CameraData& camera) {
  std::string text;
  if (camera.image_size)
    text += fmt::format("# image_size_px: {} x {}\n", camera.image_size->width, camera.image_size->height);
  for (const UnusedPhoto& photo : camera.unused)
    text += fmt::format("# {}: {}\n", oneLine(photo.file), oneLine(photo.reason));
  const bool have_times = std::all_of(camera.views.begin(), camera.views.end(),
                                      [](const View& view) { return view.time_ns.has_value(); });
  text += fmt::format("{},corner,world_x_m,world_y_m,world_z_m,u_px,v_px\n", have_times ? "t_ns" : "image");
  for (const View& view : camera.views) {
    const std::int64_t image = have_times ? *view.time_ns : view.image;
    if (!view.photo.empty()) text += fmt::format("# photo {}: {}\n", image, oneLine(view.photo));
    for (const Corner& c : view.corners) {
      fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{}\n", image, c.number, c.world.x(),
                     c.world.y(), c.world.z(), c.pixel.x(), c.pixel.y());
    }
  }
  return text;
}

}  // namespace slom::calibration
