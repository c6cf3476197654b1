// The camera of "Bundle adjustment in the large", and how it sees a point.
#pragma once

#include <mtk/build_manifold.hpp>
#include <mtk/mtk.hpp>
#include <slom/measurements/intrinsics.hpp>

namespace slom::app::bundle {

using Pose = mtk::trafo<mtk::SO3<>>;
using Lens = slom::SnavelyIntrinsics<>;
/// Each camera has a lens of its own. It looks along -z, with x to the right and y upwards.
///   state    pose cam_T_world, P = R X + t; lens f [px], k1, k2
///   tangent  translation, rotation, lens: DOF = 9
MTK_BUILD_MANIFOLD(Camera, ((Pose, pose))((Lens, lens)))

/// The pixel at which a camera sees a point of the world, from the image centre, v upwards [px].
struct Sight {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& camera, const auto& point) const {
    return camera.lens.project(camera.pose * point);
  }
};

}  // namespace slom::app::bundle
