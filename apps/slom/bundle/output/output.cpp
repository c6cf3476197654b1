#include "bundle/output/output.hpp"

#include <iterator>

#include <fmt/format.h>

#include <slom/io/bal.hpp>

#include "text.hpp"

namespace slom::app::bundle {

namespace {

template <class... Args>
void append(std::string& text, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
}

struct Colour {
  int red, green, blue;
};
constexpr Colour point_colour{170, 170, 170}, camera_colour{230, 40, 40};

void appendVertex(std::string& text, const mtk::vect<3>& p, const Colour& colour) {
  append(text, "{} {} {} {} {} {}\n", p[0], p[1], p[2], colour.red, colour.green, colour.blue);
}

}  // namespace

Format formatOf(const std::string& file) {
  if (file.ends_with(".txt") || file.ends_with(".bal")) return Format::bal;
  return file.ends_with(".ply") ? Format::ply : Format::unknown;
}

void appendPlyHead(std::string& text, std::size_t points, std::size_t cameras) {
  append(text,
         "ply\nformat ascii 1.0\ncomment {}, then the centres of {}\nelement vertex {}\n"
         "property double x\nproperty double y\nproperty double z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
         plural(points, "point"), plural(cameras, "camera"), points + cameras);
}
void appendPly(std::string& text, const mtk::vect<3>& point) { appendVertex(text, point, point_colour); }
void appendPly(std::string& text, const Camera& camera) {
  appendVertex(text, camera.pose.inverse().pos, camera_colour);
}

std::string toPly(const Scene& scene) {
  std::string text;
  appendPlyHead(text, scene.points.size(), scene.cameras.size());
  for (const mtk::vect<3>& point : scene.points) appendPly(text, point);
  for (const Camera& camera : scene.cameras) appendPly(text, camera);
  return text;
}

std::string toText(const Scene& scene, const std::string& file) {
  return formatOf(file) == Format::ply ? toPly(scene) : io::toBal(scene);
}

}  // namespace slom::app::bundle
