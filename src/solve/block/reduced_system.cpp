#include "slom/solve/reduced_system.hpp"

#include <numeric>
#include <utility>

#include "base/index.hpp"
#include "base/threads.hpp"
#include "block_method.hpp"
#include "normal_equations.hpp"
#include "reduced_operator.hpp"
#include "schur_complement.hpp"
#include "solve/symbolic/compact.hpp"
#include "solve/symbolic/independent_blocks.hpp"

namespace slom {

using Eigen::VectorXd;

struct ReducedSystem::Implementation {
  CompactStructure compact;
  std::vector<int> original;     // by block of the compact structure: block of the whole one
  std::vector<char> eliminated;  // by block of the whole structure
  std::vector<int> block_at;     // by position of S: block of the whole structure
  NormalEquations equations;
  ReducedGraph left;  // until one of the next two is planned
  std::unique_ptr<SchurComplement> schur;
  std::unique_ptr<ReducedOperator> products;
  bool is_reduced = false;  // the products have numbers
  int eliminated_count = 0;
};

ReducedSystem::ReducedSystem() : own_(new Implementation) {}
ReducedSystem::~ReducedSystem() = default;

void ReducedSystem::analyze(const BlockStructure& structure, const std::vector<char>& stays) {
  auto now = std::make_unique<Implementation>();
  now->compact = compact(structure);
  const BlockStructure& filled = now->compact.structure;
  for (int b = 0; b < structure.blockCount(); ++b) {
    if (!structure.isEmpty(b)) now->original.push_back(b);
  }
  const BlockGraph graph = makeGraph(filled);
  std::vector<char> points = independentBlocks(graph);
  points.resize(at(graph.size()), 0);
  now->eliminated.assign(at(structure.blockCount()), 0);
  std::vector<int> position(at(graph.size()));
  for (int b = 0; b < graph.size(); ++b) {
    const int whole = now->original[at(b)];
    if (!stays.empty() && stays[at(whole)] != 0) points[at(b)] = 0;
    now->eliminated[at(whole)] = points[at(b)];
    if (points[at(b)] != 0) position[at(b)] = now->eliminated_count++;
  }
  now->left = reduceGraph(graph, points);
  const std::vector<int>& left = now->left.block;
  for (std::size_t i = 0; i < left.size(); ++i) {
    position[at(left[i])] = now->eliminated_count + static_cast<int>(i);
    now->block_at.push_back(now->original[at(left[i])]);
  }
  now->equations.layOut(filled, graph, position);
  own_ = std::move(now);
}

std::size_t ReducedSystem::numbersOfS() const {
  const BlockGraph& graph = own_->left.graph;
  std::size_t twice = 0, diagonal = 0;
  for (int a = 0; a < graph.size(); ++a) {
    diagonal += at(graph.dof[at(a)] * graph.dof[at(a)]);
    for (int n = graph.start[at(a)]; n < graph.start[at(a) + 1]; ++n)
      twice += at(graph.dof[at(a)] * graph.dof[at(graph.neighbour[at(n)])]);
  }
  return twice / 2 + diagonal;
}

void ReducedSystem::planBlocks() {
  const ReducedGraph left = std::exchange(own_->left, {});
  std::vector<int> position_in_S(left.block.size());
  std::iota(position_in_S.begin(), position_in_S.end(), 0);
  own_->schur = std::make_unique<SchurComplement>(own_->equations.H(), own_->eliminated_count, 0, left.graph,
                                                  position_in_S);
}

void ReducedSystem::planProducts() {
  own_->left = {};
  own_->products = std::make_unique<ReducedOperator>();
  own_->products->analyze(own_->equations.H(), own_->eliminated_count,
                          ReducedOperator::Preconditioner::schur_jacobi);
}

bool ReducedSystem::isEliminated(int block) const { return own_->eliminated[at(block)] != 0; }
int ReducedSystem::eliminatedCount() const { return own_->eliminated_count; }

void ReducedSystem::beginLinearization() { own_->equations.setZero(); }
void ReducedSystem::add(const JacobianBatch& batch) { own_->equations.add(batch); }
std::span<const MeasurementPlace> ReducedSystem::partitions() const { return own_->equations.partitions(); }
void ReducedSystem::endLinearization() { own_->equations.addUp(); }

const VectorXd& ReducedSystem::gradient() const { return own_->equations.gradient(); }
const VectorXd& ReducedSystem::diagonal() const { return own_->equations.diagonal(); }
double ReducedSystem::squaredNormOfJd(const VectorXd& d) const { return own_->equations.squaredNormOfJd(d); }

SolveStatus ReducedSystem::reduce(const VectorXd& damping, VectorXd& x) {
  if (own_->products != nullptr) {
    // The operator would add the damping of the remaining blocks, too.
    VectorXd of_eliminated = damping;
    for (int j = own_->eliminated_count; damping.size() > 0 && j < own_->equations.H().columns(); ++j)
      of_eliminated.segment(own_->equations.offset()[at(j)], own_->equations.H().dof(j)).setZero();
    const SolveStatus status = own_->products->prepareProducts(own_->equations.H(), own_->equations.offset(),
                                                               of_eliminated, kPivotTolerance);
    own_->is_reduced = status.ok;
    if (status.ok) forward(x);
    return status;
  }
  return own_->schur->reduce(own_->equations.H(), own_->equations.offset(), damping, kPivotTolerance, &x);
}

void ReducedSystem::forEachBlock(const std::function<void(int, int, const double*)>& f) const {
  if (own_->products != nullptr) {
    std::vector<Eigen::MatrixXd> blocks(own_->block_at.size());
    if (own_->is_reduced)
      detail::forEachIndex(static_cast<int>(blocks.size()),
                           [&](int c) { blocks[at(c)] = own_->products->diagonalBlock(c); });
    for (std::size_t c = 0; c < blocks.size(); ++c) f(own_->block_at[c], own_->block_at[c], blocks[c].data());
    return;
  }
  const BlockLower& S = own_->schur->S();
  for (int j = 0; j < S.columns(); ++j) {
    for (int k = S.begin(j); k < S.begin(j + 1); ++k)
      f(own_->block_at[at(S.row(k))], own_->block_at[at(j)], S.values(k));
  }
}

void ReducedSystem::forward(VectorXd& x) const {
  if (own_->products != nullptr) {
    own_->products->eliminated().reduceVector(own_->equations.H(), own_->equations.offset(), x);
  } else {
    own_->schur->forward(own_->equations.H(), own_->equations.offset(), x);
  }
}

void ReducedSystem::multiply(const VectorXd& x, VectorXd& y) {
  const std::vector<int>& offset = own_->equations.offset();
  VectorXd image;
  own_->products->multiply(own_->products->reducedOf(x, offset), image);
  y = VectorXd::Zero(x.size());
  own_->products->putInto(image, offset, y);
}

void ReducedSystem::substitute(VectorXd& x) const {
  if (own_->products != nullptr) {
    own_->products->eliminated().substitute(own_->equations.H(), own_->equations.offset(), x);
  } else {
    own_->schur->substitute(own_->equations.H(), own_->equations.offset(), x);
  }
}

}  // namespace slom
