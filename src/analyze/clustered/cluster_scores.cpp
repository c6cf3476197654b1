#include "analyze/clustered/cluster_scores.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "analyze/clustered/elimination.hpp"
#include "base/decompositions.hpp"
#include "base/index.hpp"
#include "base/threads.hpp"

namespace slom {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kUnseen = -1;                 // value in owner_, as kSharedBlock is
constexpr int kMostPrivateUnknowns = 2000;  // of one group, in one component of its private blocks
constexpr int kFewSharedUnknowns = 64;      // of all groups; so few columns cost less than selected inversion
constexpr double kLeastVariance = 1e-12;    // eigenvalues of a correlation matrix that count as 0
constexpr double kLeastLeverage = 1e-10;    // eigenvalues of H_gg that count as 0
/// 1 - lambda below which a group alone determines a direction. Leverages have at least 6 digits, as LinearizedProblem
/// ensures.
constexpr double kAlone = 1e-6;

int placeOf(const std::vector<int>& sorted, int block) {
  return static_cast<int>(std::lower_bound(sorted.begin(), sorted.end(), block) - sorted.begin());
}

/// The private blocks of a group, by components: blocks of one component are connected by measurements of the group.
struct PrivateBlocks {
  std::vector<int> blocks, component, start;  // by block: its component, and its first row there
  std::vector<int> size;                      // by component: number of unknowns

  PrivateBlocks(std::vector<int> all)
      : blocks(std::move(all)), component(blocks.size()), start(blocks.size()) {
    std::iota(component.begin(), component.end(), 0);
  }
  int rootOf(int b) {
    while (component[at(b)] != b) b = component[at(b)] = component[at(component[at(b)])];
    return b;
  }
  void join(int a, int b) { component[at(rootOf(a))] = rootOf(b); }
  /// Numbers the components; block b has dof(b) unknowns.
  template <class F>
  void number(const F& dof) {
    std::vector<int> root(blocks.size()), number_of(blocks.size(), -1);
    for (int b = 0; b < static_cast<int>(blocks.size()); ++b) root[at(b)] = rootOf(b);
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      int& own = number_of[at(root[b])];
      if (own < 0) {
        own = static_cast<int>(size.size());
        size.push_back(0);
      }
      component[b] = own;
      start[b] = size[at(own)];
      size[at(own)] += dof(blocks[b]);
    }
  }
};

}  // namespace

ClusterScores::ClusterScores(const LinearizedProblem& linearized, FreeGauge gauge, Clustering clustering,
                             int most_columns, const ClusterScores* finer)
    : linearized_(linearized), gauge_(gauge), clustering_(std::move(clustering)) {
  collectMeasurements();
  findOwners();
  factors_.resize(at(count()));
  all_meet_.assign(at(count()), 1);
  has_rows_.assign(at(count()), 0);
  const JacobianRows& rows = linearized.rows();
  static_cast<void>(rows);  // linearises before the threads begin
  const auto parts = finer != nullptr ? partsFrom(*finer) : std::vector<std::vector<int>>{};
  detail::forEachIndex(count(), [&](int g) { parts.empty() ? reduce(g) : join(g, *finer, parts[at(g)]); });
  if (!invertShared(most_columns)) addInverses(most_columns);
  const double groups = count(), residuals = linearized.structure().residuals;
  const double unknowns =
      linearized.freeUnknowns() - (gauge == FreeGauge::inner_constraints ? linearized.freeDirections() : 0);
  cr1_ = (groups > 1 ? groups / (groups - 1) : 1) *
         (residuals > unknowns ? (residuals - 1) / (residuals - unknowns) : 1);
  for (const ClusterFactor& factor : factors_) without_leverage_ += factor.has_leverage ? 0 : 1;
}

void ClusterScores::collectMeasurements() {
  measurements_.resize(at(count()));
  for (std::size_t p = 0; p < clustering_.of_pool.size(); ++p) {
    const std::vector<int>& of = clustering_.of_pool[p];
    for (std::size_t i = 0; i < of.size(); ++i) {
      if (of[i] >= 0) measurements_[at(of[i])].push_back({static_cast<int>(p), static_cast<int>(i)});
    }
  }
}

