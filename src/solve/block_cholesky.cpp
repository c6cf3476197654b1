#include "slom/solve/block_cholesky.hpp"

#include "block/multifrontal.hpp"
#include "block/normal_equations.hpp"
#include "block/schur_complement.hpp"
#include "linearize/stopwatch.hpp"
#include "symbolic/ordering.hpp"

namespace slom {

using Eigen::VectorXd;

namespace {
/// A pivot below this share of its diagonal entry is rounding error.
constexpr double kPivotTolerance = 1e-12;

std::size_t at(int i) { return static_cast<std::size_t>(i); }
}  // namespace

struct BlockCholesky::Implementation {
  BlockStructure structure;
  NormalEquations equations;
  SchurComplement schur;  // eliminates nothing where that does not pay
  MultifrontalCholesky factor;
  VectorXd diagonal;
  std::vector<int> kept;  // unknowns of the reduced system
  bool has_undamped_factor = false;
  SolveStatus undamped_status;

  bool isReduced() const { return schur.eliminated() > 0; }
  void analyzeWhole(const BlockGraph& graph);
  void analyzeReduced(const BlockGraph& graph, const std::vector<char>& eliminated);
  SolveStatus factorize(const VectorXd& damping);
  VectorXd solve(VectorXd b);
  VectorXd keptOf(const VectorXd& x) const {
    return x.size() == 0 ? VectorXd() : VectorXd(x(kept));
  }
};

void BlockCholesky::Implementation::analyzeWhole(const BlockGraph& graph) {
  Fronts fronts = chooseFronts(graph);
  schur = SchurComplement();
  equations.layOut(structure, graph, fronts.position);
  factor.analyze(structure.offset, std::move(fronts), equations.H());
}

void BlockCholesky::Implementation::analyzeReduced(const BlockGraph& graph, const std::vector<char>& eliminated) {
  const ReducedGraph reduced = reduceGraph(graph, eliminated);
  Fronts fronts = chooseFronts(reduced.graph);
  const int count = graph.size() - reduced.graph.size();
  std::vector<int> position(at(graph.size())), offset{0};
  int next = 0;
  for (int b = 0; b < graph.size(); ++b) {
    if (eliminated[at(b)]) position[at(b)] = next++;
  }
  kept.clear();
  for (int i = 0; i < reduced.graph.size(); ++i) {
    const int b = reduced.block[at(i)];
    position[at(b)] = count + fronts.position[at(i)];
    for (int c = 0; c < structure.dof(b); ++c) kept.push_back(structure.offset[at(b)] + c);
    offset.push_back(static_cast<int>(kept.size()));
  }
  equations.layOut(structure, graph, position);
  schur.analyze(equations.H(), count, reduced.graph, fronts.position);
  factor.analyze(offset, std::move(fronts), schur.S());
}

SolveStatus BlockCholesky::Implementation::factorize(const VectorXd& damping) {
  const bool is_undamped = damping.size() == 0;
  if (is_undamped && has_undamped_factor) return undamped_status;
  SolveStatus status;
  if (!isReduced()) {
    status = factor.factorize(equations.H(), diagonal, damping, kPivotTolerance);
  } else {
    status = schur.reduce(equations.H(), equations.offset(), damping, kPivotTolerance);
    if (status.ok) {
      status = factor.factorize(schur.S(), keptOf(diagonal), keptOf(damping), kPivotTolerance);
      if (!status.ok) status.unknown = kept[at(status.unknown)];
    }
  }
  has_undamped_factor = is_undamped;
  if (is_undamped) undamped_status = status;
  return status;
}

VectorXd BlockCholesky::Implementation::solve(VectorXd b) {
  if (!isReduced()) return factor.solve(b);
  schur.reduceVector(equations.H(), equations.offset(), b);
  b(kept) = factor.solve(keptOf(b));
  schur.substitute(equations.H(), equations.offset(), b);
  return b;
}

BlockCholesky::BlockCholesky() : self_(std::make_unique<Implementation>()) {}
BlockCholesky::~BlockCholesky() = default;

void BlockCholesky::analyze(const BlockStructure& structure) {
  self_->structure = structure;
  self_->has_undamped_factor = false;
  const BlockGraph graph = makeGraph(structure);
  const std::vector<char> eliminated = independentBlocks(graph);
  if (eliminated.empty()) {
    self_->analyzeWhole(graph);
  } else {
    self_->analyzeReduced(graph, eliminated);
  }
}

void BlockCholesky::beginLinearization() {
  self_->equations.setZero();
  self_->has_undamped_factor = false;
}
void BlockCholesky::add(const JacobianBatch& batch) { self_->equations.add({&batch, 1}); }
void BlockCholesky::addAll(std::span<const JacobianBatch> batches) { self_->equations.add(batches); }
void BlockCholesky::endLinearization() { self_->diagonal = self_->equations.diagonal(); }

SolveStatus BlockCholesky::solve(const VectorXd& damping, VectorXd& step) {
  {
    const detail::Stopwatch watch(seconds_.factorize);
    const SolveStatus status = self_->factorize(damping);
    if (!status.ok) return status;
  }
  const detail::Stopwatch watch(seconds_.solve);
  step = self_->solve(-gradient());
  return {};
}

SolveStatus BlockCholesky::solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) {
  const SolveStatus status = self_->factorize({});
  if (!status.ok) return status;
  X.resize(B.rows(), B.cols());
  for (Eigen::Index j = 0; j < B.cols(); ++j) X.col(j) = self_->solve(B.col(j));
  return status;
}

const VectorXd& BlockCholesky::gradient() const { return self_->equations.gradient(); }
const VectorXd& BlockCholesky::diagonal() const { return self_->diagonal; }
double BlockCholesky::squaredImage(const VectorXd& d) const { return self_->equations.squaredImage(d); }
double BlockCholesky::flops() const { return self_->factor.fronts().flops; }

std::string BlockCholesky::description() const {
  std::string text = "block Cholesky, " + std::to_string(self_->structure.unknowns()) + " unknowns in " +
                     std::to_string(self_->structure.blockCount()) + " blocks";
  if (self_->isReduced()) {
    text += ", reduced to " + std::to_string(self_->kept.size()) + " in " +
            std::to_string(self_->structure.blockCount() - self_->schur.eliminated());
  }
  return text;
}

}  // namespace slom
