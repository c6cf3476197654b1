/// Projection and Reprojection: points seen in an image.
///
///     est.insertMeasurement(slom::Projection(), intrinsics, in_camera, slom::measured(pixel), noise);
///     est.insertMeasurement(slom::Reprojection(), pose, intrinsics, point, slom::measured(pixel), noise);
///     est.insertMeasurement(slom::Reprojection(), camera, point, slom::measured(pixel), noise);
///
///   variables  intrinsics  a lens of slom/measurements/intrinsics.hpp; one variable for all measurements that share it
///              in_camera   a point in the camera's frame, 3
///              pose        cam_T_world, mtk::trafo<mtk::SO3<>>: moves points from the world to the camera's frame
///              point       in the world, 3, in the unit of the pose
///              camera      a camera with its own lens: any compound with the members `pose` and `intrinsics`
///   datum      pixel, 2 [px]
///   residual   projection - pixel [px]; not finite if the point has no image (see the lens)
/// To use a pose world_T_cam, as in slom::RelativePose, write your own function:
///     [](const auto& pose, const auto& lens, const auto& point) { return lens.project(pose.inverse() * point); }
#pragma once

#include "mtk/build_manifold.hpp"
#include "mtk/types/trafo.hpp"
#include "slom/measurements/intrinsics.hpp"

namespace slom {

/// Predicts the pixel of a point in the camera's frame.
struct Projection {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& intrinsics, const auto& in_camera) const {
    return intrinsics.project(in_camera);
  }
};

/// Predicts the pixel of a point in the world, for a camera with the pose cam_T_world.
struct Reprojection {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& pose, const auto& intrinsics, const auto& point) const {
    return intrinsics.project(pose * point);
  }
  auto operator()(const auto& camera, const auto& point) const {
    return (*this)(camera.pose, camera.intrinsics, point);
  }
};

namespace detail {
using CameraPose = mtk::trafo<mtk::SO3<>>;
}

// Cameras that have their own lens: pose (world to camera), then intrinsics.
// clang-format off
/// A camera as one variable, with a pinhole lens: pose cam_T_world, then intrinsics.
MTK_BUILD_MANIFOLD(PinholeCamera, ((detail::CameraPose, pose)) ((PinholeIntrinsics<>, intrinsics)))
/// A camera as one variable, with OpenCV's 5 coefficients of distortion.
MTK_BUILD_MANIFOLD(OpenCv5Camera, ((detail::CameraPose, pose)) ((OpenCv5Intrinsics<>, intrinsics)))
/// A camera as one variable, with a fisheye lens.
MTK_BUILD_MANIFOLD(FisheyeCamera, ((detail::CameraPose, pose)) ((FisheyeIntrinsics<>, intrinsics)))
/// A camera as one variable, with the lens of "Bundle adjustment in the large", which looks along -z.
MTK_BUILD_MANIFOLD(SnavelyCamera, ((detail::CameraPose, pose)) ((SnavelyIntrinsics<>, intrinsics)))
// clang-format on

}  // namespace slom
