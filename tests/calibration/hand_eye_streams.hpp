#pragma once
// Simulated streams of a hand and a camera on it, with known truth.

#include <cmath>
#include <random>
#include <vector>

#include <slom/calibration/hand_eye.hpp>

namespace slom::testing {

using calibration::PoseStream;
using calibration::SE3;
using calibration::SO3;
using calibration::vec3;

/// How the hand moves.
enum class HandMotion {
  free,         ///< turns about all axes, moves along all axes
  one_axis,     ///< turns about z alone, moves in all directions
  one_screw,    ///< turns about a fixed axis, as a turntable
  translation,  ///< moves without turning
  rest,         ///< does not move
};

struct SimulatedHand {
  HandMotion motion = HandMotion::free;
  double seconds = 20, hand_rate = 100, camera_rate = 20;
  double noise_m = 0.005, noise_rad = 0.005;  ///< of the camera
  double hand_noise_m = 0, hand_noise_rad = 0;
  double offset = 0.123;              ///< t_hand - t_camera, of the stamps
  double epoch = 0;                   ///< of the hand; the camera's is 0
  double scale = 1;                   ///< true length / length in the stream of the camera
  double outliers = 0;                ///< fraction of the rows of the camera
  double drift_m = 0, drift_rad = 0;  ///< of the target, standard deviation over a second
  unsigned seed = 1;

  SE3 hand_T_camera{SO3::exp(vec3(0.4, -1.1, 0.7)), vec3(0.05, -0.12, 0.08)};
  SE3 base_T_target{SO3::exp(vec3(-0.3, 0.2, 2.1)), vec3(1.1, -0.4, 0.3)};
};

/// The pose of the hand in the base at a time of its clock.
inline SE3 handAt(const SimulatedHand& truth, double t) {
  const vec3 turn(0.5 * std::sin(1.1 * t) + 0.2 * std::sin(2.7 * t + 1),
                  0.4 * std::sin(0.9 * t + 2) + 0.2 * std::sin(2.3 * t),
                  0.6 * std::sin(0.7 * t + 1) + 0.2 * std::sin(3.1 * t + 0.5));
  const vec3 move(0.3 * std::sin(0.8 * t), 0.25 * std::sin(1.3 * t + 1), 0.2 * std::sin(1.7 * t + 2));
  const SO3 start = SO3::exp(vec3(0.3, 0.9, -0.4));
  switch (truth.motion) {
    case HandMotion::free:
      return {start * SO3::exp(turn), move};
    case HandMotion::one_axis:
      return {start * SO3::exp(vec3(0., 0., turn[2])), move};
    case HandMotion::one_screw:
      return {start * SO3::exp(vec3(0., 0., turn[2])), vec3(0.2, 0.1, 0.5)};
    case HandMotion::translation:
      return {start, move};
    case HandMotion::rest:
      break;
  }
  return {start, vec3(0.2, 0.1, 0.5)};
}

/// A pose with errors along the axes of the moving frame.
inline SE3 disturbed(const SE3& pose, double noise_m, double noise_rad, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto vector = [&](double size) {
    const double x = normal(random), y = normal(random), z = normal(random);
    return vec3(size * x, size * y, size * z);
  };
  const vec3 turn = vector(noise_rad), move = vector(noise_m);
  return {pose.orient * SO3::exp(turn), vec3(pose.pos + pose.orient * move)};
}

struct SimulatedStreams {
  PoseStream hand, camera;
  std::vector<std::size_t> outliers;  ///< rows of the camera
};

inline SimulatedStreams simulated(const SimulatedHand& truth) {
  std::mt19937 random(truth.seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  SimulatedStreams streams;
  streams.hand.file = "hand.csv";
  streams.camera.file = "camera.csv";
  for (int i = 0; i < int(truth.seconds * truth.hand_rate); ++i) {
    const double t = i / truth.hand_rate;
    streams.hand.poses.push_back(
        {t + truth.epoch, disturbed(handAt(truth, t), truth.hand_noise_m, truth.hand_noise_rad, random),
         i + 2});
  }
  SE3 base_T_target = truth.base_T_target;
  for (int i = 0; i < int(truth.seconds * truth.camera_rate); ++i) {
    const double t = i / truth.camera_rate + 0.003 * uniform(random);  // on the clock of the camera
    SE3 pose = base_T_target.inverse() * handAt(truth, t + truth.offset) * truth.hand_T_camera;
    pose = disturbed(pose, truth.noise_m, truth.noise_rad, random);
    if (uniform(random) < truth.outliers) {
      pose = disturbed(pose, 0.3, 0.5, random);
      streams.outliers.push_back(std::size_t(i));
    }
    pose.pos = pose.pos / truth.scale;
    streams.camera.poses.push_back({t, pose, i + 2});
    const double root = 1 / std::sqrt(truth.camera_rate);
    base_T_target = disturbed(base_T_target, truth.drift_m * root, truth.drift_rad * root, random);
  }
  return streams;
}

}  // namespace slom::testing
