#include "normal_equations.hpp"

#include <algorithm>

#include "linearize/parallel.hpp"
#include "solve/dense/kernels.hpp"

namespace slom {

namespace {
std::size_t at(int i) { return static_cast<std::size_t>(i); }
}  // namespace

void NormalEquations::layOut(const BlockStructure& structure, const BlockGraph& graph, const std::vector<int>& position) {
  structure_ = &structure;
  position_ = position;
  H_.layOut(graph, position);
  offset_.resize(position.size());
  for (int b = 0; b < graph.size(); ++b) offset_[at(position[at(b)])] = structure.offset[at(b)];
  gradient_ = Eigen::VectorXd::Zero(structure.unknowns());
  findDestinations();
}

void NormalEquations::findDestinations() {
  destination_.assign(structure_->groups.size(), {});
  work_.assign(position_.size() + 1, 0.0);
  for (std::size_t g = 0; g < structure_->groups.size(); ++g) {
    const MeasurementGroup& group = structure_->groups[g];
    destination_[g].reserve(at(group.size()) * at(group.arity * (group.arity - 1) / 2));
    for (int m = 0; m < group.size(); ++m) {
      const int* blocks = group.blocks.data() + at(m) * at(group.arity);
      for (int k = 0; k < group.arity; ++k) {
        if (blocks[k] >= 0) ++work_[at(position_[at(blocks[k])]) + 1];
        for (int l = k + 1; l < group.arity; ++l) {
          if (blocks[k] < 0 || blocks[l] < 0) {
            destination_[g].push_back(-1);
            continue;
          }
          const int a = position_[at(blocks[k])], b = position_[at(blocks[l])];
          destination_[g].push_back(H_.find(std::max(a, b), std::min(a, b)));
          ++work_[at(std::min(a, b)) + 1];
        }
      }
    }
  }
  for (std::size_t j = 1; j < work_.size(); ++j) work_[j] += work_[j - 1];
}

void NormalEquations::setZero() {
  H_.setZero();
  gradient_.setZero();
}

void NormalEquations::add(std::span<const JacobianBatch> batches) {
  const int parts = batches.size() > 1 ? tbb::this_task_arena::max_concurrency() : 1;
  detail::forEachRange(work_, parts, [&](int first, int last) {
    for (const JacobianBatch& batch : batches) addColumns(batch, first, last);
  });
}

/// What the batch adds to the columns [first, last) of H and to their entries of g.
void NormalEquations::addColumns(const JacobianBatch& batch, int first, int last) {
  const auto add_product = dense::kernels().addProduct;
  const MeasurementGroup& group = structure_->groups[at(batch.group)];
  const int arity = group.arity;
  const double* r = batch.r;
  const double* J = batch.J;
  const int* destination = destination_[at(batch.group)].data() + at(batch.first) * at(arity * (arity - 1) / 2);
  const int* blocks = group.blocks.data() + at(batch.first) * at(arity);
  const int* dof = batch.dof;
  for (int m = 0; m < batch.count; ++m, blocks += arity, dof += arity) {
    const int rows = batch.rows[m];
    for (int k = 0; k < arity; ++k) {
      const double* const Jk = J;
      J += static_cast<std::ptrdiff_t>(rows) * dof[k];
      if (blocks[k] < 0) {
        destination += arity - 1 - k;
        continue;
      }
      const int column = position_[at(blocks[k])];
      if (first <= column && column < last) {
        double* const g = gradient_.data() + offset_[at(column)];
        for (int i = 0; i < dof[k]; ++i) {
          for (int row = 0; row < rows; ++row) g[i] += Jk[i * rows + row] * r[row];
        }
        add_product(rows, dof[k], dof[k], Jk, Jk, H_.values(H_.begin(column)));
      }
      const double* Jl = J;
      for (int l = k + 1; l < arity; ++l, ++destination) {
        const double* const Jl_here = Jl;
        Jl += static_cast<std::ptrdiff_t>(rows) * dof[l];
        if (blocks[l] < 0) continue;
        const int other = position_[at(blocks[l])], earlier = std::min(column, other);
        if (earlier < first || earlier >= last) continue;
        double* const H = H_.values(*destination);
        if (other >= column) add_product(rows, dof[l], dof[k], Jl_here, Jk, H);
        if (other <= column) add_product(rows, dof[k], dof[l], Jk, Jl_here, H);
      }
    }
    r += rows;
  }
}

Eigen::VectorXd NormalEquations::diagonal() const {
  Eigen::VectorXd result(gradient_.size());
  for (int j = 0; j < H_.columns(); ++j) {
    const double* const block = H_.values(H_.begin(j));
    for (int i = 0; i < H_.dof(j); ++i) result[offset_[at(j)] + i] = block[i * H_.dof(j) + i];
  }
  return result;
}

double NormalEquations::squaredImage(const Eigen::VectorXd& d) const { return H_.squaredForm(offset_, d.data()); }

}  // namespace slom
