#include "fit/generate_scene.hpp"

#include <algorithm>
#include <cmath>

#include <mtk/testing/random.hpp>

namespace slom::bench {

namespace {

using io::Camera;
using mtk::testing::Random;
using Vec3 = mtk::vect<3>;

constexpr int kViews = 5, kObservationsPerCamera = 1000, kFewestCameras = 9;
constexpr double kHeight = 3, kRelief = 0.5, kTilt = 0.1, kFocalLength = 1000, kPixelNoise = 0.5;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

Vec3 normalVector(Random& random, double sigma) {
  Vec3 v;
  for (int i = 0; i < 3; ++i) v[i] = sigma * random.normal();
  return v;
}

/// Returns a camera above the point (x, y) of the lattice.
Camera cameraAbove(double x, double y, Random& random) {
  Camera camera;
  camera.pose.orient = mtk::SO3<>::exp(normalVector(random, kTilt));
  camera.pose.pos = camera.pose.orient * Vec3(-x, -y, -kHeight);
  camera.lens = slom::SnavelyIntrinsics<>(
      mtk::vect<3>(kFocalLength * (1 + 0.05 * random.normal()), -0.05 + 0.01 * random.normal(), 0.01));
  return camera;
}

/// Returns the camera turned about its own centre, so that large scenes start as near to the solution as small ones.
Camera disturbed(const Camera& truth, Random& random) {
  const Vec3 centre = truth.pose.orient.inverse() * truth.pose.pos;
  Camera camera = truth;
  camera.pose.orient = truth.pose.orient * mtk::SO3<>::exp(normalVector(random, 0.01));
  camera.pose.pos = camera.pose.orient * centre + normalVector(random, 0.02);
  camera.lens =
      slom::SnavelyIntrinsics<>(mtk::vect<3>(truth.lens.f() * (1 + 0.01 * random.normal()),
                                             truth.lens.k1() + 0.01 * random.normal(), truth.lens.k2()));
  return camera;
}

/// Returns the cameras of a lattice of side x side that are nearest to a place, in ascending order.
std::vector<int> nearestCameras(double x, double y, int side) {
  struct Candidate {
    double distance;
    int camera;
  };
  constexpr int reach = 2;
  std::vector<Candidate> candidates;
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  for (int j = std::max(0, row - reach + 1); j <= std::min(side - 1, row + reach); ++j) {
    for (int i = std::max(0, column - reach + 1); i <= std::min(side - 1, column + reach); ++i) {
      candidates.push_back({std::hypot(i - x, j - y), j * side + i});
    }
  }
  std::sort(candidates.begin(), candidates.end(),
            [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
  candidates.resize(std::min(candidates.size(), std::size_t{kViews}));
  std::vector<int> cameras;
  for (const Candidate& candidate : candidates) cameras.push_back(candidate.camera);
  std::sort(cameras.begin(), cameras.end());
  return cameras;
}

}  // namespace

io::Scene generateScene(int size) {
  Random random(2, 0);
  const int side =
      static_cast<int>(std::lround(std::sqrt(std::max(size / kObservationsPerCamera, kFewestCameras))));
  const int points = size / kViews;
  io::Scene truth, scene;
  for (int c = 0; c < side * side; ++c) truth.cameras.push_back(cameraAbove(c % side, c / side, random));
  for (const Camera& camera : truth.cameras) scene.cameras.push_back(disturbed(camera, random));
  truth.points.reserve(at(points));
  scene.points.reserve(at(points));
  scene.observations.reserve(at(points * kViews));
  for (int p = 0; p < points; ++p) {
    const Vec3 point(random.uniform(0, side - 1), random.uniform(0, side - 1),
                     random.uniform(-kRelief, kRelief));
    truth.points.push_back(point);
    scene.points.push_back(Vec3(point + normalVector(random, 0.05)));
    for (const int c : nearestCameras(point[0], point[1], side)) {
      mtk::vect<2> pixel = io::CameraProjection()(truth.cameras[at(c)], point);
      for (int k = 0; k < 2; ++k) pixel[k] += kPixelNoise * random.normal();
      scene.observations.push_back({c, p, 0, pixel});
    }
  }
  return scene;
}

}  // namespace slom::bench
