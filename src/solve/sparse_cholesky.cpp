#include "slom/solve/sparse_cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>

namespace slom {

namespace {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

/// A pivot below this share of its diagonal entry is rounding error.
constexpr double kPivotTolerance = 1e-12;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Where block (row, col) of the permuted matrix lies: entry (r, c) of it at start + c * height.
struct Destination {
  int start = -1;
  int height = 0;
};

/// Position of each block in a fill-reducing order of the graph of blocks.
std::vector<int> orderBlocks(const BlockStructure& structure) {
  const int n = structure.blockCount();
  std::vector<Eigen::Triplet<char, int>> edges;
  for (const MeasurementGroup& group : structure.groups) {
    for (int m = 0; m < group.size(); ++m) {
      const int* blocks = group.blocks.data() + at(m) * at(group.arity);
      for (int k = 0; k < group.arity; ++k) {
        for (int l = 0; l < k; ++l) {
          if (blocks[k] >= 0 && blocks[l] >= 0 && blocks[k] != blocks[l]) edges.emplace_back(blocks[k], blocks[l], 1);
        }
      }
    }
  }
  for (int b = 0; b < n; ++b) edges.emplace_back(b, b, 1);
  Eigen::SparseMatrix<char, Eigen::ColMajor, int> graph(n, n);
  graph.setFromTriplets(edges.begin(), edges.end(), [](char, char) { return char(1); });
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int> amd;
  amd(graph.selfadjointView<Eigen::Lower>(), order);  // order.indices()[new] = old
  std::vector<int> position(at(n));
  for (int i = 0; i < n; ++i) position[at(order.indices()[i])] = i;
  return position;
}

}  // namespace

struct SparseCholesky::Implementation {
  BlockStructure structure;
  std::vector<int> position;         // of each block in the elimination order
  std::vector<int> permuted_offset;  // of each position: its first unknown in the permuted system
  std::vector<int> permuted;         // of each unknown: its place in the permuted system

  // Upper triangle of the permuted H as compressed columns. The columns of a block share their rows, so each column
  // block is a dense panel whose last rows are the diagonal block (stored whole).
  std::vector<int> column_start, row_index;
  std::vector<double> values;
  std::vector<int> diagonal_at;                         // by unknown
  std::vector<std::vector<Destination>> destinations;   // of each group: measurement x pairs (k <= l)

  VectorXd gradient, diagonal;
  Eigen::SimplicialLDLT<SparseMatrix, Eigen::Upper, Eigen::NaturalOrdering<int>> factor;
  bool analyzed = false;
  bool has_undamped_factor = false;
  SolveStatus undamped_status;
  MatrixXd scratch;

  int unknowns() const { return structure.unknowns(); }
  Map<const SparseMatrix> matrix() const {
    return {unknowns(), unknowns(), static_cast<Index>(values.size()), column_start.data(), row_index.data(),
            values.data()};
  }

  void layOut();
  Destination locate(int row_position, int col_position) const;
  void findDestinations();
  void addMeasurement(const int* blocks, int arity, int rows, const int* dof, const double* r, const double* J,
                      const Destination* destination);
  SolveStatus factorize(const VectorXd& damping);
  VectorXd permute(const VectorXd& x) const;

