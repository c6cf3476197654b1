/// The residual of a BAL observation as users of Ceres write it (examples/snavely_reprojection_error).
#pragma once

#include <ceres/rotation.h>

namespace slom::bench {

/// Camera: rotation vector, translation, f, k1, k2. Observed: (u, v) [px].
struct SnavelyResidual {
  double u, v;

  template <class T>
  bool operator()(const T* camera, const T* point, T* residual) const {
    T p[3];
    ceres::AngleAxisRotatePoint(camera, point, p);
    p[0] += camera[3];
    p[1] += camera[4];
    p[2] += camera[5];
    const T x = -p[0] / p[2];
    const T y = -p[1] / p[2];
    const T r2 = x * x + y * y;
    const T scale = camera[6] * (1.0 + r2 * (camera[7] + r2 * camera[8]));
    residual[0] = scale * x - u;
    residual[1] = scale * y - v;
    return true;
  }
};

}  // namespace slom::bench