void ClusterScores::findOwners() {
  const BlockStructure& structure = linearized_.structure().system;
  owner_.assign(at(structure.blockCount()), kUnseen);
  for (std::size_t p = 0; p < clustering_.of_pool.size(); ++p) {
    const std::vector<int>& of = clustering_.of_pool[p];
    const MeasurementGroup& shape = structure.groups[p];
    for (std::size_t k = 0; k < shape.blocks.size(); ++k) {
      if (shape.blocks[k] < 0) continue;
      const int group = of[k / at(shape.arity)];
      int& owner = owner_[at(shape.blocks[k])];
      owner = group < 0 || (owner != kUnseen && owner != group) ? kSharedBlock : group;
    }
  }
}

/// Computes N in F and J~^T r in residual, for finish().
void ClusterScores::reduce(int g) {
  const JacobianRows& rows = linearized_.rows();
  const BlockStructure& structure = linearized_.structure().system;
  std::vector<int> seen;
  for (const MeasurementPlace& m : measurements(g))
    rows.forEachPart(at(m.group), m.index, [&](int block, const auto&) { seen.push_back(block); });
  std::sort(seen.begin(), seen.end());
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  ClusterFactor& factor = factors_[at(g)];
  std::vector<int> own;
  factor.start.push_back(0);
  for (const int block : seen) {
    if (owner_[at(block)] == g) {
      own.push_back(block);
      continue;
    }
    factor.blocks.push_back(block);
    factor.start.push_back(factor.start.back() + structure.dof(block));
  }
  const auto is_private = [&](int block) { return owner_[at(block)] == g; };
  PrivateBlocks components(std::move(own));
  for (const MeasurementPlace& m : measurements(g)) {
    int first = -1;
    rows.forEachPart(at(m.group), m.index, [&](int block, const auto&) {
      if (!is_private(block)) return;
      const int place = placeOf(components.blocks, block);
      if (first >= 0) components.join(place, first);
      first = place;
    });
  }
  components.number([&](int block) { return structure.dof(block); });
  const int shared = factor.unknowns();
  if (shared > kMostSharedUnknowns || std::any_of(components.size.begin(), components.size.end(),
                                                  [](int size) { return size > kMostPrivateUnknowns; }))
    return dropLeverage(g);

  if (components.blocks.empty() && keepRows(g)) return;

  MatrixXd N = MatrixXd::Zero(shared, shared);
  VectorXd gradient = VectorXd::Zero(shared);
  std::vector<MatrixXd> Gpp, Gps;
  std::vector<VectorXd> gp;
  for (const int size : components.size) {
    Gpp.push_back(MatrixXd::Zero(size, size));
    Gps.push_back(MatrixXd::Zero(size, shared + 1));  // the last column: J_p^T r
  }
  const std::size_t blocks = factor.blocks.size();
  std::vector<char> meet(blocks * blocks, 0);
  for (const MeasurementPlace& m : measurements(g)) {
    const auto r = rows.residual(at(m.group), m.index);
    rows.forEachPart(at(m.group), m.index, [&](int a, const JacobianRows::Part& Ja) {
      const bool a_is_private = is_private(a);
      const int ia = placeOf(a_is_private ? components.blocks : factor.blocks, a);
      if (a_is_private) {
        Gps[at(components.component[at(ia)])].col(shared).segment(components.start[at(ia)], Ja.cols()) +=
            Ja.transpose() * r;
      } else {
        gradient.segment(factor.start[at(ia)], Ja.cols()) += Ja.transpose() * r;
      }
      rows.forEachPart(at(m.group), m.index, [&](int b, const JacobianRows::Part& Jb) {
        const bool b_is_private = is_private(b);
        if (!a_is_private && b_is_private) return;
        const int ib = placeOf(b_is_private ? components.blocks : factor.blocks, b);
        if (!a_is_private) {
          meet[at(ia) * blocks + at(ib)] = 1;
          N.block(factor.start[at(ia)], factor.start[at(ib)], Ja.cols(), Jb.cols()).noalias() +=
              Ja.transpose() * Jb;
        } else if (b_is_private) {
          Gpp[at(components.component[at(ia)])]
              .block(components.start[at(ia)], components.start[at(ib)], Ja.cols(), Jb.cols())
              .noalias() += Ja.transpose() * Jb;
        } else {
          Gps[at(components.component[at(ia)])]
              .block(components.start[at(ia)], factor.start[at(ib)], Ja.cols(), Jb.cols())
              .noalias() += Ja.transpose() * Jb;
        }
      });
    });
  }
  for (std::size_t c = 0; c < Gpp.size(); ++c) eliminate(Gpp[c], Gps[c], N, gradient);
  all_meet_[at(g)] = std::all_of(meet.begin(), meet.end(), [](char c) { return c != 0; }) ? 1 : 0;
  factor.F = (N + N.transpose()) / 2;
  factor.residual = std::move(gradient);
}

