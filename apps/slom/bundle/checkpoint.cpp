#include "bundle/checkpoint.hpp"

#include <string_view>
#include <unordered_map>

#include <fmt/format.h>

#include <slom/io/data_hash.hpp>

#include "fitting/checkpoints.hpp"

namespace slom::app::bundle {

namespace {

std::uint64_t nameOfCamera(int number) { return 2 * std::uint64_t(number); }
std::uint64_t nameOfPoint(int number) { return 2 * std::uint64_t(number) + 1; }

}  // namespace

io::Checkpoint::Problem problemOf(const Scene& scene, const SceneNumbers& numbers) {
  return {fmt::format("bundle of {} cameras, {} points, {} observations", numbers.camera_count,
                      numbers.point_count, numbers.observation_count),
          [&] { return io::dataHash(scene, numbers.cameras, numbers.points); }};
}

void takeValues(const io::Checkpoint& checkpoint, const SceneNumbers& numbers, Scene& scene) {
  std::unordered_map<std::uint64_t, Camera*> cameras;
  std::unordered_map<std::uint64_t, mtk::vect<3>*> points;
  for (std::size_t i = 0; i < numbers.cameras.size(); ++i)
    cameras.emplace(nameOfCamera(numbers.cameras[i]), &scene.cameras[i]);
  for (std::size_t i = 0; i < numbers.points.size(); ++i)
    points.emplace(nameOfPoint(numbers.points[i]), &scene.points[i]);
  checkpoint.read([&](std::uint64_t name, std::string_view bytes) {
    if (const auto camera = cameras.find(name); camera != cameras.end()) takeValue(bytes, *camera->second);
    if (const auto point = points.find(name); point != points.end()) takeValue(bytes, *point->second);
  });
}

io::Checkpoint::Values valuesOf(const std::vector<VarID<Camera>>& cameras,
                                const std::vector<VarID<mtk::vect<3>>>& points, const SceneNumbers& numbers,
                                const std::vector<char>& is_written) {
  io::Checkpoint::Values values;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (is_written.empty() || is_written[i] != 0) values.add(nameOfCamera(numbers.cameras[i]), *cameras[i]);
  }
  for (std::size_t i = 0; i < points.size(); ++i) values.add(nameOfPoint(numbers.points[i]), *points[i]);
  return values;
}

}  // namespace slom::app::bundle
