/// The three measurements as a user of SLoM writes them: functions of any type that computes like numbers.
///
///   BalReprojection     camera (9), point (3)                            residual 2   [px]
///   RelativePose        pose a (6), pose b (6)                           residual 6   [m, rad]
///   StereoReprojection  intrinsics (18), left2right (6), board2left (6)  residual 4   [px]
///
/// Every argument is `const auto&`: the same code runs on double, on dual numbers and on packs of either.
#pragma once

#include <mtk/mtk.hpp>
#include <mtk/preaccumulation.hpp>

namespace slom::bench {

using SE3 = mtk::trafo<mtk::SO3<>>;

using Vec3 = mtk::vect<3>;
using OpenCv5 = mtk::vect<9>;  ///< fx, fy, cx, cy, k1, k2, p1, p2, k3

/// Camera of "Bundle adjustment in the large". It looks along -z. Its pose maps points of the world to its frame. The
/// lens is f [px], k1, k2.
MTK_BUILD_MANIFOLD(BalCamera, ((SE3, pose))((Vec3, lens)))

/// Two cameras that look along z.
MTK_BUILD_MANIFOLD(StereoIntrinsics, ((OpenCv5, left))((OpenCv5, right)))

/// P = R X + t, p = -P.xy / P.z, residual f (1 + k1 |p|^2 + k2 |p|^4) p - pixel.
struct BalReprojection {
  auto operator()(const auto& camera, const auto& point, const auto& pixel) const {
    return mtk::preaccumulate(camera.pose * point, [&](const auto& P) {
      const auto& [X, Y, Z] = P;
      const auto x = -X / Z;
      const auto y = -Y / Z;
      const auto r2 = x * x + y * y;
      const auto& [f, k1, k2] = camera.lens;
      const auto scale = f * (1.0 + r2 * (k1 + r2 * k2));
      return mtk::vector(scale * x - pixel[0], scale * y - pixel[1]);
    });
  }
};

/// Predicts the pose of b seen from a. The residual is the prediction [-] the measured pose.
struct RelativePose {
  auto operator()(const auto& a, const auto& b) const { return a.inverse() * b; }
};

/// A point of the board in both images; residual (left, right) - pixels.
struct StereoReprojection {
  auto operator()(const auto& intrinsics, const auto& left2right, const auto& board2left,
                  const auto& on_board, const auto& pixels) const {
    const auto in_left = board2left * on_board;
    const auto in_right = left2right * in_left;
    const auto [u, v] =
        mtk::preaccumulate(in_left, [&](const auto& p) { return project(intrinsics.left, p); });
    const auto [u2, v2] =
        mtk::preaccumulate(in_right, [&](const auto& p) { return project(intrinsics.right, p); });
    return mtk::vector(u - pixels[0], v - pixels[1], u2 - pixels[2], v2 - pixels[3]);
  }

  static auto project(const auto& intrinsics, const auto& p) {
    const auto& [fx, fy, cx, cy, k1, k2, p1, p2, k3] = intrinsics;
    const auto& [X, Y, Z] = p;
    const auto x = X / Z;
    const auto y = Y / Z;
    const auto xx = x * x;
    const auto yy = y * y;
    const auto xy2 = 2.0 * x * y;
    const auto r2 = xx + yy;
    const auto radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
    return mtk::vector(fx * (x * radial + p1 * xy2 + p2 * (r2 + 2.0 * xx)) + cx,
                       fy * (y * radial + p1 * (r2 + 2.0 * yy) + p2 * xy2) + cy);
  }
};

}  // namespace slom::bench