/// Keeps J_g^T in F and r_g in residual, for finishRows(). Applies to a group without private blocks that has fewer
/// residuals than unknowns; returns whether g is one.
bool ClusterScores::keepRows(int g) {
  const JacobianRows& rows = linearized_.rows();
  ClusterFactor& factor = factors_[at(g)];
  Index size = 0, row = 0;
  for (const MeasurementPlace& m : measurements(g)) size += rows.residual(at(m.group), m.index).size();
  if (size >= factor.unknowns()) return false;
  has_rows_[at(g)] = 1;
  factor.F = MatrixXd::Zero(factor.unknowns(), size);
  factor.residual.resize(size);
  const std::size_t blocks = factor.blocks.size();
  std::vector<char> meet(blocks * blocks, 0);
  for (const MeasurementPlace& m : measurements(g)) {
    const auto r = rows.residual(at(m.group), m.index);
    factor.residual.segment(row, r.size()) = r;
    rows.forEachPart(at(m.group), m.index, [&](int a, const JacobianRows::Part& J) {
      const int ia = placeOf(factor.blocks, a);
      factor.F.block(factor.start[at(ia)], row, J.cols(), J.rows()) += J.transpose();
      rows.forEachPart(at(m.group), m.index, [&](int b, const JacobianRows::Part&) {
        meet[at(ia) * blocks + at(placeOf(factor.blocks, b))] = 1;
      });
    });
    row += r.size();
  }
  all_meet_[at(g)] = std::all_of(meet.begin(), meet.end(), [](char c) { return c != 0; }) ? 1 : 0;
  return true;
}

void ClusterScores::dropLeverage(int g) {
  const JacobianRows& rows = linearized_.rows();
  const BlockStructure& structure = linearized_.structure().system;
  std::map<int, VectorXd> gradient;
  for (const MeasurementPlace& m : measurements(g)) {
    const auto r = rows.residual(at(m.group), m.index);
    rows.forEachPart(at(m.group), m.index, [&](int block, const JacobianRows::Part& J) {
      VectorXd& own = gradient[block];
      if (own.size() == 0) own = VectorXd::Zero(structure.dof(block));
      own += J.transpose() * r;
    });
  }
  ClusterFactor& factor = factors_[at(g)];
  factor = ClusterFactor{};
  factor.has_leverage = false;
  factor.start.push_back(0);
  for (const auto& [block, part] : gradient) {
    factor.blocks.push_back(block);
    factor.start.push_back(factor.start.back() + structure.dof(block));
  }
  factor.residual.resize(factor.unknowns());
  int k = 0;
  for (const auto& [block, part] : gradient)
    factor.residual.segment(factor.start[at(k++)], part.size()) = part;
}

void ClusterScores::addInverses(int most_columns) {
  const BlockStructure& structure = linearized_.structure().system;
  int shared = 0;
  for (int b = 0; b < structure.blockCount(); ++b)
    shared += owner_[at(b)] == kSharedBlock ? structure.dof(b) : 0;
  const bool by_columns = shared <= std::min(kFewSharedUnknowns, most_columns);
  std::vector<int> by_inverse, others;
  for (int g = 0; g < count(); ++g) {
    if (factors_[at(g)].has_leverage)
      (all_meet_[at(g)] != 0 && !by_columns ? by_inverse : others).push_back(g);
  }
  if (!by_inverse.empty()) {
    const InverseBlocks& inverse = linearized_.inverse(gauge_);
    detail::forEachIndex(static_cast<int>(by_inverse.size()), [&](int k) {
      const int g = by_inverse[at(k)];
      const ClusterFactor& factor = factors_[at(g)];
      MatrixXd C(factor.unknowns(), factor.unknowns()), block;
      for (std::size_t a = 0; a < factor.blocks.size(); ++a) {
        for (std::size_t b = 0; b < factor.blocks.size(); ++b) {
          block.resize(factor.start[a + 1] - factor.start[a], factor.start[b + 1] - factor.start[b]);
          inverse.block(factor.blocks[a], factor.blocks[b], block.data());
          C.block(factor.start[a], factor.start[b], block.rows(), block.cols()) = block;
        }
      }
      finish(g, C);
    });
  }
  std::vector<MatrixXd> inverses(others.size());
  addColumns(others, inverses, most_columns);
  detail::forEachIndex(static_cast<int>(others.size()), [&](int k) {
    if (factors_[at(others[at(k)])].has_leverage) finish(others[at(k)], inverses[at(k)]);
  });
}

