#include "bundle/output/output.hpp"

#include <iterator>

#include <fmt/format.h>

#include <slom/io/bal.hpp>

#include "text.hpp"

namespace slom::app::bundle {

namespace {

using Text = fmt::memory_buffer;

template <class... Args>
void append(Text& text, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
}

struct Colour {
  int red, green, blue;
};
constexpr Colour point_colour{170, 170, 170}, camera_colour{230, 40, 40};

void appendVertex(Text& text, const mtk::vect<3>& p, const Colour& colour) {
  append(text, "{} {} {} {} {} {}\n", p[0], p[1], p[2], colour.red, colour.green, colour.blue);
}

}  // namespace

Format formatOf(const std::string& file) {
  if (file.ends_with(".txt") || file.ends_with(".bal")) return Format::bal;
  return file.ends_with(".ply") ? Format::ply : Format::unknown;
}

std::string toPly(const Scene& scene) {
  Text text;
  append(text,
         "ply\nformat ascii 1.0\ncomment {}, then the centres of {}\nelement vertex {}\n"
         "property double x\nproperty double y\nproperty double z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
         plural(scene.points.size(), "point"), plural(scene.cameras.size(), "camera"),
         scene.points.size() + scene.cameras.size());
  for (const mtk::vect<3>& point : scene.points) appendVertex(text, point, point_colour);
  for (const Camera& camera : scene.cameras) appendVertex(text, camera.pose.inverse().pos, camera_colour);
  return fmt::to_string(text);
}

std::string toText(const Scene& scene, const std::string& file) {
  return formatOf(file) == Format::ply ? toPly(scene) : io::toBal(scene);
}

}  // namespace slom::app::bundle
