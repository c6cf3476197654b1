/// Scene: a bundle adjustment from a BAL file (slom/io/bal.hpp). It has cameras, points, and the pixels where cameras
/// see points. slom/io/scene_model.hpp inserts a scene into an estimator.
#pragma once

#include <string>
#include <vector>

#include "mtk/build_manifold.hpp"
#include "mtk/types/so3.hpp"
#include "mtk/types/trafo.hpp"
#include "mtk/types/vect.hpp"
#include "slom/measurements/intrinsics.hpp"

namespace slom::io {

using CameraPose = mtk::trafo<mtk::SO3<>>;
using CameraLens = slom::SnavelyIntrinsics<>;
/// The camera of "Bundle adjustment in the large". Each camera has its own lens and looks along -z, with x to the right
/// and y upwards.
///   state    pose cam_T_world, P = R X + t; lens f [px], k1, k2
///   tangent  translation, rotation, lens: DOF = 9
MTK_BUILD_MANIFOLD(Camera, ((CameraPose, pose))((CameraLens, lens)))

/// Predicts the pixel where a camera sees a point of the world, from the image centre, v upwards [px].
struct CameraProjection {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& camera, const auto& point) const {
    return camera.lens.project(camera.pose * point);
  }
};

/// An observation of point number `point` by camera number `camera`; both count from 0.
struct Observation {
  int camera = 0;
  int point = 0;
  int line = 0;  ///< line of the file
  mtk::vect<2> pixel;
};

struct Scene {
  std::string file;
  std::vector<Camera> cameras;
  std::vector<mtk::vect<3>> points;
  std::vector<Observation> observations;

  /// Returns prediction - observation [px].
  mtk::vect<2> residual(const Observation& observation) const;
  /// Returns the sum of squares of all residuals, without losses and without a factor 1/2 [px^2].
  double sumOfSquares() const;
  /// Returns sqrt(sum of squares / observations): the root mean square distance from the observed pixels [px].
  double rms() const;
};

}  // namespace slom::io
