#include "io/g2o/values.hpp"

#include <cmath>

namespace slom::io::g2o {

Pose2 readPose2(Lines& line) {
  const mtk::vect<2> position = readPoint<2>(line);
  return {mtk::SO2<>(line.number()), position};
}

Pose3 readQuaternionPose(Lines& line) {
  const mtk::vect<3> position = readPoint<3>(line);
  const mtk::vect<4> q = readPoint<4>(line);
  if (!std::isnormal(q.squaredNorm()))
    line.fail("the length of the quaternion is 0 or not finite; write a quaternion of length 1, qx qy qz qw");
  return {mtk::SO3<>(q[3], q[0], q[1], q[2]), position};
}

Pose3 readEulerPose(Lines& line) {
  const mtk::vect<3> position = readPoint<3>(line);
  const mtk::vect<3> angle = readPoint<3>(line);
  using SO3 = mtk::SO3<>;
  using vec3 = mtk::vect<3>;
  return {SO3::exp(vec3(0, 0, angle[2])) * SO3::exp(vec3(0, angle[1], 0)) * SO3::exp(vec3(angle[0], 0, 0)),
          position};
}

Symmetric<3> readToroInformation(Lines& line) {
  Symmetric<3> information;
  constexpr int place[6][2] = {{0, 0}, {0, 1}, {1, 1}, {2, 2}, {0, 2}, {1, 2}};
  for (const auto& [i, j] : place) information(i, j) = information(j, i) = line.number();
  return information;
}

}  // namespace slom::io::g2o
