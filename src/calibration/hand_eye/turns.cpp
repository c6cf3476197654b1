#include "calibration/hand_eye/turns.hpp"

#include <cmath>

#include <fmt/format.h>

#include "calibration/hand_eye/robust_alignment.hpp"
#include "calibration/rotation_vector.hpp"
#include "calibration/symmetric.hpp"

namespace slom::calibration {

Turns turnsOf(const Streams& streams, const HandEyeSettings& settings, const Items& items, double shift) {
  std::vector<SO3> rotations;
  for (const RowPair& item : items) {
    const SO3 from = streams.at(streams.rows[item.from], shift).hand.orient;
    rotations.push_back(
        settings.drifting ? from.inverse() * streams.at(streams.rows[item.to], shift).hand.orient : from);
  }
  const SO3 mean = settings.drifting ? SO3() : averaged(rotations);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(3, 3);
  for (const SO3& rotation : rotations) {
    const Eigen::Vector3d turn = SO3::log(mean.inverse() * rotation);
    sum += turn * turn.transpose() / double(rotations.size());
  }
  const SymmetricEigen eigen = eigenOf(sum);
  const Eigen::Vector3d deg = eigen.eigenvalues().cwiseMax(0).cwiseSqrt().reverse() * degrees_per_radian;
  return {deg, eigen.eigenvectors().rowwise().reverse()};
}

namespace {

std::string axisText(Eigen::Vector3d axis) {
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  if (axis[largest] < 0) axis = -axis;
  for (double& x : axis) x = std::abs(x) < 5e-4 ? 0 : x;
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", axis[0], axis[1], axis[2]);
}

}  // namespace

std::string textOf(const FreeDirection& free, int same_kind, const Turns& turns) {
  constexpr const char* turn_it = "turn it by 20 degrees or more about";
  switch (free.kind) {
    case FreeDirection::Kind::translation:
      if (same_kind > 1)
        return fmt::format(
            "the translation of the camera is not determined, because the hand hardly turns ({:.1f} "
            "degrees); {} two axes",
            turns.deg[0], turn_it);
      return fmt::format(
          "the translation of the camera along {} of the hand is not determined, because the hand turns "
          "about {} only ({:.1f} degrees, {:.1f} about others); {} another axis, too",
          axisText(free.axis), axisText(turns.axes.col(0)), turns.deg[0], turns.deg[1], turn_it);
    case FreeDirection::Kind::rotation:
      return fmt::format(
          "the rotation of the camera about {} of the hand is not determined, because the hand neither "
          "turns about another axis nor moves across this one; {} another axis, too",
          axisText(free.axis), turn_it);
    case FreeDirection::Kind::time_offset:
      return "the time offset is not determined, because the hand moves too slowly or evenly; turn it to and fro";
    case FreeDirection::Kind::scale:
      break;
  }
  return "the scale is not determined, because the camera hardly moves; move it farther";
}

}  // namespace slom::calibration
