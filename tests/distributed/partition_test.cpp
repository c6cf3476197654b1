// The division of files among processes: few copies, equal parts, and the same in each run.
#include <algorithm>
#include <numeric>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "distributed/mpirun.hpp"

namespace slom::testing {
namespace {

/// The output of the program `divided`.
struct Divided {
  std::string text;
  std::vector<std::vector<int>> own;  ///< by process: ids of its own poses or cameras
  int copies = -1;                    ///< of poses or cameras in processes that do not own them
};

Divided divided(int processes, const std::string& kind, const std::string& file) {
  const CommandResult result = runCommand(mpirun(processes, {SLOM_DIVIDED, kind, file}));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  Divided divided{result.output, {}, -1};
  std::istringstream lines(result.output);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    int number = 0;
    if (word == "copies") {
      words >> divided.copies;
    } else if (word == "own") {
      auto& own = divided.own.emplace_back();
      while (words >> number) own.push_back(number);
    }
  }
  return divided;
}

std::vector<int> shuffled(int count) {
  std::vector<int> ids(static_cast<std::size_t>(count));
  std::iota(ids.begin(), ids.end(), 0);
  std::shuffle(ids.begin(), ids.end(), std::mt19937(3));
  return ids;
}

/// Expects that each id has one owner, and that the parts differ by `most` at most.
void expectParts(const Divided& divided, int processes, int count, int most) {
  ASSERT_EQ(int(divided.own.size()), processes) << divided.text;
  std::multiset<int> all;
  std::size_t largest = 0, smallest = std::size_t(count);
  for (const auto& own : divided.own) {
    all.insert(own.begin(), own.end());
    largest = std::max(largest, own.size());
    smallest = std::min(smallest, own.size());
  }
  EXPECT_EQ(int(all.size()), count);
  EXPECT_EQ(int(std::set<int>(all.begin(), all.end()).size()), count);
  EXPECT_LE(int(largest - smallest), most);
}

/// Returns a square grid of n x n poses whose ids are in no order.
std::string grid(int n) {
  const std::vector<int> ids = shuffled(n * n);
  std::string text;
  for (int i = 0; i < n * n; ++i)
    text += fmt::format("VERTEX_SE2 {} {} {} 0\n", ids[std::size_t(i)], i % n, i / n);
  const auto edge = [&](int a, int b) {
    text += fmt::format("EDGE_SE2 {} {} {} {} 0 1 0 0 1 0 1\n", ids[std::size_t(a)], ids[std::size_t(b)],
                        b == a + 1 ? 1 : 0, b == a + 1 ? 0 : 1);
  };
  for (int i = 0; i < n * n; ++i) {
    if (i % n + 1 < n) edge(i, i + 1);
    if (i / n + 1 < n) edge(i, i + n);
  }
  return text;
}

TEST(Partition, OfAGridCutsItAlongShortLines) {
  constexpr int n = 20;
  const TemporaryFolder folder;
  const std::string file = (folder / "grid.g2o").string();
  writeFile(file, grid(n));
  for (const int processes : {2, 4}) {
    const Divided first = divided(processes, "graph", file);
    expectParts(first, processes, n * n, n * n / 10);
    // Straight cuts copy n or 2 n poses. Ranges of ids copy some 300.
    EXPECT_LE(first.copies, (processes == 2 ? 1 : 2) * 3 * n / 2);
    EXPECT_EQ(divided(processes, "graph", file).text, first.text);
  }
}

TEST(Partition, OfAChainOfCamerasKeepsNeighboursTogether) {
  constexpr int cameras = 40, points = 400, views = 3;
  const std::vector<int> number = shuffled(cameras);
  std::string text = fmt::format("{} {} {}\n", cameras, points, points * views);
  for (int p = 0; p < points; ++p) {
    for (int v = 0; v < views; ++v)
      text += fmt::format("{} {} 0 0\n", number[std::size_t(p * (cameras - views + 1) / points + v)], p);
  }
  for (int i = 0; i < cameras; ++i) text += "0\n0\n0\n0\n0\n0\n500\n0\n0\n";
  for (int p = 0; p < points; ++p) text += "0\n0\n-5\n";
  const TemporaryFolder folder;
  const std::string file = (folder / "chain.txt").string();
  writeFile(file, text);
  const Divided first = divided(3, "bundle", file);
  expectParts(first, 3, cameras, 8);
  EXPECT_LE(first.copies, 12);  // two cuts, where a point sees two cameras of the other side at most
  EXPECT_EQ(divided(3, "bundle", file).text, first.text);
}

TEST(Partition, OfFewPosesLeavesProcessesEmpty) {
  const TemporaryFolder folder;
  const std::string file = (folder / "few.g2o").string();
  writeFile(file, grid(2));
  expectParts(divided(7, "graph", file), 7, 4, 4);
  const CommandResult fit = runSlom(7, {"graph", file, "--init", "file", "--solver", "cg", "--quiet"});
  EXPECT_EQ(fit.exit_code, 0) << fit.errors;
}

}  // namespace
}  // namespace slom::testing
