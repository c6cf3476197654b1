#include "slom/io/data_hash.hpp"

#include "slom/io/word_hash.hpp"

namespace slom::io {

namespace {

template <int N>
void addTo(WordHash& hash, const mtk::vect<N>& point) {
  for (int i = 0; i < N; ++i) hash.add(double(point[i]));
}
void addTo(WordHash& hash, const mtk::SO2<>& direction) { hash.add(direction.angle()); }
void addTo(WordHash& hash, const Pose2& pose) {
  addTo(hash, pose.pos);
  addTo(hash, pose.orient);
}
void addTo(WordHash& hash, const Pose3& pose) {
  addTo(hash, pose.pos);
  const auto& R = pose.orient;
  hash.add(R.x()).add(R.y()).add(R.z()).add(R.w());
}

/// Returns the hash of a measurement. `kind` tells apart measurements of different kinds with the same numbers.
template <class Datum>
std::uint64_t hashOf(std::uint64_t kind, std::uint64_t from, std::uint64_t to, const Datum& measured) {
  WordHash hash;
  hash.add(kind).add(from).add(to);
  addTo(hash, measured);
  return hash.value();
}

}  // namespace

template <class Pose>
std::uint64_t dataHash(const PoseGraph<Pose>& graph) {
  const auto pose = [&](int i) { return graph.poses[std::size_t(i)].id; };
  const auto landmark = [&](int i) { return graph.landmarks[std::size_t(i)].id; };
  std::uint64_t sum = 0;
  for (const auto& edge : graph.edges) sum += hashOf(1, pose(edge.from), pose(edge.to), edge.measured);
  for (const auto& sighting : graph.sightings)
    sum += hashOf(2, pose(sighting.from), landmark(sighting.to), sighting.measured);
  for (const auto& bearing : graph.bearings)
    sum += hashOf(3, pose(bearing.from), landmark(bearing.to), bearing.measured);
  for (const auto& prior : graph.pose_priors) sum += hashOf(4, pose(prior.pose), 0, prior.measured);
  for (const auto& prior : graph.position_priors) sum += hashOf(5, pose(prior.pose), 0, prior.measured);
  return sum;
}

std::uint64_t dataHash(const Scene& scene, const std::vector<int>& cameras, const std::vector<int>& points) {
  const auto number = [](const std::vector<int>& numbers, int place) {
    return std::uint64_t(numbers.empty() ? place : numbers[std::size_t(place)]);
  };
  std::uint64_t sum = 0;
  for (const Observation& o : scene.observations)
    sum += hashOf(6, number(cameras, o.camera), number(points, o.point), o.pixel);
  return sum;
}

// As in toG2o: a shared library hides instances of templates unless an attribute exports them.
template __attribute__((visibility("default"))) std::uint64_t dataHash(const PoseGraph<Pose2>&);
template __attribute__((visibility("default"))) std::uint64_t dataHash(const PoseGraph<Pose3>&);

}  // namespace slom::io
