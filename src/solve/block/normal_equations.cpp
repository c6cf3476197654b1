#include "normal_equations.hpp"

#include <algorithm>

#include "linearize/parallel.hpp"
#include "solve/dense/kernels.hpp"
#include "solve/dense/prefetch.hpp"

namespace slom {

namespace {
std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Measurements after which what is fetched is needed.
constexpr int kAhead = 4;

/// For a few numbers faster than std::fill_n, which calls memset.
void clear(double* x, int n) { Eigen::Map<Eigen::VectorXd>(x, n).setZero(); }
}  // namespace

void NormalEquations::layOut(const BlockStructure& structure, const BlockGraph& graph,
                             const std::vector<int>& position) {
  structure_ = &structure;
  H_.layOut(graph, position);
  gradient_ = Eigen::VectorXd::Zero(structure.unknowns());
  offset_.resize(position.size());
  place_.resize(position.size());
  for (int b = 0; b < graph.size(); ++b) {
    const int column = position[at(b)];
    offset_[at(column)] = structure.offset[at(b)];
    place_[at(b)] = {column, H_.values(H_.begin(column)), gradient_.data() + structure.offset[at(b)]};
  }
  findDestinations();
}

void NormalEquations::findDestinations() {
  destination_.assign(structure_->groups.size(), {});
  work_.assign(place_.size() + 1, 0.0);
  std::vector<char> is_touched(at(H_.begin(H_.columns())), 0);
  const auto products = [&](int a, int b) { return static_cast<double>(structure_->dof(a)) * structure_->dof(b); };
  for (std::size_t g = 0; g < structure_->groups.size(); ++g) {
    const MeasurementGroup& group = structure_->groups[g];
    destination_[g].reserve(at(group.size()) * at(group.arity * (group.arity - 1) / 2));
    for (int m = 0; m < group.size(); ++m) {
      const int* blocks = group.blocks.data() + at(m) * at(group.arity);
      for (int k = 0; k < group.arity; ++k) {
        if (blocks[k] >= 0) work_[at(position(blocks[k])) + 1] += products(blocks[k], blocks[k]);
        for (int l = k + 1; l < group.arity; ++l) {
          if (blocks[k] < 0 || blocks[l] < 0) {
            destination_[g].push_back({-1, 0});
            continue;
          }
          const int a = position(blocks[k]), b = position(blocks[l]),
                    block = H_.find(std::max(a, b), std::min(a, b));
          destination_[g].push_back({block, a != b && is_touched[at(block)] == 0});
          is_touched[at(block)] = 1;
          work_[at(std::min(a, b)) + 1] += products(blocks[k], blocks[l]);
        }
      }
    }
  }
  for (std::size_t j = 1; j < work_.size(); ++j) work_[j] += work_[j - 1];
  for (int j = 0; j < H_.columns(); ++j) {  // what nothing is ever added to
    for (int k = H_.begin(j) + 1; k < H_.begin(j + 1); ++k) {
      if (!is_touched[at(k)]) clear(H_.values(k), H_.dof(j) * H_.dof(H_.row(k)));
    }
  }
}

/// The blocks off the diagonal get their zeros when something is added to them first: then they are in the
/// cache.
void NormalEquations::setZero() {
  std::fill_n(H_.values(0), H_.diagonalSize(), 0.0);
  gradient_.setZero();
}

void NormalEquations::add(std::span<const JacobianBatch> batches) {
  const int parts = batches.size() > 1 ? tbb::this_task_arena::max_concurrency() : 1;
  detail::forEachRange(work_, parts, [&](int first, int last) {
    for (const JacobianBatch& batch : batches) addColumns(batch, first, last);
  });
}

/// The numbers of a block off the diagonal, which have a value.
double* NormalEquations::begun(Destination destination, int size) {
  double* const values = H_.values(destination.block);
  if (destination.is_first) clear(values, size);
  return values;
}

/// What a measurement of two free variables adds to the columns [first, last), at once, to the same bits as one after
/// the other. Returns false, with nothing added, where that is not possible.
bool NormalEquations::addPair(const dense::Kernels& kernel, int rows, const int* blocks, const int* dof,
                              Destination destination, const double* J, const double* r, int first, int last) {
  if (blocks[0] < 0 || blocks[1] < 0 || blocks[0] == blocks[1]) return false;
  const Place* const place[] = {&place_[at(blocks[0])], &place_[at(blocks[1])]};
  const int later = place[0]->column > place[1]->column ? 0 : 1, earlier = 1 - later;
  const auto is_meant = [&](int k) { return first <= place[k]->column && place[k]->column < last; };
  dense::PairTarget to{};
  if (is_meant(later)) {
    to.AA = place[later]->diagonal;
    to.Ar = place[later]->gradient;
  }
  if (is_meant(earlier)) {
    to.BB = place[earlier]->diagonal;
    to.Br = place[earlier]->gradient;
    to.AB = H_.values(destination.block);
    to.AB_is_new = destination.is_first != 0;
  }
  if (to.AA == nullptr && to.BB == nullptr) return true;
  const double* const of[] = {J, J + static_cast<std::ptrdiff_t>(rows) * dof[0]};
  return kernel.addPair(rows, dof[later], dof[earlier], of[later], of[earlier], r, to);
}

/// Where a measurement of two variables will add to, as far as it is in the columns [first, last): others are another
/// thread's.
void NormalEquations::prefetch(const int* blocks, Destination destination, int first, int last) const {
  int earliest = last;
  for (int k = 0; k < 2; ++k) {
    if (blocks[k] < 0) return;
    const Place& place = place_[at(blocks[k])];
    earliest = std::min(earliest, place.column);
    if (first <= place.column && place.column < last) dense::prefetch(place.diagonal, place.diagonal + 1);
  }
  if (first <= earliest && earliest < last)
    dense::prefetch(H_.values(destination.block), H_.values(destination.block + 1));
}

/// What the batch adds to the columns [first, last) of H and to their entries of g.
void NormalEquations::addColumns(const JacobianBatch& batch, int first, int last) {
  const dense::Kernels& kernel = dense::kernels();
  const auto add_product = kernel.addProduct;
  const MeasurementGroup& group = structure_->groups[at(batch.group)];
  const int arity = group.arity;
  const double* r = batch.r;
  const double* J = batch.J;
  const Destination* destination =
      destination_[at(batch.group)].data() + at(batch.first) * at(arity * (arity - 1) / 2);
  const int* blocks = group.blocks.data() + at(batch.first) * at(arity);
  const int* dof = batch.dof;
  for (int m = 0; m < batch.count; ++m, blocks += arity, dof += arity) {
    const int rows = batch.rows[m];
    if (arity == 2 && m + kAhead < batch.count)
      prefetch(blocks + 2 * kAhead, destination[kAhead], first, last);
    if (arity == 2 && addPair(kernel, rows, blocks, dof, *destination, J, r, first, last)) {
      ++destination;
      J += static_cast<std::ptrdiff_t>(rows) * (dof[0] + dof[1]);
      r += rows;
      continue;
    }
    for (int k = 0; k < arity; ++k) {
      const double* const Jk = J;
      J += static_cast<std::ptrdiff_t>(rows) * dof[k];
      if (blocks[k] < 0) {
        destination += arity - 1 - k;
        continue;
      }
      const Place& place = place_[at(blocks[k])];
      const int column = place.column;
      if (first <= column && column < last) {
        add_product(rows, dof[k], 1, Jk, r, place.gradient);
        add_product(rows, dof[k], dof[k], Jk, Jk, place.diagonal);
      }
      const double* Jl = J;
      for (int l = k + 1; l < arity; ++l, ++destination) {
        const double* const Jl_here = Jl;
        Jl += static_cast<std::ptrdiff_t>(rows) * dof[l];
        if (blocks[l] < 0) continue;
        const int other = position(blocks[l]), earlier = std::min(column, other);
        if (earlier < first || earlier >= last) continue;
        double* const H = begun(*destination, dof[k] * dof[l]);
        if (other >= column) add_product(rows, dof[l], dof[k], Jl_here, Jk, H);
        if (other <= column) add_product(rows, dof[k], dof[l], Jk, Jl_here, H);
      }
    }
    r += rows;
  }
}

void NormalEquations::diagonal(Eigen::VectorXd& result) const {
  result.resize(gradient_.size());
  for (int j = 0; j < H_.columns(); ++j) {
    const double* const block = H_.values(H_.begin(j));
    for (int i = 0; i < H_.dof(j); ++i) result[offset_[at(j)] + i] = block[i * H_.dof(j) + i];
  }
}

double NormalEquations::squaredImage(const Eigen::VectorXd& d) const {
  return H_.squaredForm(offset_, d.data());
}

}  // namespace slom
