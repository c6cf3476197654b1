// Writes a pose graph, reads it, fits it and reads the written result: the consumer's program for slom::io.
#include <cstdio>
#include <fstream>
#include <string>
#include <variant>

#include <slom/io.hpp>

int main() {
  std::ofstream("square.g2o")
      << "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1.1 0 1.5\nVERTEX_SE2 2 0.9 1.1 3\nFIX 0\n"
         "EDGE_SE2 0 1 1 0 1.5707963 1 0 0 1 0 1\nEDGE_SE2 1 2 1 0 1.5707963 1 0 0 1 0 1\n"
         "EDGE_SE2 0 2 1 1 3.1415926 2 1 0 3 0 1\n";
  using Graph = slom::io::PoseGraph<slom::io::Pose2>;
  auto graph = std::get<Graph>(slom::io::readPoseGraph("square.g2o"));
  slom::Estimator est;
  const auto ids = slom::io::insert(est, graph);
  const slom::Summary summary = est.optimize();
  ids.writeTo(graph);
  std::ofstream("fitted.g2o") << slom::io::toG2o(graph);
  const auto again = std::get<Graph>(slom::io::readPoseGraph("fitted.g2o"));
  const double error = (again.poses[2].value.pos - mtk::vect<2>(1, 1)).norm();
  std::printf("converged %d, RSS %g, error %g\n", summary.converged, summary.final_rss, error);

  std::string refusal;
  try {
    slom::io::readPoseGraph("nowhere.g2o");
  } catch (const mtk::Error& error) {
    refusal = error.id();
  }
  return summary.converged && error < 1e-6 && refusal == "slom.io.cannot-read" ? 0 : 1;
}
