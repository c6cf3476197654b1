#include "slom/solve/block_solver.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "block/low_degree_elimination.hpp"
#include "block/multifrontal.hpp"
#include "block/normal_equations.hpp"
#include "block/reduced_operator.hpp"
#include "block/schur_complement.hpp"
#include "linearize/parallel.hpp"
#include "linearize/stopwatch.hpp"
#include "mtk/error.hpp"
#include "symbolic/low_degree.hpp"
#include "symbolic/ordering.hpp"

namespace slom {

using Eigen::VectorXd;

namespace {


/// A pivot below this share of its diagonal entry is rounding error.
constexpr double kPivotTolerance = 1e-12;
/// What conjugate gradients solve to where an exact solution is asked for.
constexpr double kExactTolerance = 1e-13;

/// The model that the choice of the method rests on.
constexpr double kSecondsPerOperation = 5e-11;
constexpr double kSecondsPerEntry = 2e-9;  // of H, in a product with it, which waits for memory
constexpr double kReducedIterations = 100, kWholeIterations = 1000;
constexpr double kWorthBeingInexact = 5;  // exact steps need fewer iterations of the fit
constexpr double kMostFactorEntries = 1.5e9;  // 12 GB
constexpr double kMostPairs = 4e9;            // of blocks that meet in an eliminated one

std::size_t at(int i) { return static_cast<std::size_t>(i); }

double entries(const BlockGraph& graph) {
  double sum = 0;
  for (int b = 0; b < graph.size(); ++b) {
    double neighbours = graph.dof[at(b)];
    for (int e = graph.start[at(b)]; e < graph.start[at(b) + 1]; ++e) neighbours += 0.5 * graph.dof[at(graph.neighbour[at(e)])];
    sum += graph.dof[at(b)] * neighbours;
  }
  return sum;
}

double entries(const Fronts& fronts) {
  double sum = 0;
  for (const Front& front : fronts.front) sum += front.p * (0.5 * front.p + front.u);
  return sum;
}

/// Of blocks that meet in an eliminated one.
double pairs(const BlockGraph& graph, const std::vector<char>& eliminated) {
  double sum = 0;
  for (int b = 0; b < graph.size(); ++b) {
    const double degree = graph.start[at(b) + 1] - graph.start[at(b)];
    if (eliminated[at(b)]) sum += 0.5 * degree * degree;
  }
  return sum;
}

/// Of each block in the order of elimination: `first`, and behind them `block`, at these positions of their own.
std::vector<int> positionsBehind(const std::vector<int>& first, const std::vector<int>& block, const std::vector<int>& position) {
  std::vector<int> result(first.size() + block.size());
  const int count = static_cast<int>(first.size());
  for (int i = 0; i < count; ++i) result[at(first[at(i)])] = i;
  for (std::size_t i = 0; i < block.size(); ++i) result[at(block[i])] = count + position[i];
  return result;
}

/// As "49 x 9 + 1 x 4": so many blocks of so many unknowns, for the blocks where is(b).
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

void check(const BlockSolverOptions& options) {
  if (!(options.forcing > 0 && options.forcing < 1)) {
    throw mtk::Error("slom.bad-option", "forcing is " + std::to_string(options.forcing) +
                                            "; pass a number between 0 and 1, such as 0.1");
  }
  if (options.max_iterations < 1) {
    throw mtk::Error("slom.bad-option", "max_iterations of conjugate gradients is " +
                                            std::to_string(options.max_iterations) + "; pass a positive number, such as 500");
  }
}

/// Blocks of the inverse at the places of H's: eliminated columns, and the others as those of the reduced system.
class SelectedInverse final : public InverseBlocks {
 public:
  SelectedInverse(std::vector<int> position, int count) : position_(std::move(position)), count_(count) {}
  BlockLower eliminated, kept;

