// Pose graphs written in TORO's format.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include <slom/io/g2o.hpp>

#include "io/parsed_graph.hpp"
#include "io/simulated_graph.hpp"
#include "support/message_of.hpp"

namespace slom::io::testing {
namespace {

template <class Pose>
PoseGraph<Pose> withoutLandmarks() {
  PoseGraph<Pose> graph = simulateGraph<Pose>(9, 0.1, 1);
  graph.landmarks.clear();
  graph.sightings.clear();
  return graph;
}

template <class Pose>
void expectSameAfterToro(const PoseGraph<Pose>& graph) {
  const auto again = parsed<Pose>(toToro(graph));
  ASSERT_EQ(again.poses.size(), graph.poses.size());
  ASSERT_EQ(again.edges.size(), graph.edges.size());
  for (std::size_t i = 0; i < graph.poses.size(); ++i) {
    EXPECT_EQ(again.poses[i].id, graph.poses[i].id);
    EXPECT_EQ(again.poses[i].fixed, graph.poses[i].fixed);
    EXPECT_LT(mtk::difference(again.poses[i].value, graph.poses[i].value).norm(), 2e-15);
  }
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    EXPECT_EQ(again.edges[i].from, graph.edges[i].from);
    EXPECT_EQ(again.edges[i].to, graph.edges[i].to);
    EXPECT_EQ(again.edges[i].information, graph.edges[i].information);
    EXPECT_LT(mtk::difference(again.edges[i].measured, graph.edges[i].measured).norm(), 2e-15);
  }
}

TEST(Toro, WhatWasWrittenInThePlane) { expectSameAfterToro(withoutLandmarks<Pose2>()); }
TEST(Toro, WhatWasWrittenInSpace) { expectSameAfterToro(withoutLandmarks<Pose3>()); }

/// Rotations for which yaw and roll turn about one axis, and rotations near them.
TEST(Toro, RotationsAtAPitchOfARightAngle) {
  using SO3 = mtk::SO3<>;
  using vec3 = mtk::vect<3>;
  for (const double pitch : {M_PI / 2, -M_PI / 2}) {
    for (const double off : {0.0, 1e-16, 1e-12, 1e-8, 1e-4}) {
      auto graph = withoutLandmarks<Pose3>();
      graph.poses[3].value.orient = SO3::exp(vec3(0, 0, 0.7)) * SO3::exp(vec3(0, pitch + off, 0)) *
                                    SO3::exp(vec3(-2.1, 0, 0)) * SO3::exp(vec3(off, -off, off));
      expectSameAfterToro(graph);
    }
  }
}

TEST(Toro, TheWrittenTags) {
  PoseGraph<Pose2> graph;
  graph.has_vertices = true;
  graph.poses.push_back({3, Pose2(mtk::SO2<>(0.5), mtk::vect<2>(1, 2)), 0, true});
  graph.poses.push_back({4, Pose2(mtk::SO2<>(0), mtk::vect<2>(3, 4)), 0, false});
  Edge<Pose2> edge{0, 1, 0, Pose2(mtk::SO2<>(0.25), mtk::vect<2>(5, 6)), {}};
  edge.information << 1, 2, 3, 2, 4, 5, 3, 5, 6;
  graph.edges.push_back(edge);
  EXPECT_EQ(toToro(graph), "VERTEX2 3 1 2 0.5\nVERTEX2 4 3 4 0\nFIX 3\nEDGE2 3 4 5 6 0.25 1 2 4 6 3 5\n");
}

TEST(Toro, LandmarksAreRefused) {
  auto graph = simulateGraph<Pose2>(9, 0.1, 1);
  graph.file = "map.g2o";
  EXPECT_EQ(slom::testing::messageOf([&] { toToro(graph); }),
            "[slom.io.no-toro] map.g2o: TORO's format has no landmarks, and the graph has " +
                std::to_string(graph.landmarks.size()) + "; write it in g2o's");
}

}  // namespace
}  // namespace slom::io::testing
