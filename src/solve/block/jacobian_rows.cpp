#include "jacobian_rows.hpp"

#include <algorithm>
#include <numeric>
#include <span>

#include "base/index.hpp"

namespace slom {

using Eigen::VectorXd;

void JacobianRows::analyze(const BlockStructure& structure) {
  structure_ = &structure;
  groups_.assign(structure.groups.size(), {});
  clear();
}

void JacobianRows::clear() {
  for (Group& group : groups_) {
    group.row.assign(1, 0);
    group.start.clear();
    group.dof.clear();
    group.r.clear();
    group.J.clear();
  }
}

void JacobianRows::add(const JacobianBatch& batch) {
  Group& group = groups_[static_cast<std::size_t>(batch.group)];
  const int arity = structure_->groups[static_cast<std::size_t>(batch.group)].arity;
  const double* J = batch.J;
  const int* dof = batch.dof;
  const int first = group.row.back();
  for (int m = 0; m < batch.count; ++m, dof += arity) {
    const int columns = std::accumulate(dof, dof + arity, 0);
    group.start.push_back(group.J.size());
    group.J.insert(group.J.end(), J, J + static_cast<std::ptrdiff_t>(batch.rows[m]) * columns);
    group.dof.insert(group.dof.end(), dof, dof + arity);
    group.row.push_back(group.row.back() + batch.rows[m]);
    J += static_cast<std::ptrdiff_t>(batch.rows[m]) * columns;
  }
  group.r.insert(group.r.end(), batch.r, batch.r + (group.row.back() - first));
}

void JacobianRows::multiply(std::size_t g, int m, double by) {
  Group& group = groups_[g];
  const std::size_t i = at(m);
  const std::size_t end = i + 1 < group.start.size() ? group.start[i + 1] : group.J.size();
  for (std::size_t k = group.start[i]; k < end; ++k) group.J[k] *= by;
  for (int k = group.row[i]; k < group.row[i + 1]; ++k) group.r[at(k)] *= by;
}

Eigen::Map<const VectorXd> JacobianRows::residual(std::size_t g, int m) const {
  const Group& group = groups_[g];
  const int first = group.row[static_cast<std::size_t>(m)];
  return {group.r.data() + first, group.row[static_cast<std::size_t>(m) + 1] - first};
}

/// Calls f(g, m) for every measurement.
template <class F>
void JacobianRows::forEach(const F& f) const {
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    for (int m = 0; m + 1 < static_cast<int>(groups_[g].row.size()); ++m) f(g, m);
  }
}

int JacobianRows::rows() const {
  int sum = 0;
  for (const Group& group : groups_) sum += group.row.back();
  return sum;
}

VectorXd JacobianRows::gradient() const {
  VectorXd g = VectorXd::Zero(structure_->unknowns());
  forEach([&](std::size_t group, int m) {
    const auto r = residual(group, m);
    forEachPart(group, m,
                [&](int block, const Part& J) { g.segment(offset(block), J.cols()) += J.transpose() * r; });
  });
  return g;
}

VectorXd JacobianRows::diagonal() const {
  VectorXd sum = VectorXd::Zero(structure_->unknowns());
  forEach([&](std::size_t group, int m) {
    forEachPart(group, m, [&](int block, const Part& J) {
      forEachPart(group, m, [&](int other, const Part& K) {  // the same block may occur twice
        if (other == block)
          sum.segment(offset(block), J.cols()) += J.cwiseProduct(K).colwise().sum().transpose();
      });
    });
  });
  return sum;
}

Eigen::MatrixXd JacobianRows::times(const Eigen::MatrixXd& V) const {
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(rows(), V.cols());
  Eigen::Index row = 0;
  forEach([&](std::size_t group, int m) {
    const Eigen::Index count = residual(group, m).size();
    forEachPart(group, m, [&](int block, const Part& J) {
      product.middleRows(row, count).noalias() += J * V.middleRows(offset(block), J.cols());
    });
    row += count;
  });
  return product;
}

void JacobianRows::sendTo(JacobianSink& sink) const {
  constexpr int most = 64;  // measurements in a batch
  sink.beginLinearization();
  const std::span<const MeasurementPlace> partitions = sink.partitions();
  auto cut = partitions.begin();
  std::vector<int> rows;
  for (int g = 0; g < static_cast<int>(groups_.size()); ++g) {
    const Group& group = groups_[at(g)];
    const int arity = structure_->groups[at(g)].arity;
    for (int first = 0, last = 0; first < size(at(g)); first = last) {
      while (cut != partitions.end() && (cut->group < g || (cut->group == g && cut->index <= first))) ++cut;
      last = std::min(first + most, size(at(g)));
      if (cut != partitions.end() && cut->group == g) last = std::min(last, cut->index);
      rows.clear();
      for (int m = first; m < last; ++m) rows.push_back(group.row[at(m + 1)] - group.row[at(m)]);
      sink.add({g, first, last - first, rows.data(), group.dof.data() + at(first * arity),
                group.r.data() + group.row[at(first)], group.J.data() + group.start[at(first)]});
    }
  }
  sink.endLinearization();
}

double JacobianRows::squaredNormOfJd(const VectorXd& d) const {
  double sum = 0;
  VectorXd image;
  forEach([&](std::size_t group, int m) {
    image = VectorXd::Zero(residual(group, m).size());
    forEachPart(group, m, [&](int block, const Part& J) { image += J * d.segment(offset(block), J.cols()); });
    sum += image.squaredNorm();
  });
  return sum;
}

}  // namespace slom
