// Landmark SLAM on public data, from odometry: Victoria Park.
#include <fstream>
#include <map>
#include <sstream>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <slom/initialize.hpp>

#include "initialize/maps.hpp"
#include "support/paths.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace slom::testing {
namespace {

template <int N>
Eigen::Matrix<double, N, N> readCovariance(std::istream& stream) {
  Eigen::Matrix<double, N, N> C;
  for (int i = 0; i < N; ++i) {
    for (int j = i; j < N; ++j) {
      stream >> C(i, j);
      C(j, i) = C(i, j);
    }
  }
  return C;
}

Map<Pose2> readVictoriaPark(const std::string& file) {
  Map<Pose2> map;
  std::map<int, int> pose_of, landmark_of;
  const auto pose = [&](int id) {
    const auto [it, is_new] = pose_of.try_emplace(id, int(map.poses.size()));
    if (is_new) map.addPose(Pose2(), map.poses.empty());
    return it->second;
  };
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string tag;
    int i = 0, j = 0;
    double x = 0, y = 0, angle = 0;
    words >> tag >> i >> j >> x >> y;
    const int from = pose(i);
    if (tag == "ODOMETRY") {
      words >> angle;
      const int to = pose(j);
      map.addEdge(from, to, Pose2(mtk::SO2<>(angle), mtk::vect<2>(x, y)), readCovariance<3>(words).inverse());
    } else {
      const auto [it, is_new] = landmark_of.try_emplace(j, int(map.landmarks.size()));
      if (is_new) map.addLandmark();
      map.addSighting(from, it->second, mtk::vect<2>(x, y), readCovariance<2>(words).inverse());
    }
  }
  return map;
}

TEST(VictoriaPark, IsBuiltUpToItsMinimum) {
  SLOM_SKIP_WITH_SANITIZERS();
  const auto file = sharedDataPath("landmark/victoria_park.txt");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "needs " << file;
  auto map = readVictoriaPark(file.string());
  const initialize::Choice choice = initialize::findBestStart(map);
  EXPECT_EQ(choice.start, initialize::Start::build_up);

  Estimator est;
  const initialize::RelationModel model;
  std::vector<VarID<Pose2>> poses;
  std::vector<VarID<mtk::vect<2>>> landmarks;
  for (const auto& pose : map.poses) poses.push_back(est.insertRV(pose.value, !pose.held));
  for (const auto& landmark : map.landmarks) landmarks.push_back(est.insertRV(landmark.value));
  for (const auto& e : map.edges)
    model.insertEdge(est, poses[std::size_t(e.from)], poses[std::size_t(e.to)], e);
  for (const auto& s : map.sightings)
    model.insertSighting(est, poses[std::size_t(s.from)], landmarks[std::size_t(s.to)], s);
  const Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged);
  EXPECT_LE(summary.iterations, 10);
  EXPECT_NEAR(summary.final_rss, 6184.12, 0.01);
  EXPECT_NEAR(summary.chi2PerDof(), 0.886, 0.001);
}

}  // namespace
}  // namespace slom::testing
