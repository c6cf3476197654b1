// Number of directions of a scene's unknowns that change no image.
#pragma once

#include <string>
#include <vector>

#include "bundle/scene.hpp"

namespace slom::app::bundle {

/// The null space of the Jacobian J of all observations with respect to all cameras (9 unknowns) and points (3).
struct FreeDirections {
  int count = 0;         ///< unknowns - rank of J; if is_exact is false, a lower bound
  bool is_exact = true;  ///< false: a part of the scene is too large, or there was no time
  int further = 0;       ///< those not explained by place, rotation and scale of a part, or by points
                         ///< and cameras with few observations
  std::vector<std::string> names;  ///< what moves in the further ones, most important first
};

/// Dimension of position, rotation and scale of a part of a scene, which no image determines.
inline constexpr int similarity = 7;

/// Number of points up to which a camera has more unknowns than its images give equations.
inline constexpr std::size_t few_points = 4;

/// Counts free directions at the values of `scene`. `may_take_long`: also counts parts for which counting takes as long
/// as some iterations of the fit.
///   points that one camera sees     1 direction each, along the ray
///   cameras of at most few_points   9 - 2 for each point, if their images are independent
///   the rest                        part by part, by slom::diagnose(est)
FreeDirections countFreeDirections(const Scene& scene, int threads, bool may_take_long);

}  // namespace slom::app::bundle
