// What groups have in common: the inverse of their shared unknowns, and groups that are made of smaller ones.
#include <algorithm>
#include <set>

#include <Eigen/Cholesky>

#include "analyze/clustered/cluster_scores.hpp"
#include "analyze/clustered/elimination.hpp"
#include "base/index.hpp"
#include "base/threads.hpp"

namespace slom {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMostSharedForDof = 300;
constexpr int kMostDense = 1500;  // shared unknowns whose information is one dense matrix
/// n^2 / N for n shared of N unknowns, up to which the dense matrix costs less than n columns of H^-1.
constexpr double kMostOfSquares = 100;

/// Places of blocks in a dense matrix; -1 for others.
class DensePlaces {
 public:
  explicit DensePlaces(int blocks) : place_(at(blocks), -1) {}
  void add(int block, int dof) {
    place_[at(block)] = size_;
    size_ += dof;
  }
  int operator[](int block) const { return place_[at(block)]; }
  int size() const { return size_; }

 private:
  std::vector<int> place_;
  int size_ = 0;
};

/// Returns the part of C for the unknowns of a factor.
MatrixXd partOf(const MatrixXd& C, const DensePlaces& places, const ClusterFactor& factor) {
  MatrixXd part(factor.unknowns(), factor.unknowns());
  for (std::size_t a = 0; a < factor.blocks.size(); ++a) {
    for (std::size_t b = 0; b < factor.blocks.size(); ++b) {
      const int rows = factor.sizeOf(a), columns = factor.sizeOf(b);
      part.block(factor.start[a], factor.start[b], rows, columns) =
          C.block(places[factor.blocks[a]], places[factor.blocks[b]], rows, columns);
    }
  }
  return part;
}

/// Adds a matrix on the unknowns of a factor to H.
void addPart(const MatrixXd& N, const DensePlaces& places, const ClusterFactor& factor, MatrixXd& H) {
  for (std::size_t a = 0; a < factor.blocks.size(); ++a) {
    for (std::size_t b = 0; b < factor.blocks.size(); ++b) {
      const int rows = factor.sizeOf(a), columns = factor.sizeOf(b);
      H.block(places[factor.blocks[a]], places[factor.blocks[b]], rows, columns) +=
          N.block(factor.start[a], factor.start[b], rows, columns);
    }
  }
}

/// Adds the measurements without a group.
void addUngrouped(const JacobianRows& rows, const Clustering& clustering, const DensePlaces& places,
                  MatrixXd& H) {
  for (std::size_t p = 0; p < clustering.of_pool.size(); ++p) {
    for (std::size_t i = 0; i < clustering.of_pool[p].size(); ++i) {
      if (clustering.of_pool[p][i] >= 0) continue;
      const int m = static_cast<int>(i);
      rows.forEachPart(p, m, [&](int a, const JacobianRows::Part& Ja) {
        rows.forEachPart(p, m, [&](int b, const JacobianRows::Part& Jb) {
          H.block(places[a], places[b], Ja.cols(), Jb.cols()).noalias() += Ja.transpose() * Jb;
        });
      });
    }
  }
}

/// Inverts H, in which unknowns that nothing depends on have a row of zeros and get the variance 1. Returns an empty
/// matrix if H is not positive definite.
MatrixXd inverseOf(const MatrixXd& H) {
  const VectorXd scale = H.diagonal().unaryExpr([](double h) { return h > 0 ? 1 / std::sqrt(h) : 1.0; });
  MatrixXd scaled = scale.asDiagonal() * H * scale.asDiagonal();
  for (Index i = 0; i < H.rows(); ++i) {
    if (H(i, i) == 0) scaled(i, i) = 1;
  }
  const Eigen::LLT<MatrixXd> cholesky(scaled);
  if (cholesky.info() != Eigen::Success) return {};
  return scale.asDiagonal() * cholesky.solve(MatrixXd::Identity(H.rows(), H.cols())) * scale.asDiagonal();
}

}  // namespace

/// Computes H^-1 of all shared unknowns as one dense matrix, from what the groups say about these unknowns and from the
/// measurements without a group; then finishes all groups. Returns false, with nothing changed, if columns of H^-1 cost
/// less or have more digits, and for a free network.
bool ClusterScores::invertShared(int most_columns) {
  const BlockStructure& structure = linearized_.structure().system;
  DensePlaces places(structure.blockCount());
  for (int b = 0; b < structure.blockCount(); ++b) {
    if (owner_[at(b)] == kSharedBlock) places.add(b, structure.dof(b));
  }
  const int n = places.size();
  const bool has_all =
      std::all_of(factors_.begin(), factors_.end(), [](const auto& f) { return f.has_leverage; });
  if (n == 0 || n > std::min(kMostDense, most_columns) ||
      double(n) * n > kMostOfSquares * structure.unknowns() || gauge_ == FreeGauge::inner_constraints ||
      !has_all)
    return false;
  static_cast<void>(
      linearized_.covarianceTimes(gauge_, MatrixXd(structure.unknowns(), 0)));  // throws if undetermined
  MatrixXd H = MatrixXd::Zero(n, n);
  for (int g = 0; g < count(); ++g) {
    const ClusterFactor& factor = factors_[at(g)];
    addPart(has_rows_[at(g)] != 0 ? MatrixXd(factor.F * factor.F.transpose()) : factor.F, places, factor, H);
  }
  addUngrouped(linearized_.rows(), clustering_, places, H);
  MatrixXd C = inverseOf(H);
  if (C.size() == 0) return false;
  std::vector<int> unknowns;
  for (int b = 0; b < structure.blockCount(); ++b) {
    for (int i = 0; i < (places[b] < 0 ? 0 : structure.dof(b)); ++i)
      unknowns.push_back(structure.offset[at(b)] + i);
  }
  for (int i = 0; i < n; ++i) {
    if (!(C(i, i) > 0) || linearized_.needsMoreDigits(C(i, i) * linearized_.diagonal()[unknowns[at(i)]]))
      return false;
  }
  detail::forEachIndex(count(), [&](int g) { finish(g, partOf(C, places, factors_[at(g)])); });
  shared_ = std::move(unknowns);
  inverse_of_shared_ = std::move(C);
  inverse_is_known_ = true;
  return true;
}

