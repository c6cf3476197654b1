// Information matrices that are not positive definite.
#include "graph/information.hpp"

#include "graph/graph_command.hpp"

namespace slom::app::graph {
namespace {

using testing::parsed;

TEST(GraphInformation, NearestInformation) {
  auto graph = parsed<Pose2>("EDGE_SE2 0 1 1 0 0 1 2 0 1 0 1\nEDGE_SE2 0 1 1 0 0 2 1 0 2 0 1\n");
  const Symmetric<3> good = graph.edges[1].information;
  EXPECT_EQ(checkInformation(graph, true), 1);
  EXPECT_EQ(graph.edges[1].information, good);
  Eigen::Matrix3d nearest;
  nearest << 1.5, 1.5, 0, 1.5, 1.5, 0, 0, 0, 1;
  EXPECT_TRUE(graph.edges[0].information.isApprox(nearest, 1e-11)) << graph.edges[0].information;
  EXPECT_EQ(checkInformation(graph, false), 0);
}

}  // namespace
}  // namespace slom::app::graph