  void block(int a, int b, double* out) const override {
    const int i = position_[at(a)], j = position_[at(b)], low = std::min(i, j), high = std::max(i, j);
    const BlockLower& from = low < count_ ? eliminated : kept;
    const int shift = low < count_ ? 0 : count_, rows = from.dof(high - shift), columns = from.dof(low - shift);
    const Eigen::Map<const Eigen::MatrixXd> values(from.values(from.find(high - shift, low - shift)), rows, columns);
    if (i == j) {
      Eigen::Map<Eigen::MatrixXd>(out, rows, columns) = (values + values.transpose()) / 2;
    } else if (i > j) {
      Eigen::Map<Eigen::MatrixXd>(out, rows, columns) = values;
    } else {
      Eigen::Map<Eigen::MatrixXd>(out, columns, rows) = values.transpose();
    }
  }

 private:
  std::vector<int> position_;
  int count_;
};

}  // namespace

struct BlockSolver::Implementation {
  explicit Implementation(const BlockSolverOptions& given)
      : options(given), is_exact(given.method != BlockSolverOptions::Method::conjugate_gradients) {}

  const BlockSolverOptions options;
  BlockStructure structure;
  std::vector<char> eliminated;  // of each block; empty: none
  bool is_exact;
  NormalEquations equations;
  SchurComplement schur;        // where blocks are eliminated and steps are exact
  LowDegreeElimination low;     // where none are, steps are exact, and many blocks have few neighbours
  bool has_low = false;
  MultifrontalCholesky factor;  // where they are exact
  ReducedOperator reduced;      // where they are not
  VectorXd diagonal;
  std::vector<int> kept;  // unknowns of the reduced system
  bool has_undamped_factor = false;
  bool took_along = false;  // a right-hand side, in the last call of factorize()
  SolveStatus undamped_status;
  double largest_gradient = 0;
  int steps = 0;
  double iterations = 0;  // of conjugate gradients, in all steps