const MatrixXd* ClusterScores::inverseOfShared() const {
  if (inverse_is_known_) return shared_.empty() ? nullptr : &inverse_of_shared_;
  inverse_is_known_ = true;
  const BlockStructure& structure = linearized_.structure().system;
  std::set<int> blocks;
  int unknowns = 0;
  for (const ClusterFactor& factor : factors_) {
    for (const int block : factor.blocks) {
      if (!factor.has_leverage || !blocks.insert(block).second) continue;
      unknowns += structure.dof(block);
      if (unknowns > std::min(kMostSharedForDof, count())) return nullptr;
    }
  }
  for (const int block : blocks) {
    for (int i = 0; i < structure.dof(block); ++i) shared_.push_back(structure.offset[at(block)] + i);
  }
  MatrixXd unit = MatrixXd::Zero(structure.unknowns(), unknowns);
  for (int i = 0; i < unknowns; ++i) unit(shared_[at(i)], i) = 1;
  const MatrixXd columns = linearized_.covarianceTimes(gauge_, unit);
  inverse_of_shared_.resize(unknowns, unknowns);
  for (int i = 0; i < unknowns; ++i) inverse_of_shared_.row(i) = columns.row(shared_[at(i)]);
  return unknowns > 0 ? &inverse_of_shared_ : nullptr;
}

/// Returns the groups of `finer` that make up each group. Returns nothing if one of them is in two groups, has no
/// leverage, or if there are none.
std::vector<std::vector<int>> ClusterScores::partsFrom(const ClusterScores& finer) const {
  std::vector<std::vector<int>> parts(at(count()));
  for (int f = 0; f < finer.count(); ++f) {
    if (!finer.factors_[at(f)].has_leverage) return {};
    int own = -1;
    for (const MeasurementPlace& m : finer.measurements(f)) {
      const int g = clustering_.of_pool[at(m.group)][at(m.index)];
      if (g < 0 || (own >= 0 && g != own)) return {};
      own = g;
    }
    parts[at(own)].push_back(f);
  }
  return parts;
}

/// Computes N and J~^T r of group g, for finish(), from those of its parts: unknowns that parts share with each other
/// alone are eliminated.
void ClusterScores::join(int g, const ClusterScores& finer, const std::vector<int>& parts) {
  const BlockStructure& structure = linearized_.structure().system;
  std::set<int> seen;
  for (const int f : parts)
    seen.insert(finer.factors_[at(f)].blocks.begin(), finer.factors_[at(f)].blocks.end());
  ClusterFactor& factor = factors_[at(g)];
  factor.start.push_back(0);
  DensePlaces places(structure.blockCount());
  for (const int block : seen) {
    if (owner_[at(block)] != kSharedBlock) continue;
    factor.blocks.push_back(block);
    factor.start.push_back(factor.start.back() + structure.dof(block));
    places.add(block, structure.dof(block));
  }
  const int shared = places.size();
  if (shared > kMostSharedUnknowns) return dropLeverage(g);
  for (const int block : seen) {
    if (owner_[at(block)] != kSharedBlock) places.add(block, structure.dof(block));
  }
  MatrixXd N = MatrixXd::Zero(places.size(), places.size());
  MatrixXd gradient = MatrixXd::Zero(places.size(), 1);
  for (const int f : parts) {
    const ClusterFactor& part = finer.factors_[at(f)];
    addPart(part.F * part.F.transpose(), places, part, N);
    const VectorXd score = part.F * part.residual;
    for (std::size_t b = 0; b < part.blocks.size(); ++b)
      gradient.middleRows(places[part.blocks[b]], part.sizeOf(b)) +=
          score.segment(part.start[b], part.sizeOf(b));
  }
  const int own = places.size() - shared;
  MatrixXd right(own, shared + 1);
  right << N.bottomLeftCorner(own, shared), gradient.bottomRows(own);
  factor.F = N.topLeftCorner(shared, shared);
  factor.residual = gradient.topRows(shared);
  eliminate(N.bottomRightCorner(own, own), right, factor.F, factor.residual);
  all_meet_[at(g)] = 0;
}

}  // namespace slom
