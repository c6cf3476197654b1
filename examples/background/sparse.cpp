// Sparsity of the matrix, and the effect of the order of elimination.
#include <algorithm>
#include <set>
#include <vector>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>

#include "pages.hpp"
#include "plot.hpp"
#include "text.hpp"

namespace {

using Pose = mtk::trafo<mtk::SO2<>>;
using Pair = std::pair<int, int>;

/// A robot that drives 3 rounds: 36 poses. Each is linked with the next pose and with those of other rounds at the same
/// place.
constexpr int kPoses = 36, kRound = 12;

std::vector<Pair> links() {
  std::vector<Pair> result;
  for (int i = 0; i + 1 < kPoses; ++i) result.emplace_back(i, i + 1);
  for (int i = 0; i + kRound < kPoses; i += 2) result.emplace_back(i, i + kRound);
  return result;
}

/// Returns the neighbours of each variable: the blocks of H beside the diagonal.
std::vector<std::set<int>> neighbours(const std::vector<int>& place) {
  std::vector<std::set<int>> result(kPoses);
  for (const auto& [a, b] : links()) {
    const int i = place[std::size_t(a)], j = place[std::size_t(b)];
    result[std::size_t(i)].insert(j);
    result[std::size_t(j)].insert(i);
  }
  return result;
}

/// Returns the blocks of the factor. Eliminating a variable links its remaining neighbours with each other.
std::vector<Pair> factor(const std::vector<int>& place) {
  auto graph = neighbours(place);
  std::vector<Pair> blocks;
  for (int k = 0; k < kPoses; ++k) {
    const std::set<int> rest(graph[std::size_t(k)].upper_bound(k), graph[std::size_t(k)].end());
    for (const int i : rest) {
      blocks.emplace_back(i, k);
      graph[std::size_t(i)].insert(rest.begin(), rest.end());
      graph[std::size_t(i)].erase(i);
    }
  }
  return blocks;
}

/// Returns an order by minimum degree: next comes the variable with the fewest neighbours at that time.
std::vector<int> minimumDegree() {
  std::vector<int> natural(kPoses), place(kPoses, -1);
  for (int i = 0; i < kPoses; ++i) natural[std::size_t(i)] = i;
  auto graph = neighbours(natural);
  for (int next = 0; next < kPoses; ++next) {
    int best = -1;
    for (int i = 0; i < kPoses; ++i) {
      if (place[std::size_t(i)] < 0 &&
          (best < 0 || graph[std::size_t(i)].size() < graph[std::size_t(best)].size()))
        best = i;
    }
    place[std::size_t(best)] = next;
    const std::set<int> rest = graph[std::size_t(best)];
    for (const int i : rest) {
      graph[std::size_t(i)].insert(rest.begin(), rest.end());
      graph[std::size_t(i)].erase(i);
      graph[std::size_t(i)].erase(best);
    }
  }
  return place;
}

std::vector<int> naturalOrder() {
  std::vector<int> place(kPoses);
  for (int i = 0; i < kPoses; ++i) place[std::size_t(i)] = i;
  return place;
}

void printSparse(std::ostream& os) {
  slom::Estimator est;
  std::vector<slom::VarID<Pose>> poses;
  const Pose step(mtk::SO2<>(2 * 3.14159265358979 / kRound), mtk::vect<2>(1, 0));
  Pose at;
  for (int i = 0; i < kPoses; ++i, at = at * step)
    poses.push_back(est.insertRV(at, "pose " + std::to_string(i)));
  for (const auto& [a, b] : links()) {
    const Pose seen = poses[std::size_t(a)]->inverse() * *poses[std::size_t(b)];
    est.insertMeasurement(slom::RelativePose(), poses[std::size_t(a)], poses[std::size_t(b)],
                          slom::measured(seen), slom::StandardDeviation(0.1));
  }
  est.prior(poses[0], Pose(), 0.01);
  const slom::Summary summary = est.optimize();
  const int all = kPoses * (kPoses - 1) / 2, present = int(links().size());
  os << "solver: " << summary.solver << "\n";
  os << format("blocks below the diagonal: %d possible, %d in H\n", all, present);
  os << format("in the factor: %d in the order of the drive, %d with minimum degree\n",
               int(factor(naturalOrder()).size()), int(factor(minimumDegree()).size()));
}

std::string drawSparse() {
  Plot plot(740, 270);
  const auto square = [&](double x_px, const char* title, const std::vector<Pair>& blocks,
                          const std::vector<Pair>& from_links) {
    plot.diagram({x_px, 30, 220, 220, 0, kPoses, 0, kPoses}, title);
    const auto cell = [&](int row, int column, const char* colour) {
      plot.rectangle(Vec2(column, kPoses - 1 - row), Vec2(column + 1, kPoses - row), colour);
    };
    for (const auto& [i, k] : blocks) cell(i, k, kRed);
    for (const auto& [i, k] : from_links) cell(i, k, kBlue);
    for (int i = 0; i < kPoses; ++i) cell(i, i, kBlack);
  };
  const auto placed = [](const std::vector<int>& place, bool both) {
    std::vector<Pair> result;
    for (const auto& [a, b] : links()) {
      const int i = place[std::size_t(a)], j = place[std::size_t(b)];
      result.emplace_back(std::max(i, j), std::min(i, j));
      if (both) result.emplace_back(std::min(i, j), std::max(i, j));
    }
    return result;
  };
  const std::vector<int> natural = naturalOrder(), few = minimumDegree();
  square(15, "H", {}, placed(natural, true));
  square(260, "factor, order of the drive", factor(natural), placed(natural, false));
  square(505, "factor, minimum degree", factor(few), placed(few, false));
  return plot.svg();
}

}  // namespace

const Page kSparse{"sparse", &printSparse, &drawSparse};