  int count() const { return static_cast<int>(std::count(eliminated.begin(), eliminated.end(), 1)); }
  bool isReduced() const { return !eliminated.empty(); }
  std::vector<int> eliminatedBlocks() const {
    std::vector<int> blocks;
    for (std::size_t b = 0; b < eliminated.size(); ++b) {
      if (eliminated[b]) blocks.push_back(static_cast<int>(b));
    }
    return blocks;
  }
  /// What the fronts factorise: H, or what an elimination leaves of it.
  const BlockLower& matrix() const { return has_low ? low.S() : isReduced() ? schur.S() : equations.H(); }
  const EliminatedBlocks& points() const { return is_exact ? schur.eliminated() : reduced.eliminated(); }
  void analyze(const BlockGraph& graph);
  bool choosesConjugateGradients(double matrix_entries, double operations, double factor_entries) const;
  void analyzeWhole(const BlockGraph& graph);
  bool analyzeLowDegree(const BlockGraph& graph);
  std::vector<int> keep(const std::vector<int>& blocks);
  void analyzeReduced(const BlockGraph& graph);
  void analyzeInexact(const BlockGraph& graph);
  SolveStatus factorize(const VectorXd& damping, VectorXd* b = nullptr);
  double forcing();
  std::unique_ptr<InverseBlocks> invertBlocks();
  SolveStatus solve(const VectorXd& b, double tolerance, int max_iterations, VectorXd& x);
  void solveRest(VectorXd& x);
  VectorXd keptOf(const VectorXd& x) const {
    return x.size() == 0 ? VectorXd() : VectorXd(x(kept));
  }
};

void BlockSolver::Implementation::analyze(const BlockGraph& graph) {
  has_undamped_factor = false;
  largest_gradient = 0;
  steps = 0;
  iterations = 0;
  is_exact = options.method != BlockSolverOptions::Method::conjugate_gradients;
  has_low = false;
  eliminated.clear();
  if (options.elimination == BlockSolverOptions::Elimination::automatic) eliminated = independentBlocks(graph);
  const bool too_many = isReduced() && pairs(graph, eliminated) > kMostPairs;
  if (is_exact && too_many && options.method == BlockSolverOptions::Method::automatic) is_exact = false;
  if (is_exact) isReduced() ? analyzeReduced(graph) : analyzeWhole(graph);
  if (!is_exact) analyzeInexact(graph);
}

bool BlockSolver::Implementation::choosesConjugateGradients(double matrix_entries, double operations,
                                                            double factor_entries) const {
  if (options.method != BlockSolverOptions::Method::automatic) return false;
  const double iterating = (isReduced() ? kReducedIterations : kWholeIterations) * kSecondsPerEntry * matrix_entries;
  return factor_entries > kMostFactorEntries || kSecondsPerOperation * operations > kWorthBeingInexact * iterating;
}

void BlockSolver::Implementation::analyzeWhole(const BlockGraph& graph) {
  if (options.elimination == BlockSolverOptions::Elimination::automatic && analyzeLowDegree(graph)) return;
  Fronts fronts = chooseFronts(graph);
  is_exact = !choosesConjugateGradients(entries(graph), fronts.flops, entries(fronts));
  if (!is_exact) return;
  equations.layOut(structure, graph, fronts.position);
  factor.analyze(structure.offset, std::move(fronts), equations.H());
}

/// Returns whether that is the way to take; is_exact may have become false.
bool BlockSolver::Implementation::analyzeLowDegree(const BlockGraph& graph) {
  const LowDegree blocks = eliminateLowDegree(graph);
  if (blocks.order.empty()) return false;
  const ReducedGraph& left = blocks.left;
  Fronts fronts = chooseFronts(left.graph);
  is_exact = !choosesConjugateGradients(entries(graph), fronts.flops, entries(blocks.filled) + entries(fronts));
  if (!is_exact) return true;
  has_low = true;
  equations.layOut(structure, blocks.filled, positionsBehind(blocks.order, left.block, fronts.position));
  low.analyze(equations.H(), blocks, fronts.position);
  factor.analyze(keep(left.block), std::move(fronts), low.S());
  return true;
}

/// The unknowns of these blocks stay; returns where each block's begin among them.
std::vector<int> BlockSolver::Implementation::keep(const std::vector<int>& blocks) {
  kept.clear();
  std::vector<int> offset{0};
  for (const int b : blocks) {
    for (int c = 0; c < structure.dof(b); ++c) kept.push_back(structure.offset[at(b)] + c);
    offset.push_back(static_cast<int>(kept.size()));
  }
  return offset;
}

void BlockSolver::Implementation::analyzeReduced(const BlockGraph& graph) {
  const ReducedGraph left = reduceGraph(graph, eliminated);
  Fronts fronts = chooseFronts(left.graph);
  double forming = 0;  // operations
  for (int b = 0; b < graph.size(); ++b) {
    double height = 0;
    for (int e = graph.start[at(b)]; e < graph.start[at(b) + 1]; ++e) height += graph.dof[at(graph.neighbour[at(e)])];
    if (eliminated[at(b)]) forming += graph.dof[at(b)] * height * height;
  }
  is_exact = !choosesConjugateGradients(entries(graph), forming + fronts.flops, entries(left.graph) + entries(fronts));
  if (!is_exact) return;
  equations.layOut(structure, graph, positionsBehind(eliminatedBlocks(), left.block, fronts.position));
  schur.analyze(equations.H(), count(), left.graph, fronts.position);
  factor.analyze(keep(left.block), std::move(fronts), schur.S());
}

void BlockSolver::Implementation::analyzeInexact(const BlockGraph& graph) {
  std::vector<int> block, position;
  for (int b = 0; b < graph.size(); ++b) {
    if (isReduced() && eliminated[at(b)]) continue;
    position.push_back(static_cast<int>(block.size()));
    block.push_back(b);
  }
  equations.layOut(structure, graph, positionsBehind(eliminatedBlocks(), block, position));
  reduced.analyze(equations.H(), count(), options.preconditioner);
}

/// Takes b along, if there is anything to do: then solveRest() ends the solution for it.
SolveStatus BlockSolver::Implementation::factorize(const VectorXd& damping, VectorXd* b) {
  const bool is_undamped = damping.size() == 0;
  took_along = false;
  if (is_undamped && has_undamped_factor) return undamped_status;
  SolveStatus status;
  if (!is_exact) {
    status = reduced.prepare(equations.H(), equations.offset(), damping, kPivotTolerance);
  } else if (!isReduced() && !has_low) {
    status = factor.factorize(equations.H(), diagonal, damping, kPivotTolerance, b);
  } else {
    status = has_low ? low.reduce(equations.H(), equations.offset(), damping, kPivotTolerance, b)
                     : schur.reduce(equations.H(), equations.offset(), damping, kPivotTolerance, b);
    if (status.ok) {
      VectorXd rest;
      if (b != nullptr) rest = keptOf(*b);
      status = factor.factorize(matrix(), keptOf(diagonal), keptOf(damping), kPivotTolerance, b != nullptr ? &rest : nullptr);
      if (!status.ok) status.unknown = kept[at(status.unknown)];
    }
  }
  took_along = is_exact && b != nullptr;
  has_undamped_factor = is_undamped;
  if (is_undamped) undamped_status = status;
  return status;
}

double BlockSolver::Implementation::forcing() {
  const VectorXd& g = equations.gradient();
  double squared = 0;
  for (Eigen::Index i = 0; i < g.size(); ++i) squared += diagonal[i] > 0 ? g[i] * g[i] / diagonal[i] : 0;
  largest_gradient = std::max(largest_gradient, std::sqrt(squared));
  if (!(largest_gradient > 0)) return options.forcing;
  return std::min(options.forcing, std::sqrt(std::sqrt(squared) / largest_gradient));
}

/// x := the solution, for the right-hand side that factorize() has taken along and left there.
void BlockSolver::Implementation::solveRest(VectorXd& x) {
  if (!has_low && !isReduced()) {
    x = factor.solveRest();
    return;
  }
  x(kept) = factor.solveRest();
  has_low ? low.substitute(equations.offset(), x) : points().substitute(equations.H(), equations.offset(), x);
}

/// After factorize(): the tolerance is that of conjugate gradients.
SolveStatus BlockSolver::Implementation::solve(const VectorXd& b, double tolerance, int max_iterations, VectorXd& x) {
  x = b;
  if (has_low) low.forward(equations.offset(), x);
  if (isReduced()) points().reduceVector(equations.H(), equations.offset(), x);
  if (is_exact) {
    factor.solveFirst(has_low || isReduced() ? keptOf(x) : x);
    solveRest(x);
    return {};
  }
  VectorXd part;
  const auto outcome = conjugateGradients(reduced, reduced.reducedOf(x, equations.offset()), tolerance, max_iterations, part);
  iterations += outcome.iterations;
  ++steps;
  if (!outcome.ok) return {false, equations.offset()[at(count())], 0};
  reduced.putInto(part, equations.offset(), x);
  if (isReduced()) points().substitute(equations.H(), equations.offset(), x);
  return {};
}

/// After an exact factorize().
std::unique_ptr<InverseBlocks> BlockSolver::Implementation::invertBlocks() {
  const BlockLower& H = equations.H();
  std::vector<int> position(at(structure.blockCount()));
  for (int b = 0; b < structure.blockCount(); ++b) position[at(b)] = equations.position(b);
  auto result = std::make_unique<SelectedInverse>(std::move(position), has_low ? low.count() : isReduced() ? count() : 0);
  result->kept.layOutAs(matrix());
  factor.invertSelected(result->kept);
  if (has_low) {
    result->eliminated.layOutAs(H);
    low.invert(H, result->kept, result->eliminated);
    return result;
  }
  if (!isReduced()) return result;
  result->eliminated.layOutAs(H);
  detail::forEachIndex(count(), [&](int e) { points().invert(H, e, result->kept, result->eliminated); });
  return result;
}

BlockSolver::BlockSolver(const BlockSolverOptions& options) : self_(std::make_unique<Implementation>(options)) { check(options); }
BlockSolver::~BlockSolver() = default;

void BlockSolver::analyze(const BlockStructure& structure) {
  self_->structure = structure;
  self_->analyze(makeGraph(structure));
}

void BlockSolver::beginLinearization() {
  self_->equations.setZero();
  self_->has_undamped_factor = false;
}
void BlockSolver::add(const JacobianBatch& batch) { self_->equations.add(batch); }
std::span<const MeasurementPlace> BlockSolver::parts() const { return self_->equations.parts(); }
void BlockSolver::endLinearization() {
  self_->equations.addUp();
  self_->equations.diagonal(self_->diagonal);
}

SolveStatus BlockSolver::solve(const VectorXd& damping, VectorXd& step) {
  VectorXd x = -gradient();
  {
    const detail::Stopwatch watch(seconds_.factorize);
    const SolveStatus status = self_->factorize(damping, &x);
    if (!status.ok) return status;
  }
  const detail::Stopwatch watch(seconds_.solve);
  SolveStatus status;
  if (self_->took_along) {
    self_->solveRest(x);
  } else {
    const double tolerance = self_->is_exact ? 0 : self_->forcing();
    status = self_->solve(-gradient(), tolerance, self_->options.max_iterations, x);
  }
  if (status.ok) step = std::move(x);
  return status;
}

SolveStatus BlockSolver::solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) { return solveDamped({}, B, X); }