/// Fills in C of these groups, column by column of H^-1. If that takes too many columns, the groups with the most
/// unknowns get no leverage.
void ClusterScores::addColumns(const std::vector<int>& groups, std::vector<MatrixXd>& inverses,
                               int most_columns) {
  const BlockStructure& structure = linearized_.structure().system;
  std::vector<int> order(groups.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return factors_[at(groups[at(a)])].unknowns() < factors_[at(groups[at(b)])].unknowns();
  });
  std::map<int, std::vector<std::pair<int, int>>>
      users;  // by block: its groups (index here) and its index in each
  int columns = 0;
  for (const int k : order) {
    const int g = groups[at(k)];
    const ClusterFactor& factor = factors_[at(g)];
    int more = 0;
    for (const int block : factor.blocks) more += users.contains(block) ? 0 : structure.dof(block);
    if (columns + more > most_columns) {
      dropLeverage(g);
      continue;
    }
    columns += more;
    for (std::size_t b = 0; b < factor.blocks.size(); ++b)
      users[factor.blocks[b]].emplace_back(k, static_cast<int>(b));
    inverses[at(k)].resize(factor.unknowns(), factor.unknowns());
  }
  for (const auto& [block, all] : users) {
    const MatrixXd column =
        linearized_.covarianceColumns(gauge_, structure.offset[at(block)], structure.dof(block));
    for (const auto& [k, place] : all) {
      const ClusterFactor& factor = factors_[at(groups[at(k)])];
      inverses[at(k)].middleCols(factor.start[at(place)], column.cols()) = rowsOf(column, groups[at(k)]);
    }
  }
}

/// Computes F, lambda and E^T r from J_g, r_g and C. E are the eigenvectors of J_g C J_g^T.
void ClusterScores::finishRows(ClusterFactor& factor, const MatrixXd& C) {
  const MatrixXd H = factor.F.transpose() * C * factor.F;
  const SymmetricEigen eigen = eigenOf((H + H.transpose()) / 2);
  Index small = 0;
  while (small < H.rows() && !(eigen.eigenvalues()[small] > kLeastLeverage)) ++small;
  const Index rank = H.rows() - small;
  const MatrixXd E = eigen.eigenvectors().rightCols(rank);
  factor.F = (factor.F * E).eval();
  factor.residual = (E.transpose() * factor.residual).eval();
  factor.leverage = eigen.eigenvalues().tail(rank).cwiseMin(1);
}

/// Computes F, lambda and E^T r from N, J~^T r and C. With C = K K^T: K^T N K = U diag(lambda) U^T and E = J~ K U
/// diag(lambda)^(-1/2).
void ClusterScores::finish(int g, const MatrixXd& C) {
  ClusterFactor& factor = factors_[at(g)];
  if (factor.unknowns() == 0) return;
  if (has_rows_[at(g)] != 0) return finishRows(factor, C);
  const MatrixXd N = std::move(factor.F);
  const VectorXd gradient = std::move(factor.residual);
  const VectorXd scale = C.diagonal().cwiseMax(0).cwiseSqrt();
  const VectorXd inverse = scale.unaryExpr([](double s) { return s > 0 ? 1 / s : 0.0; });
  const SymmetricEigen correlation =
      eigenOf(inverse.asDiagonal() * ((C + C.transpose()) / 2) * inverse.asDiagonal());
  Index none = 0;  // eigenvalues ascend
  while (none < scale.size() && !(correlation.eigenvalues()[none] > kLeastVariance)) ++none;
  const Index rank_of_C = scale.size() - none;
  const MatrixXd K = scale.asDiagonal() * correlation.eigenvectors().rightCols(rank_of_C) *
                     correlation.eigenvalues().tail(rank_of_C).cwiseSqrt().asDiagonal();
  const MatrixXd M = K.transpose() * N * K;
  const SymmetricEigen eigen = eigenOf((M + M.transpose()) / 2);
  Index small = 0;
  while (small < rank_of_C && !(eigen.eigenvalues()[small] > kLeastLeverage)) ++small;
  const Index rank = rank_of_C - small;
  const VectorXd root = eigen.eigenvalues().tail(rank).cwiseSqrt();
  const MatrixXd T = K * eigen.eigenvectors().rightCols(rank) * root.cwiseInverse().asDiagonal();
  factor.F = N * T;
  factor.residual = T.transpose() * gradient;
  factor.leverage = eigen.eigenvalues().tail(rank).cwiseMin(1);
}

