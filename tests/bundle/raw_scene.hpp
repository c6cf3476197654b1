// Scenes as plain numbers with their meaning, written without the project's code.
#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace slom::app::bundle::testing {

using RawCamera = std::array<double, 9>;  ///< rotation vector, translation, f, k1, k2
using RawPoint = std::array<double, 3>;
struct RawObservation {
  int camera, point;
  double u, v;
};
struct RawScene {
  std::vector<RawCamera> cameras;
  std::vector<RawPoint> points;
  std::vector<RawObservation> observations;
};

/// Rodrigues' formula: R x = x cos a + (k cross x) sin a + k (k . x) (1 - cos a) with the axis k and the
/// angle a.
inline Eigen::Vector3d rotated(const Eigen::Vector3d& axis_angle, const Eigen::Vector3d& x) {
  const double angle = axis_angle.norm();
  if (angle == 0) return x;
  const Eigen::Vector3d k = axis_angle / angle;
  return x * std::cos(angle) + k.cross(x) * std::sin(angle) + k * k.dot(x) * (1 - std::cos(angle));
}

inline std::array<double, 2> pixelOf(const RawCamera& c, const RawPoint& X) {
  const Eigen::Vector3d P =
      rotated({c[0], c[1], c[2]}, {X[0], X[1], X[2]}) + Eigen::Vector3d(c[3], c[4], c[5]);
  const double px = -P[0] / P[2], py = -P[1] / P[2], r2 = px * px + py * py;
  const double scale = c[6] * (1 + c[7] * r2 + c[8] * r2 * r2);
  return {scale * px, scale * py};
}

/// Squared distance between prediction and observation.
inline double squaredError(const RawScene& scene, const RawObservation& o) {
  const auto pixel = pixelOf(scene.cameras[std::size_t(o.camera)], scene.points[std::size_t(o.point)]);
  return std::pow(pixel[0] - o.u, 2) + std::pow(pixel[1] - o.v, 2);
}
inline double sumOfSquares(const RawScene& scene) {
  double sum = 0;
  for (const RawObservation& o : scene.observations) sum += squaredError(scene, o);
  return sum;
}

/// A BAL file, numbers with all digits.
inline std::string contentOf(const RawScene& scene) {
  char text[200];
  std::string content;
  const auto add = [&](auto... arguments) {
    std::snprintf(text, sizeof text, arguments...);
    content += text;
  };
  add("%zu %zu %zu\n", scene.cameras.size(), scene.points.size(), scene.observations.size());
  for (const auto& o : scene.observations) add("%d %d %.17g %.17g\n", o.camera, o.point, o.u, o.v);
  for (const auto& camera : scene.cameras) {
    for (const double x : camera) add("%.17g\n", x);
  }
  for (const auto& point : scene.points) {
    for (const double x : point) add("%.17g\n", x);
  }
  return content;
}

inline RawScene sceneOf(const std::string& content) {
  std::istringstream stream(content);
  std::size_t cameras = 0, points = 0, observations = 0;
  stream >> cameras >> points >> observations;
  RawScene scene{std::vector<RawCamera>(cameras), std::vector<RawPoint>(points),
                 std::vector<RawObservation>(observations)};
  for (auto& o : scene.observations) stream >> o.camera >> o.point >> o.u >> o.v;
  for (auto& camera : scene.cameras) {
    for (double& x : camera) stream >> x;
  }
  for (auto& point : scene.points) {
    for (double& x : point) stream >> x;
  }
  return scene;
}

class Noise {
 public:
  explicit Noise(std::uint64_t seed) : random_(seed) {}
  double operator()(double sigma) { return sigma * normal_(random_); }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

/// Returns cameras on an arc, 6 units from points around the origin. All cameras see all points, with errors of `sigma`
/// px.
inline RawScene simulated(int cameras, int points, double sigma, std::uint64_t seed) {
  Noise noise(seed);
  RawScene scene;
  for (int i = 0; i < cameras; ++i) {
    const double angle = 1.5 * i / cameras - 0.75;
    scene.cameras.push_back({0.1, angle, noise(0.05), noise(0.3), noise(0.3), -6 + noise(0.3),
                             500 + noise(50), -0.1 + noise(0.02), 0.02 + noise(0.005)});
  }
  for (int i = 0; i < points; ++i) scene.points.push_back({noise(0.8), noise(0.8), noise(0.8)});
  for (int p = 0; p < points; ++p) {
    for (int c = 0; c < cameras; ++c) {
      const auto pixel = pixelOf(scene.cameras[std::size_t(c)], scene.points[std::size_t(p)]);
      scene.observations.push_back({c, p, pixel[0] + noise(sigma), pixel[1] + noise(sigma)});
    }
  }
  return scene;
}

/// The same observations, other start values.
inline RawScene perturbed(RawScene scene, double size, std::uint64_t seed) {
  Noise noise(seed);
  for (auto& c : scene.cameras) {
    for (int k = 0; k < 6; ++k) c[std::size_t(k)] += noise(size);
    c[6] *= 1 + noise(size);
    c[7] += noise(size);
    c[8] += noise(size);
  }
  for (auto& point : scene.points) {
    for (double& x : point) x += noise(size);
  }
  return scene;
}

}  // namespace slom::app::bundle::testing
