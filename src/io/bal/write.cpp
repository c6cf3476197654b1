#include <iterator>

#include <fmt/format.h>

#include "slom/io/bal.hpp"

namespace slom::io {

void appendBalCounts(std::string& text, std::size_t cameras, std::size_t points, std::size_t observations) {
  fmt::format_to(std::back_inserter(text), "{} {} {}\n", cameras, points, observations);
}
void appendBal(std::string& text, const Observation& o) {
  fmt::format_to(std::back_inserter(text), "{} {} {} {}\n", o.camera, o.point, o.pixel[0], o.pixel[1]);
}
void appendBal(std::string& text, double number) { fmt::format_to(std::back_inserter(text), "{}\n", number); }
void appendBal(std::string& text, const Camera& camera) {
  const mtk::vect<3> rotation = mtk::SO3<>::log(camera.pose.orient);
  for (const double x : rotation) appendBal(text, x);
  for (const double x : camera.pose.pos) appendBal(text, x);
  for (const double x : camera.lens) appendBal(text, x);
}
void appendBal(std::string& text, const mtk::vect<3>& point) {
  for (const double x : point) appendBal(text, x);
}

std::string toBal(const Scene& scene) {
  std::string text;
  appendBalCounts(text, scene.cameras.size(), scene.points.size(), scene.observations.size());
  for (const Observation& observation : scene.observations) appendBal(text, observation);
  for (const Camera& camera : scene.cameras) appendBal(text, camera);
  for (const mtk::vect<3>& point : scene.points) appendBal(text, point);
  return text;
}

}  // namespace slom::io
