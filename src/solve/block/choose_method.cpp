#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "base/index.hpp"
#include "block_method.hpp"
#include "cholesky_method.hpp"
#include "iterative_method.hpp"
#include "partial_elimination.hpp"
#include "schur_complement.hpp"
#include "solve/symbolic/independent_blocks.hpp"
#include "solve/symbolic/ordering.hpp"
#include "solve/symbolic/partial_minimum_degree.hpp"

namespace slom {

namespace {

/// Cost model for the choice of the method.
constexpr double kSecondsPerOperation = 5e-11;
constexpr double kSecondsPerEntry = 2e-9;  // for each entry of H in a product with it; memory-bound
constexpr double kReducedIterations = 100, kWholeIterations = 1000;
constexpr double kWorthBeingInexact = 5;      // ratio of times; exact steps need fewer iterations of the fit
constexpr double kMostFactorEntries = 1.5e9;  // 12 GB
constexpr double kMostPairs = 4e9;            // number of pairs of blocks that meet in an eliminated block

double entries(const BlockGraph& graph) {
  double sum = 0;
  for (int b = 0; b < graph.size(); ++b) {
    double neighbours = graph.dof[at(b)];
    for (int e = graph.start[at(b)]; e < graph.start[at(b) + 1]; ++e)
      neighbours += 0.5 * graph.dof[at(graph.neighbour[at(e)])];
    sum += graph.dof[at(b)] * neighbours;
  }
  return sum;
}

double entries(const Fronts& fronts) {
  double sum = 0;
  for (const Front& front : fronts.front) sum += front.p * (0.5 * front.p + front.u);
  return sum;
}

/// Returns the number of pairs of neighbours of the eliminated blocks.
double pairs(const BlockGraph& graph, const std::vector<char>& eliminated) {
  double sum = 0;
  for (int b = 0; b < graph.size(); ++b) {
    const double degree = graph.start[at(b) + 1] - graph.start[at(b)];
    if (eliminated[at(b)]) sum += 0.5 * degree * degree;
  }
  return sum;
}

/// Returns the permutation by block: first the blocks of `first`, then those of `block` in the order of their
/// `position`.
std::vector<int> positionsBehind(const std::vector<int>& first, const std::vector<int>& block,
                                 const std::vector<int>& position) {
  std::vector<int> result(first.size() + block.size());
  const int count = static_cast<int>(first.size());
  for (int i = 0; i < count; ++i) result[at(first[at(i)])] = i;
  for (std::size_t i = 0; i < block.size(); ++i) result[at(block[i])] = count + position[i];
  return result;
}

/// Returns a text such as "49 x 9 + 1 x 4": numbers of blocks times numbers of unknowns, for the selected blocks.
template <class Predicate>
std::string shape(const BlockStructure& structure, const Predicate& is) {
  std::map<int, int> count;
  for (int b = 0; b < structure.blockCount(); ++b) {
    if (is(b)) ++count[structure.dof(b)];
  }
  constexpr std::size_t kMost = 3;
  if (count.size() > kMost) {
    int blocks = 0, unknowns = 0;
    for (const auto& [dof, n] : count) blocks += n, unknowns += n * dof;
    return std::to_string(unknowns) + " unknowns in " + std::to_string(blocks) + " blocks";
  }
  std::string text;
  for (const auto& [dof, n] : count) {
    text += (text.empty() ? "" : " + ") + std::to_string(n) + " x " + std::to_string(dof);
  }
  return text.empty() ? "nothing" : text;
}

/// Describes what is solved: "reduced system 49 x 9 after elimination of 7776 x 3".
std::string describe(const BlockStructure& structure, const std::vector<char>& points) {
  if (points.empty()) return "system " + shape(structure, [](int) { return true; });
  return "reduced system " + shape(structure, [&](int b) { return points[at(b)] == 0; }) +
         " after elimination of " + shape(structure, [&](int b) { return points[at(b)] != 0; });
}

/// The choice for one structure.
class Choice {
 public:
  Choice(const BlockStructure& structure, const BlockSolverOptions& options, NormalEquations& equations)
      : structure_(structure), options_(options), equations_(equations), graph_(makeGraph(structure)) {
    if (mayEliminate()) points_ = independentBlocks(graph_);
  }

