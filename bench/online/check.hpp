/// A growing map compared with its batch optimum.
#pragma once

#include <algorithm>
#include <cmath>

#include <slom/initialize/growing_map.hpp>
#include <slom/io.hpp>
#include <slom/slom.hpp>

#include "online/replay.hpp"

namespace slom::bench {

/// Model by which the measurements of a graph are inserted.
template <class Graph>
struct ModelOf {
  using type = initialize::RelationModel;
};
template <class Pose>
struct ModelOf<io::PoseGraph<Pose>> {
  using type = io::PoseGraphModel;
};
template <class Graph>
using Map = initialize::GrowingMap<Graph, typename ModelOf<Graph>::type>;

/// Step of pose numbers at which fits are compared with the batch optimum.
inline constexpr int kCompared = 100;
/// RSS below which it is rounding error, as before a loop closes.
inline constexpr double kLeastRss = 1e-6;

/// Compares the map of the poses 0 to `last` with the fit of the same problem from its values.
template <class Graph>
Check compare(const Estimator& est, const Map<Graph>& map, int last) {
  Estimator batch;
  const Map<Graph> optimum = map.copyTo(batch);
  const double rss = batch.optimize().final_rss;
  Check check;
  check.pose = last;
  if (rss > kLeastRss) check.gap = est.getRSS() / rss - 1;
  double sum = 0;
  for (int p = 0; p <= last; ++p) sum += (map.pose(p)->pos - optimum.pose(p)->pos).squaredNorm();
  check.position_error = std::sqrt(sum / (last + 1));
  return check;
}

}  // namespace slom::bench
