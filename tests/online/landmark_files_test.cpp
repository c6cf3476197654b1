// Online landmark SLAM on public data: after each pose the optimum of the batch fit.
#include "initialize/landmark_files.hpp"

#include <gtest/gtest.h>

#include <slom/initialize/growing_map.hpp>
#include <slom/slom.hpp>

#include "support/paths.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace slom::testing {
namespace {

/// Feeds the map pose by pose. Each update must converge, and every `compared`th one is compared with the batch fit.
/// Returns the final RSS.
double feed(const Map<Pose2>& graph, int compared) {
  Estimator est;
  initialize::GrowingMap<Map<Pose2>> map(est, graph);
  const int poses = int(graph.poses.size());
  int by_optimize = 0;
  for (int p = 0; p < poses; ++p) {
    map.add(p);
    const UpdateSummary summary = est.update();
    EXPECT_TRUE(summary.converged) << "pose " << p << ": " << summary;
    by_optimize += summary.used_optimize ? 1 : 0;
    if ((p + 1) % compared != 0 && p + 1 != poses) continue;
    Estimator batch;
    map.copyTo(batch);
    const double rss = batch.optimize().final_rss;
    EXPECT_LE(est.getRSS(), rss * (1 + 2e-6) + 1e-6) << "pose " << p;
  }
  EXPECT_EQ(by_optimize, 0);
  return est.getRSS();
}

TEST(OnlineLandmarks, VictoriaParkIsAtItsOptimumAfterEachPose) {
  SLOM_SKIP_WITH_SANITIZERS();
  SLOM_SKIP_WITHOUT_SHARED_DATA("landmark/victoria_park.txt");
  const auto file = sharedDataPath("landmark/victoria_park.txt");
  EXPECT_NEAR(feed(readVictoriaPark(file.string()), 1000), 6184.12, 0.01);
}

TEST(OnlineLandmarks, DlrIsAtItsOptimumAfterEachPose) {
  SLOM_SKIP_WITH_SANITIZERS();
  SLOM_SKIP_WITHOUT_SHARED_DATA("landmark/dlr_map.circles");
  const auto file = sharedDataPath("landmark/dlr_map.circles");
  const Map<Pose2> graph = readDlr(file.string());
  ASSERT_EQ(graph.poses.size(), 3298u);
  ASSERT_EQ(graph.landmarks.size(), 576u);
  ASSERT_EQ(graph.sightings.size(), 14309u);
  EXPECT_NEAR(feed(graph, 1000), 56860.36, 0.06);
}

}  // namespace
}  // namespace slom::testing