  std::unique_ptr<BlockMethod> run() {
    using Method = BlockSolverOptions::Method;
    if (options_.method == Method::conjugate_gradients) return iterative();
    if (points_.empty()) {
      const PartialMinimumDegree low =
          mayEliminate() ? eliminateByMinimumDegree(graph_) : PartialMinimumDegree();
      return low.order.empty() ? whole() : afterPartialElimination(low);
    }
    const bool too_many = pairs(graph_, points_) > kMostPairs;
    return too_many && options_.method == Method::automatic ? iterative() : afterPoints();
  }

 private:
  bool mayEliminate() const { return options_.elimination == BlockSolverOptions::Elimination::automatic; }

  bool isTooExpensive(double operations, double factor_entries) const {
    if (options_.method != BlockSolverOptions::Method::automatic) return false;
    const double iterating =
        (points_.empty() ? kWholeIterations : kReducedIterations) * kSecondsPerEntry * entries(graph_);
    return factor_entries > kMostFactorEntries ||
           kSecondsPerOperation * operations > kWorthBeingInexact * iterating;
  }

  std::unique_ptr<BlockMethod> whole() {
    Fronts fronts = chooseFronts(graph_);
    if (isTooExpensive(fronts.flops, entries(fronts))) return iterative();
    equations_.layOut(structure_, graph_, fronts.position);
    return cholesky(nullptr, blocksWhere(false), std::move(fronts));
  }

  std::unique_ptr<BlockMethod> afterPartialElimination(const PartialMinimumDegree& low) {
    Fronts fronts = chooseFronts(low.left.graph);
    if (isTooExpensive(fronts.flops, entries(low.filled) + entries(fronts))) return iterative();
    equations_.layOut(structure_, low.filled, positionsBehind(low.order, low.left.block, fronts.position));
    auto elimination = std::make_unique<PartialElimination>(equations_.H(), low, fronts.position);
    return cholesky(std::move(elimination), low.left.block, std::move(fronts));
  }

  std::unique_ptr<BlockMethod> afterPoints() {
    const ReducedGraph left = reduceGraph(graph_, points_);
    Fronts fronts = chooseFronts(left.graph);
    const double flops = schurFlops();
    if (isTooExpensive(flops + fronts.flops, entries(left.graph) + entries(fronts))) return iterative();
    const std::vector<int> first = blocksWhere(true);
    equations_.layOut(structure_, graph_, positionsBehind(first, left.block, fronts.position));
    auto elimination = std::make_unique<SchurComplement>(equations_.H(), static_cast<int>(first.size()),
                                                         flops, left.graph, fronts.position);
    return cholesky(std::move(elimination), left.block, std::move(fronts));
  }

  std::unique_ptr<BlockMethod> cholesky(std::unique_ptr<Elimination> elimination,
                                        const std::vector<int>& rest, Fronts fronts) {
    return std::make_unique<CholeskyMethod>(describe(structure_, points_), structure_, equations_,
                                            std::move(elimination), rest, std::move(fronts));
  }

  std::unique_ptr<BlockMethod> iterative() {
    const std::vector<int> first = blocksWhere(true), rest = blocksWhere(false);
    std::vector<int> position(rest.size());
    std::iota(position.begin(), position.end(), 0);
    equations_.layOut(structure_, graph_, positionsBehind(first, rest, position));
    return std::make_unique<IterativeMethod>(describe(structure_, points_), options_, equations_,
                                             static_cast<int>(first.size()));
  }

  /// Returns the points, or the other blocks, in ascending order.
  std::vector<int> blocksWhere(bool is_point) const {
    std::vector<int> blocks;
    for (int b = 0; b < graph_.size(); ++b) {
      if ((!points_.empty() && points_[at(b)] != 0) == is_point) blocks.push_back(b);
    }
    return blocks;
  }

  double schurFlops() const {
    double sum = 0;
    for (int b = 0; b < graph_.size(); ++b) {
      double height = 0;
      for (int e = graph_.start[at(b)]; e < graph_.start[at(b) + 1]; ++e)
        height += graph_.dof[at(graph_.neighbour[at(e)])];
      if (points_[at(b)]) sum += graph_.dof[at(b)] * height * height;
    }
    return sum;
  }

  const BlockStructure& structure_;
  const BlockSolverOptions& options_;
  NormalEquations& equations_;
  const BlockGraph graph_;
  /// By block: whether it is eliminated with others that it never meets. Empty: none is.
  std::vector<char> points_;
};

}  // namespace

std::unique_ptr<BlockMethod> chooseMethod(const BlockStructure& structure, const BlockSolverOptions& options,
                                          NormalEquations& equations) {
  return Choice(structure, options, equations).run();
}

}  // namespace slom