SolveStatus BlockSolver::solveDamped(const VectorXd& damping, const Eigen::MatrixXd& B, Eigen::MatrixXd& X) {
  SolveStatus status = self_->factorize(damping);
  if (!status.ok) return status;
  Eigen::MatrixXd all(B.rows(), B.cols());
  VectorXd x;
  for (Eigen::Index j = 0; status.ok && j < B.cols(); ++j) {
    const int enough = 10 * static_cast<int>(B.rows()) + 100;
    status = self_->solve(B.col(j), kExactTolerance, enough, x);
    if (status.ok) all.col(j) = x;
  }
  if (status.ok) X = std::move(all);
  return status;
}

SolveStatus BlockSolver::invertBlocks(const BlockStructure& structure, std::unique_ptr<InverseBlocks>& blocks) {
  return self_->is_exact ? invertDamped({}, blocks) : LinearSolver::invertBlocks(structure, blocks);
}

SolveStatus BlockSolver::invertDamped(const VectorXd& damping, std::unique_ptr<InverseBlocks>& blocks) {
  const SolveStatus status = self_->factorize(damping);
  if (status.ok) blocks = self_->invertBlocks();
  return status;
}

bool BlockSolver::isExact() const { return self_->is_exact; }
const VectorXd& BlockSolver::gradient() const { return self_->equations.gradient(); }
const VectorXd& BlockSolver::diagonal() const { return self_->diagonal; }
double BlockSolver::squaredImage(const VectorXd& d) const { return self_->equations.squaredImage(d); }
double BlockSolver::flops() const {
  if (!self_->is_exact) return 0;
  return self_->factor.fronts().flops + (self_->has_low ? self_->low.flops() : 0);
}

