/// A bundle adjustment as it stands in a file of BAL (slom/io/bal.hpp): cameras, points, and the pixels at which the ones see the
/// others. slom/io/scene_model.hpp inserts it into an estimator.
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
/// The camera of "Bundle adjustment in the large". Each has a lens of its own and looks along -z, with x to the right and y upwards.
///   state    pose cam_T_world, P = R X + t; lens f [px], k1, k2
///   tangent  translation, rotation, lens: DOF = 9
MTK_BUILD_MANIFOLD(Camera, ((CameraPose, pose))((CameraLens, lens)))

/// The pixel at which a camera sees a point of the world, from the image centre, v upwards [px].
struct CameraProjection {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& camera, const auto& point) const {
    return camera.lens.project(camera.pose * point);
  }
};

/// Point number `point` as camera number `camera` sees it; both count from 0.
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

  /// Prediction - observation [px].
  mtk::vect<2> residual(const Observation& observation) const;
  /// The sum of squares of all residuals, without a loss and without a factor 1/2 [px^2].
  double sumOfSquares() const;
  /// sqrt(sum of squares / observations): the root mean square of the distance to the observed pixel [px].
  double rms() const;
};

}  // namespace slom::io
