#include <iterator>

#include <fmt/format.h>

#include "slom/io/bal.hpp"

namespace slom::io {

namespace bal {
namespace {

/// Appends one number per line.
void appendLines(fmt::memory_buffer& text, const auto& numbers) {
  for (const double x : numbers) fmt::format_to(std::back_inserter(text), "{}\n", x);
}

}  // namespace
}  // namespace bal

std::string toBal(const Scene& scene) {
  fmt::memory_buffer text;
  const auto append = std::back_inserter(text);
  fmt::format_to(append, "{} {} {}\n", scene.cameras.size(), scene.points.size(), scene.observations.size());
  for (const Observation& o : scene.observations)
    fmt::format_to(append, "{} {} {} {}\n", o.camera, o.point, o.pixel[0], o.pixel[1]);
  for (const Camera& camera : scene.cameras) {
    bal::appendLines(text, mtk::SO3<>::log(camera.pose.orient));
    bal::appendLines(text, camera.pose.pos);
    bal::appendLines(text, camera.lens);
  }
  for (const mtk::vect<3>& point : scene.points) bal::appendLines(text, point);
  return fmt::to_string(text);
}

}  // namespace slom::io
