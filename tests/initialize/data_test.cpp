// Landmark SLAM on public data, from odometry: Victoria Park.
#include <filesystem>

#include <gtest/gtest.h>

#include <slom/initialize.hpp>

#include "initialize/landmark_files.hpp"
#include "support/paths.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace slom::testing {
namespace {

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
  for (const auto& pose : map.poses) poses.push_back(est.insertRV(pose.value, !pose.fixed));
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
