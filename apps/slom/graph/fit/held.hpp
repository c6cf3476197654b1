// What holds a map beside lines FIX.
#pragma once

#include <string>
#include <vector>

#include <slom/estimator.hpp>

namespace slom::app::graph {

/// A component of a pose's rotation that keeps its value, as where the map can turn about a fixed landmark. As the RSS does not
/// depend on that, it is the same.
struct HeldRotation {
  int pose = 0;
  std::string path;  ///< "orient" or a component of it
};

/// What holds the map beside lines FIX.
struct Gauge {
  std::string text;  ///< "pose 0", "the first vertex of 3 more parts"; empty where the lines FIX suffice
  std::vector<HeldRotation> rotations;
  std::string rotations_text;  ///< "the heading of pose 0, because the map can turn about landmark 2"

  /// Fixes what is held of pose number `pose`, whose variable is `id`.
  template <class Pose>
  void hold(Estimator& est, int pose, const VarID<Pose>& id) const {
    for (const HeldRotation& held : rotations) {
      if (held.pose == pose) est.fix(id, held.path);
    }
  }
};

}  // namespace slom::app::graph
