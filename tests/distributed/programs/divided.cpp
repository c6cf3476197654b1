// Which process has what of a file.
//   divided graph|bundle FILE   prints for each process the ids of its own poses or cameras, then the number of shared ones
#include <cstdio>
#include <iostream>
#include <string>
#include <variant>
#include <vector>

#include <slom/distributed.hpp>

namespace {

using slom::distributed::Processes;

int run(const std::string& kind, const std::string& file) {
  const slom::distributed::Session session;
  const Processes processes;
  std::string own = "own";
  int foreign = 0;  // copies of what belongs to other processes
  const auto count = [&](std::uint64_t id, bool is_own) {
    if (is_own) {
      own += " " + std::to_string(id);
    } else {
      ++foreign;
    }
  };
  if (kind == "graph") {
    const auto part = slom::distributed::readPoseGraph(processes, file);
    std::visit(
        [&](const auto& graph) {
          for (std::size_t i = 0; i < graph.graph.poses.size(); ++i)
            count(graph.graph.poses[i].id, graph.own_poses[i] != 0);
        },
        part);
  } else {
    const auto part = slom::distributed::readScene(processes, file);
    for (std::size_t i = 0; i < part.cameras.size(); ++i)
      count(std::uint64_t(part.cameras[i]), part.own_cameras[i] != 0);
  }
  const double copies = processes.sum(foreign);
  std::string all;
  for (const std::string& text : processes.gather(own)) all += text + "\n";
  if (processes.rank() == 0) std::printf("%scopies %.0f\n", all.c_str(), copies);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    return run(argv[1], argv[2]);
  } catch (const slom::Error& error) {
    std::cerr << error.what() << '\n';
    return 3;
  }
}
