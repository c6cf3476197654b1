#include "calibration/hand_eye/start.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibration/hand_eye/robust_alignment.hpp"
#include "calibration/median.hpp"
#include "calibration/symmetric.hpp"

namespace slom::calibration {
namespace {

/// A motion: A of the hand, B of the camera, A X = X B.
struct Motion {
  SE3 A, B;
};

BothPoses posesOf(const Streams& streams, std::size_t row, double shift, const PoseReadings& readings) {
  const BothPoses both = streams.at(streams.rows[row], shift);
  return {readings.hand(both.hand), readings.camera(both.camera)};
}

/// Returns some of the rows, spread evenly.
std::vector<BothPoses> posesAt(const Streams& streams, double shift, const PoseReadings& readings) {
  constexpr std::size_t most = 1000;
  const std::vector<std::size_t> rows = streams.covered(shift);
  const std::size_t step = std::max<std::size_t>(1, rows.size() / most);
  std::vector<BothPoses> poses;
  for (std::size_t i = 0; i < rows.size(); i += step)
    poses.push_back(posesOf(streams, rows[i], shift, readings));
  return poses;
}

Motion motionOf(const BothPoses& a, const BothPoses& b) {
  return {a.hand.inverse() * b.hand, a.camera.inverse() * b.camera};
}

/// Returns motions between poses far from each other or, if a stream drifts, over the length of a motion.
std::vector<Motion> motionsAt(const Streams& streams, double shift, const HandEyeSettings& settings,
                              const PoseReadings& readings) {
  std::vector<Motion> motions;
  if (settings.drifting) {
    for (const RowPair& pair : motionsOver(streams, streams.covered(shift), settings.motion_s))
      motions.push_back(
          motionOf(posesOf(streams, pair.from, shift, readings), posesOf(streams, pair.to, shift, readings)));
    return motions;
  }
  const std::vector<BothPoses> poses = posesAt(streams, shift, readings);
  std::vector<std::size_t> distances;
  for (const std::size_t divisor : {2, 3, 5, 11})
    distances.push_back(std::max<std::size_t>(1, poses.size() / divisor));
  distances.erase(std::unique(distances.begin(), distances.end()), distances.end());
  for (const std::size_t distance : distances) {
    for (std::size_t i = 0; i + distance < poses.size(); ++i)
      motions.push_back(motionOf(poses[i], poses[i + distance]));
  }
  return motions;
}

/// Returns rotation vectors of motions; turns of nearly 180 degrees, whose sign is uncertain, are left out.
std::vector<VectorPair> turnsOf(const std::vector<Motion>& motions) {
  constexpr double longest = 2.9;
  std::vector<VectorPair> pairs;
  for (const Motion& motion : motions) {
    const vec3 a = SO3::log(motion.A.orient), b = SO3::log(motion.B.orient);
    if (a.norm() < longest && b.norm() < longest) pairs.push_back({a, b});
  }
  return pairs;
}

double medianLength(const std::vector<VectorPair>& pairs) {
  std::vector<double> lengths;
  for (const VectorPair& pair : pairs) lengths.push_back(pair.first.norm());
  return medianOf(std::move(lengths));
}

/// Linear equations M z = y with three rows for each pose or motion, z = (t_X, t_Y, scale).
struct Equations {
  std::vector<Eigen::Matrix<double, 3, 7>> M;
  std::vector<Eigen::Vector3d> y;
};

/// Solves by weights 1 / distance. What the equations leave open is 0, the scale 1. Returns the median distance.
double solve(const Equations& equations, bool has_scale, bool has_target, Eigen::Matrix<double, 7, 1>& z) {
  std::vector<double> distances(equations.M.size(), 1);
  for (int round = 0; round < 20; ++round) {
    const double least = std::max(0.3 * medianOf(distances), 1e-12);
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(7, 7);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(7);
    for (std::size_t i = 0; i < equations.M.size(); ++i) {
      const double weight = least / std::max(distances[i], least);
      Eigen::Matrix<double, 3, 7> M = equations.M[i];
      const Eigen::Vector3d y = equations.y[i] - M.col(6);  // z counts from a scale of 1
      if (!has_scale) M.col(6).setZero();
      if (!has_target) M.middleCols<3>(3).setZero();
      H += weight * M.transpose() * M;
      g += weight * M.transpose() * y;
    }
    const SymmetricEigen eigen = eigenOf(H);
    const double most = eigen.eigenvalues().maxCoeff();
    z.setZero();
    for (int k = 0; k < 7; ++k) {
      if (eigen.eigenvalues()[k] > 1e-7 * most)
        z += eigen.eigenvectors().col(k) * (eigen.eigenvectors().col(k).dot(g) / eigen.eigenvalues()[k]);
    }
    z[6] += 1;
    for (std::size_t i = 0; i < equations.M.size(); ++i)
      distances[i] = (equations.M[i] * z - equations.y[i]).norm();
  }
  return medianOf(std::move(distances));
}

/// Completes values whose rotation of X is known. Returns the median misfit of positions.
double complete(const std::vector<BothPoses>& poses, const std::vector<Motion>& motions,
                const HandEyeSettings& settings, HandEyeValues& values) {
  const SO3 X = values.hand_T_camera.orient;
  Equations equations;
  if (settings.drifting) {
    for (const Motion& motion : motions) {
      auto& M = equations.M.emplace_back(Eigen::Matrix<double, 3, 7>::Zero());
      M.leftCols<3>() = motion.A.orient.toRotationMatrix() - Eigen::Matrix3d::Identity();
      M.col(6) = -Eigen::Vector3d(X * motion.B.pos);
      equations.y.emplace_back(-motion.A.pos);
    }
  } else {
    std::vector<SO3> targets;
    for (const BothPoses& both : poses)
      targets.push_back(both.hand.orient * X * both.camera.orient.inverse());
    values.base_T_target.orient = averaged(targets);
    for (const BothPoses& both : poses) {
      auto& M = equations.M.emplace_back(Eigen::Matrix<double, 3, 7>::Zero());
      M.leftCols<3>() = both.hand.orient.toRotationMatrix();
      M.middleCols<3>(3) = -Eigen::Matrix3d::Identity();
      M.col(6) = -Eigen::Vector3d(values.base_T_target.orient * both.camera.pos);
      equations.y.emplace_back(-both.hand.pos);
    }
  }
  Eigen::Matrix<double, 7, 1> z;
  const double misfit = solve(equations, settings.estimate_scale, !settings.drifting, z);
  values.hand_T_camera.pos = vec3(z[0], z[1], z[2]);
  values.base_T_target.pos = vec3(z[3], z[4], z[5]);
  values.scale = z[6] > 0 ? z[6] : 1;
  return misfit;
}

/// Returns rotations of X worth trying: that of the turns; if they all have one axis, turned about it; if there are
/// none, that of the displacements.
std::vector<SO3> rotationsOf(const std::vector<Motion>& motions, const Alignment& turns, double turn_rad) {
  constexpr double buried = 3;  // times the misfit: turns below are noise
  Alignment best = turns;
  if (turn_rad < buried * turns.misfit || turn_rad < 1e-9) {
    std::vector<VectorPair> moves;
    for (const Motion& motion : motions) moves.push_back({motion.A.pos, motion.B.pos});
    best = aligned(moves);
  }
  std::vector<SO3> rotations{best.rotation};
  constexpr int turned = 12;
  for (int k = 1; best.is_turn_free && k < turned; ++k) {
    const double angle = 2 * std::numbers::pi * k / turned;
    rotations.push_back(SO3::exp(vec3(angle * best.axis)) * best.rotation);
  }
  return rotations;
}

}  // namespace

SE3 PoseReading::operator()(const SE3& pose) const {
  SE3 result = pose;
  if (has_w_first) {  // in the file, so before an inversion
    SE3 given = is_inverted ? pose.inverse() : pose;
    const SO3& q = given.orient;
    given.orient = SO3(q.x(), q.y(), q.z(), q.w());
    result = is_inverted ? given.inverse() : given;
  }
  return is_inverse ? result.inverse() : result;
}

HandEyeStart startAt(const Streams& streams, double shift, const HandEyeSettings& settings,
                     const PoseReadings& readings) {
  const std::vector<BothPoses> poses = posesAt(streams, shift, readings);
  const std::vector<Motion> motions = motionsAt(streams, shift, settings, readings);
  const std::vector<VectorPair> turns = turnsOf(motions);
  HandEyeStart best;
  best.rows = int(poses.size());
  best.alike_shift = shift;
  if (turns.empty()) return best;
  const Alignment alignment = aligned(turns);
  best.misfit_rad = alignment.misfit;
  best.turn_rad = medianLength(turns);
  bool is_first = true;
  for (const SO3& rotation : rotationsOf(motions, alignment, best.turn_rad)) {
    HandEyeValues values;
    values.shift = shift;
    values.hand_T_camera.orient = rotation;
    const double misfit = complete(poses, motions, settings, values);
    if (!is_first && misfit >= best.misfit_m) continue;
    best.values = values;
    best.misfit_m = misfit;
    is_first = false;
  }
  return best;
}

}  // namespace slom::calibration