  // Layout by position: row blocks of column block j are block_rows[first_row[j]..first_row[j+1]), ascending, and
  // block_row_at gives the row within the panel.
  std::vector<int> first_row, block_rows, block_row_at, panel_start, panel_height;
};

void SparseCholesky::Implementation::layOut() {
  const int n = structure.blockCount();
  std::vector<int> block_at(at(n));
  for (int b = 0; b < n; ++b) block_at[at(position[at(b)])] = b;
  permuted_offset.assign(at(n) + 1, 0);
  for (int p = 0; p < n; ++p) permuted_offset[at(p) + 1] = permuted_offset[at(p)] + structure.dof(block_at[at(p)]);
  permuted.resize(at(unknowns()));
  for (int b = 0; b < n; ++b) {
    for (int c = 0; c < structure.dof(b); ++c) {
      permuted[at(structure.offset[at(b)] + c)] = permuted_offset[at(position[at(b)])] + c;
    }
  }

  std::vector<std::uint64_t> pairs;  // column position, row position <= column position
  for (int p = 0; p < n; ++p) pairs.push_back((std::uint64_t(p) << 32) | std::uint64_t(p));
  for (const MeasurementGroup& group : structure.groups) {
    for (int m = 0; m < group.size(); ++m) {
      const int* blocks = group.blocks.data() + at(m) * at(group.arity);
      for (int k = 0; k < group.arity; ++k) {
        for (int l = 0; l < k; ++l) {
          if (blocks[k] < 0 || blocks[l] < 0) continue;
          const int a = position[at(blocks[k])], b = position[at(blocks[l])];
          pairs.push_back((std::uint64_t(std::max(a, b)) << 32) | std::uint64_t(std::min(a, b)));
        }
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());

  first_row.assign(at(n) + 1, 0);
  block_rows.clear();
  block_row_at.clear();
  panel_start.assign(at(n), 0);
  panel_height.assign(at(n), 0);
  column_start.assign(1, 0);
  row_index.clear();
  diagonal_at.assign(at(unknowns()), -1);
  std::size_t next = 0;
  for (int p = 0; p < n; ++p) {
    panel_start[at(p)] = column_start.back();
    int height = 0;
    for (; next < pairs.size() && int(pairs[next] >> 32) == p; ++next) {
      const int row = static_cast<int>(pairs[next] & 0xffffffffu);
      block_rows.push_back(row);
      block_row_at.push_back(height);
      height += permuted_offset[at(row) + 1] - permuted_offset[at(row)];
    }
    first_row[at(p) + 1] = static_cast<int>(block_rows.size());
    panel_height[at(p)] = height;
    const int dof = permuted_offset[at(p) + 1] - permuted_offset[at(p)];
    for (int c = 0; c < dof; ++c) {
      diagonal_at[at(structure.offset[at(block_at[at(p)])] + c)] = column_start.back() + height - dof + c;
      for (int q = first_row[at(p)]; q < first_row[at(p) + 1]; ++q) {
        const int row = block_rows[at(q)];
        for (int i = permuted_offset[at(row)]; i < permuted_offset[at(row) + 1]; ++i) row_index.push_back(i);
      }
      column_start.push_back(static_cast<int>(row_index.size()));
    }
  }
  values.assign(row_index.size(), 0.0);
}

Destination SparseCholesky::Implementation::locate(int row_position, int col_position) const {
  const auto begin = block_rows.begin() + first_row[at(col_position)];
  const auto end = block_rows.begin() + first_row[at(col_position) + 1];
  const auto found = std::lower_bound(begin, end, row_position);
  return {panel_start[at(col_position)] + block_row_at[at(found - block_rows.begin())], panel_height[at(col_position)]};
}

void SparseCholesky::Implementation::findDestinations() {
  destinations.assign(structure.groups.size(), {});
  for (std::size_t g = 0; g < structure.groups.size(); ++g) {
    const MeasurementGroup& group = structure.groups[g];
    destinations[g].reserve(at(group.size()) * at(group.arity * (group.arity + 1) / 2));
    for (int m = 0; m < group.size(); ++m) {
      const int* blocks = group.blocks.data() + at(m) * at(group.arity);
      for (int k = 0; k < group.arity; ++k) {
        for (int l = k; l < group.arity; ++l) {
          if (blocks[k] < 0 || blocks[l] < 0) {
            destinations[g].push_back({});
            continue;
          }
          const int a = position[at(blocks[k])], b = position[at(blocks[l])];
          destinations[g].push_back(locate(std::min(a, b), std::max(a, b)));
        }
      }
    }
  }
}

SparseCholesky::SparseCholesky() : self_(std::make_unique<Implementation>()) {}
SparseCholesky::~SparseCholesky() = default;

void SparseCholesky::analyze(const BlockStructure& structure) {
  self_->structure = structure;
  self_->position = orderBlocks(structure);
  self_->layOut();
  self_->findDestinations();
  self_->analyzed = false;
  self_->has_undamped_factor = false;
}

void SparseCholesky::beginLinearization() {
  std::fill(self_->values.begin(), self_->values.end(), 0.0);
  self_->gradient = VectorXd::Zero(self_->unknowns());
  self_->has_undamped_factor = false;
}

void SparseCholesky::add(const JacobianBatch& batch) {
  const MeasurementGroup& group = self_->structure.groups[at(batch.group)];
  const int arity = group.arity;
  const Index pairs = arity * (arity + 1) / 2;
  const double* r = batch.r;
  const double* J = batch.J;
  for (int m = 0; m < batch.count; ++m) {
    const Index i = batch.first + m;
    const int* dof = batch.dof + m * arity;
    const int rows = batch.rows[m];
    self_->addMeasurement(group.blocks.data() + i * arity, arity, rows, dof, r, J,
                          self_->destinations[at(batch.group)].data() + i * pairs);
    r += rows;
    for (int k = 0; k < arity; ++k) J += static_cast<std::ptrdiff_t>(rows) * dof[k];
  }
}

void SparseCholesky::Implementation::addMeasurement(const int* blocks, int arity, int rows, const int* dof,
                                                    const double* r, const double* J, const Destination* destination) {
  const Map<const VectorXd> residual(r, rows);
  const double* Jk_at = J;
  for (int k = 0; k < arity; ++k) {
    const Map<const MatrixXd> Jk(Jk_at, rows, dof[k]);
    if (blocks[k] >= 0) {
      gradient.segment(structure.offset[at(blocks[k])], dof[k]).noalias() += Jk.transpose().lazyProduct(residual);
    }
    const double* Jl_at = Jk_at;
    for (int l = k; l < arity; ++l, ++destination) {
      const Map<const MatrixXd> Jl(Jl_at, rows, dof[l]);
      Jl_at += static_cast<std::ptrdiff_t>(rows) * dof[l];
      if (blocks[k] < 0 || blocks[l] < 0) continue;
      const bool in_order = position[at(blocks[k])] <= position[at(blocks[l])];
      Map<MatrixXd, 0, Eigen::OuterStride<>> H(values.data() + destination->start, in_order ? dof[k] : dof[l],
                                               in_order ? dof[l] : dof[k], Eigen::OuterStride<>(destination->height));
      if (in_order) {
        H.noalias() += Jk.transpose().lazyProduct(Jl);
      } else {
        H.noalias() += Jl.transpose().lazyProduct(Jk);
      }
      if (k != l && blocks[k] == blocks[l]) H.noalias() += Jl.transpose().lazyProduct(Jk);
    }
    Jk_at += static_cast<std::ptrdiff_t>(rows) * dof[k];
  }
}

void SparseCholesky::endLinearization() {
  self_->diagonal.resize(self_->unknowns());
  for (int i = 0; i < self_->unknowns(); ++i) self_->diagonal[i] = self_->values[at(self_->diagonal_at[at(i)])];
}

/// Factorises H + damping, whose diagonal entries are put in for as long as it takes.
SolveStatus SparseCholesky::Implementation::factorize(const VectorXd& damping) {
  const int n = unknowns();
  if (damping.size() == 0 && has_undamped_factor) return undamped_status;
  VectorXd reference = diagonal;
  if (damping.size() > 0) reference += damping;
  for (int i = 0; i < n; ++i) values[at(diagonal_at[at(i)])] = reference[i];
  if (!analyzed) factor.analyzePattern(matrix());
  analyzed = true;
  factor.factorize(matrix());
  for (int i = 0; i < n; ++i) values[at(diagonal_at[at(i)])] = diagonal[i];

  SolveStatus status;
  const auto& D = factor.vectorD();
  int first_bad = n;
  for (int i = 0; i < n; ++i) {
    const int p = permuted[at(i)];
    if (p >= first_bad || D[p] > kPivotTolerance * reference[i]) continue;
    first_bad = p;
    status = {false, i, reference[i] > 0 ? std::max(0.0, D[p] / reference[i]) : 0.0};
  }
  has_undamped_factor = damping.size() == 0;
  if (has_undamped_factor) undamped_status = status;
  return status;
}

SolveStatus SparseCholesky::solve(const VectorXd& damping, VectorXd& step) {
  const SolveStatus status = self_->factorize(damping);
  if (!status.ok) return status;
  const VectorXd permuted_step = self_->factor.solve(self_->permute(-self_->gradient));
  step.resize(self_->unknowns());
  for (int i = 0; i < self_->unknowns(); ++i) step[i] = permuted_step[self_->permuted[at(i)]];
  return {};
}

VectorXd SparseCholesky::Implementation::permute(const VectorXd& x) const {
  VectorXd y(x.size());
  for (Index i = 0; i < x.size(); ++i) y[permuted[at(i)]] = x[i];
  return y;
}

SolveStatus SparseCholesky::solveFor(const MatrixXd& B, MatrixXd& X) {
  const SolveStatus status = self_->factorize(VectorXd());
  if (!status.ok) return status;
  X.resize(B.rows(), B.cols());
  for (Index j = 0; j < B.cols(); ++j) {
    const VectorXd column = self_->factor.solve(self_->permute(B.col(j)));
    for (Index i = 0; i < B.rows(); ++i) X(i, j) = column[self_->permuted[at(i)]];
  }
  return {};
}

const VectorXd& SparseCholesky::gradient() const { return self_->gradient; }
const VectorXd& SparseCholesky::diagonal() const { return self_->diagonal; }

double SparseCholesky::squaredImage(const VectorXd& d) const {
  const VectorXd p = self_->permute(d);
  return p.dot(self_->matrix().selfadjointView<Eigen::Upper>() * p);
}

std::string SparseCholesky::description() const {
  return "sparse block normal equations, simplicial LDL^T, " + std::to_string(self_->unknowns()) + " unknowns in " +
         std::to_string(self_->structure.blockCount()) + " blocks";
}

}  // namespace slom
