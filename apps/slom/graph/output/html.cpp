#include "graph/output/html.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "graph/output/html_page.hpp"
#include "script_text.hpp"

namespace slom::app::graph {

namespace {

using Json = nlohmann::ordered_json;

/// Returns one list x, y, z, x, y, ... relative to `centre`, in hundred-thousandths of `size`, because whole numbers
/// are short.
Json coordinates(const std::vector<Sketch::Place>& places, const Sketch::Place& centre, double size) {
  Json list = Json::array();
  for (const auto& place : places) {
    for (std::size_t i = 0; i < 3; ++i) list.push_back(std::lround(1e5 * (place[i] - centre[i]) / size));
  }
  return list;
}

/// Returns the largest distance from `centre`; 1 if all is at the centre.
double farthest(const Sketch& sketch, const Sketch::Place& centre) {
  double most = 0;
  const auto look = [&](const std::vector<Sketch::Place>& places) {
    for (const auto& p : places)
      most = std::max(most, std::hypot(p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]));
  };
  look(sketch.poses);
  look(sketch.landmarks);
  for (const Sketch::Frame& frame : sketch.frames) {
    look(frame.poses);
    look(frame.landmarks);
  }
  return most > 0 ? most : 1;
}

Json pairs(const std::vector<Sketch::Line>& lines) {
  Json list = Json::array();
  for (const auto& [from, to] : lines) {
    list.push_back(from);
    list.push_back(to);
  }
  return list;
}

Json dataOf(const Sketch& sketch) {
  const auto [low, high] = sketch.bounds();
  Sketch::Place centre{};
  for (std::size_t i = 0; i < 3; ++i) centre[i] = (low[i] + high[i]) / 2;
  const double size = farthest(sketch, centre);
  Json frames = Json::array();
  for (const Sketch::Frame& frame : sketch.frames) {
    frames.push_back({{"pose", frame.pose},
                      {"poses", coordinates(frame.poses, centre, size)},
                      {"landmarks", coordinates(frame.landmarks, centre, size)}});
  }
  return {{"name", sketch.name},
          {"flat", sketch.is_flat},
          {"poses", coordinates(sketch.poses, centre, size)},
          {"path", pairs(sketch.path)},
          {"closures", pairs(sketch.closures)},
          {"landmarks", coordinates(sketch.landmarks, centre, size)},
          {"fixed", sketch.fixed},
          {"frames", frames}};
}

}  // namespace

std::string toHtml(const Sketch& sketch) {
  return std::string(page_before_data) + scriptText(dataOf(sketch)) + page_after_data;
}

}  // namespace slom::app::graph