double ClusterScores::aloneIn(const VectorXd& z, int g) const {
  const ClusterFactor& factor = factors_[at(g)];
  const VectorXd image = factor.F.transpose() * rowsOf(z, g);
  double sum = 0;
  for (Index k = 0; k < image.size(); ++k) sum += 1 - factor.leverage[k] < kAlone ? image[k] * image[k] : 0;
  return sum;
}

MatrixXd ClusterScores::rowsOf(const MatrixXd& Z, int g) const {
  const ClusterFactor& factor = factors_[at(g)];
  MatrixXd result(factor.unknowns(), Z.cols());
  for (std::size_t b = 0; b < factor.blocks.size(); ++b) {
    result.middleRows(factor.start[b], factor.sizeOf(b)) =
        Z.middleRows(linearized_.structure().system.offset[at(factor.blocks[b])], factor.sizeOf(b));
  }
  return result;
}

MatrixXd ClusterScores::imageOf(const MatrixXd& Z, int g) const {
  const ClusterFactor& factor = factors_[at(g)];
  if (factor.has_leverage) {
    MatrixXd image = factor.F.transpose() * rowsOf(Z, g);
    for (Index k = 0; k < image.rows(); ++k) {
      if (1 - factor.leverage[k] < kAlone) image.row(k).setZero();
    }
    return image;
  }
  const JacobianRows& rows = linearized_.rows();
  const BlockStructure& structure = linearized_.structure().system;
  Index size = 0, row = 0;
  for (const MeasurementPlace& m : measurements(g)) size += rows.residual(at(m.group), m.index).size();
  MatrixXd image = MatrixXd::Zero(size, Z.cols());
  for (const MeasurementPlace& m : measurements(g)) {
    const Index length = rows.residual(at(m.group), m.index).size();
    rows.forEachPart(at(m.group), m.index, [&](int block, const JacobianRows::Part& J) {
      image.middleRows(row, length) += J * Z.middleRows(structure.offset[at(block)], J.cols());
    });
    row += length;
  }
  return image;
}

VectorXd ClusterScores::factorsOf(ClusterCorrection correction, int g) const {
  const ClusterFactor& factor = factors_[at(g)];
  return factor.leverage.unaryExpr([&](double leverage) {
    const double left = 1 - leverage;
    if (left < kAlone) return 0.0;
    if (correction == ClusterCorrection::cr2 || correction == ClusterCorrection::by_leverage)
      return 1 / std::sqrt(left);
    return correction == ClusterCorrection::cr3 ? 1 / left : 1.0;
  });
}

MatrixXd ClusterScores::effects(const MatrixXd& Z, ClusterCorrection correction) const {
  MatrixXd result(count(), Z.cols());
  for (int g = 0; g < count(); ++g) {
    const ClusterFactor& factor = factors_[at(g)];
    if (factor.has_leverage) {
      const VectorXd score = factor.F * factorsOf(correction, g).cwiseProduct(factor.residual);
      result.row(g) = score.transpose() * rowsOf(Z, g);
    } else {
      const double by =
          correction == ClusterCorrection::cr0 || correction == ClusterCorrection::cr1 ? 1 : cr1_;
      result.row(g) = std::sqrt(by) * factor.residual.transpose() * rowsOf(Z, g);
    }
  }
  return result;
}

MatrixXd ClusterScores::expectedSquares(const MatrixXd& Z, ClusterCorrection correction) const {
  MatrixXd result(count(), Z.cols());
  for (int g = 0; g < count(); ++g) {
    const ClusterFactor& factor = factors_[at(g)];
    const MatrixXd image = imageOf(Z, g);
    if (factor.has_leverage) {
      const VectorXd weight =
          factorsOf(correction, g).cwiseAbs2().cwiseProduct((1 - factor.leverage.array()).matrix());
      result.row(g) = weight.transpose() * image.cwiseAbs2();
    } else {
      result.row(g) = image.colwise().squaredNorm();
    }
  }
  return result;
}

MatrixXd ClusterScores::vouchedFor(const MatrixXd& Za, const MatrixXd& Zb) const {
  MatrixXd sum = MatrixXd::Zero(Za.cols(), Zb.cols());
  for (int g = 0; g < count(); ++g) sum.noalias() += imageOf(Za, g).transpose() * imageOf(Zb, g);
  return sum;
}

double ClusterScores::factorOf(ClusterCorrection correction) const {
  if (correction == ClusterCorrection::cr1) return cr1_;
  return correction == ClusterCorrection::cr3 ? (count() - 1.0) / count() : 1;
}

}  // namespace slom