std::string BlockSolver::description() const {
  const Implementation& self = *self_;
  if (self.structure.offset.empty()) return "block solver that has solved nothing yet";
  const auto is_eliminated = [&](int b) { return self.isReduced() && self.eliminated[at(b)]; };
  std::string text = shape(self.structure, [&](int b) { return !is_eliminated(b); });
  text = self.isReduced() ? "reduced system " + text + " after elimination of " + shape(self.structure, is_eliminated)
                          : "system " + text;
  if (self.is_exact) {
    const Fronts& fronts = self.factor.fronts();
    if (self.has_low) {
      text += ", sparse Cholesky, " + std::to_string(self.low.count()) + " blocks with few neighbours first";
      return fronts.front.empty() ? text : text + ", then " + fronts.ordering + " order";
    }
    text += fronts.front.size() == 1 ? ", dense Cholesky" : std::string(", sparse Cholesky, ") + fronts.ordering + " order";
    return text;
  }
  text += ", conjugate gradients with ";
  switch (self.reduced.preconditioner()) {
    case BlockSolverOptions::Preconditioner::schur_jacobi: text += self.isReduced() ? "Schur-Jacobi" : "block Jacobi"; break;
    case BlockSolverOptions::Preconditioner::block_jacobi: text += "block Jacobi"; break;
    case BlockSolverOptions::Preconditioner::power_series: text += "power series"; break;
  }
  text += " preconditioner";
  if (self.steps > 0) {
    text += ", " + std::to_string(static_cast<int>(std::lround(self.iterations / self.steps))) + " iterations per step";
  }
  return text;
}

}  // namespace slom
