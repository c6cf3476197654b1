// Numbers after a tag, read as poses, points and information matrices.
#pragma once

#include "io/g2o/lines.hpp"
#include "slom/io/pose_graph.hpp"

namespace slom::io::g2o {

/// Reads `x y theta`.
Pose2 readPose2(Lines& line);
/// Reads `x y z qx qy qz qw`. The quaternion is normalised; 0 is refused.
Pose3 readQuaternionPose(Lines& line);
/// Reads `x y z roll pitch yaw`, with the rotation Rz(yaw) Ry(pitch) Rx(roll).
Pose3 readEulerPose(Lines& line);

/// Reads `x y` or `x y z`.
template <int N>
mtk::vect<N> readPoint(Lines& line) {
  mtk::vect<N> point;
  for (int i = 0; i < N; ++i) point[i] = line.number();
  return point;
}

/// Reads the upper triangle row by row, `I11 I12 ... I1n I22 ... Inn`.
template <int N>
Symmetric<N> readInformation(Lines& line) {
  Symmetric<N> information;
  for (int i = 0; i < N; ++i) {
    for (int j = i; j < N; ++j) information(i, j) = information(j, i) = line.number();
  }
  return information;
}

/// Reads TORO's order in the plane, `I11 I12 I22 I33 I13 I23`.
Symmetric<3> readToroInformation(Lines& line);

}  // namespace slom::io::g2o
