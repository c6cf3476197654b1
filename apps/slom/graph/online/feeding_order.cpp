#include "graph/online/feeding_order.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <set>
#include <utility>

namespace slom::app::graph {

namespace {

template <class Pose>
class Feeding {
 public:
  explicit Feeding(const PoseGraph<Pose>& graph)
      : graph_(graph),
        edges_(graph.poses.size()),
        sightings_(graph.poses.size()),
        observers_(graph.landmarks.size()),
        is_fed_(graph.poses.size(), 0),
        is_seen_(graph.landmarks.size(), 0) {
    for (std::size_t l = 0; l < graph.landmarks.size(); ++l) is_seen_[l] = graph.landmarks[l].fixed ? 1 : 0;
    for (const auto& edge : graph.edges) {
      edges_[std::size_t(edge.from)].push_back(edge.to);
      edges_[std::size_t(edge.to)].push_back(edge.from);
    }
    for (const auto& sighting : graph.sightings) {
      sightings_[std::size_t(sighting.from)].push_back(sighting.to);
      observers_[std::size_t(sighting.to)].push_back(sighting.from);
    }
  }

  std::vector<int> run() {
    std::vector<int> by_id(graph_.poses.size());
    std::iota(by_id.begin(), by_id.end(), 0);
    std::sort(by_id.begin(), by_id.end(), [&](int a, int b) { return id(a) < id(b); });
    for (const int p : by_id) {
      if (isConnected(p)) {
        feed(p);
      } else {
        waiting_.insert(p);
      }
    }
    for (const int p : by_id) {
      if (waiting_.count(p) > 0) feed(p);
    }
    return std::move(order_);
  }

 private:
  std::uint64_t id(int p) const { return graph_.poses[std::size_t(p)].id; }

  bool isConnected(int p) const {
    const auto& edges = edges_[std::size_t(p)];
    const auto& sightings = sightings_[std::size_t(p)];
    return order_.empty() || graph_.poses[std::size_t(p)].fixed ||
           std::any_of(edges.begin(), edges.end(), [&](int q) { return is_fed_[std::size_t(q)] != 0; }) ||
           std::any_of(sightings.begin(), sightings.end(),
                       [&](int l) { return is_seen_[std::size_t(l)] != 0; });
  }

  /// Feeds a pose, and then those that have waited for it, by ascending id.
  void feed(int first) {
    std::set<std::pair<std::uint64_t, int>> ready{{id(first), first}};
    const auto wake = [&](int p) {
      if (waiting_.count(p) > 0) ready.emplace(id(p), p);
    };
    while (!ready.empty()) {
      const int p = ready.begin()->second;
      ready.erase(ready.begin());
      waiting_.erase(p);
      order_.push_back(p);
      is_fed_[std::size_t(p)] = 1;
      for (const int q : edges_[std::size_t(p)]) wake(q);
      for (const int l : sightings_[std::size_t(p)]) {
        if (std::exchange(is_seen_[std::size_t(l)], char(1)) != 0) continue;
        for (const int q : observers_[std::size_t(l)]) wake(q);
      }
    }
  }

  const PoseGraph<Pose>& graph_;
  std::vector<std::vector<int>> edges_, sightings_, observers_;  // poses, landmarks, poses
  std::vector<char> is_fed_, is_seen_;
  std::set<int> waiting_;
  std::vector<int> order_;
};

}  // namespace

template <class Pose>
std::vector<int> feedingOrder(const PoseGraph<Pose>& graph) {
  return Feeding<Pose>(graph).run();
}

template std::vector<int> feedingOrder(const PoseGraph<Pose2>&);
template std::vector<int> feedingOrder(const PoseGraph<Pose3>&);

}  // namespace slom::app::graph
