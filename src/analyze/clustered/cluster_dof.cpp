#include "analyze/clustered/cluster_dof.hpp"

#include <limits>
#include <random>

#include "base/index.hpp"

namespace slom {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMostGroupsExact = 300;
constexpr int kProbes = 32;

/// The matrix B of one component, see the header.
class WorkingCovariance {
 public:
  WorkingCovariance(const LinearizedProblem& linearized, FreeGauge gauge, const ClusterScores& scores,
                    ClusterCorrection correction, const VectorXd& z)
      : linearized_(linearized), gauge_(gauge), scores_(scores), squares_(VectorXd::Zero(scores.count())) {
    y_.resize(at(scores.count()));
    followed_ = squares_;
    for (int g = 0; g < scores.count(); ++g) {
      const ClusterFactor& factor = scores.factors()[at(g)];
      VectorXd image = scores.imageOf(z, g);
      if (factor.has_leverage) {
        image = image.cwiseProduct(scores.factorsOf(correction, g));
        y_[at(g)] = factor.F * image;
        followed_[g] = image.cwiseAbs2().dot(factor.leverage);
      }
      squares_[g] = image.squaredNorm();
    }
  }

  double trace() const { return (squares_ - followed_).sum(); }

  double traceOfSquare() const {
    if (const MatrixXd* const C = scores_.inverseOfShared()) return byShared(*C);
    return scores_.count() <= kMostGroupsExact ? byGroups() : byProbes();
  }

 private:
  /// Adds y_g times `weight` to a vector of all unknowns.
  template <class Column>
  void addTo(Column&& column, int g, double weight) const {
    const ClusterFactor& factor = scores_.factors()[at(g)];
    if (!factor.has_leverage) return;
    for (std::size_t b = 0; b < factor.blocks.size(); ++b) {
      column.segment(linearized_.structure().system.offset[at(factor.blocks[b])], factor.sizeOf(b)) +=
          weight * y_[at(g)].segment(factor.start[b], factor.sizeOf(b));
    }
  }

  /// Returns y_g of all groups, on the shared unknowns.
  MatrixXd onShared() const {
    std::vector<int> place(at(linearized_.structure().system.unknowns()), -1);
    for (std::size_t i = 0; i < scores_.shared().size(); ++i)
      place[at(scores_.shared()[i])] = static_cast<int>(i);
    MatrixXd Y = MatrixXd::Zero(static_cast<Index>(scores_.shared().size()), scores_.count());
    for (int g = 0; g < scores_.count(); ++g) {
      const ClusterFactor& factor = scores_.factors()[at(g)];
      if (!factor.has_leverage) continue;
      for (std::size_t b = 0; b < factor.blocks.size(); ++b) {
        const int first = place[at(linearized_.structure().system.offset[at(factor.blocks[b])])];
        Y.col(g).segment(first, factor.sizeOf(b)) = y_[at(g)].segment(factor.start[b], factor.sizeOf(b));
      }
    }
    return Y;
  }

  /// Returns tr B^2, from B itself, or as sum D^2 - 2 sum D_g y_g^T C y_g + tr (C W)^2 with W = sum y_g y_g^T.
  double byShared(const MatrixXd& C) const {
    const MatrixXd Y = onShared();
    if (Y.cols() <= Y.rows()) return squaredNormOf(Y.transpose() * (C * Y));
    const MatrixXd product = C * (Y * Y.transpose());
    return squares_.squaredNorm() - 2 * squares_.dot(followed_) +
           product.cwiseProduct(product.transpose()).sum();
  }

  /// Returns tr B^2 from Y^T H^-1 Y.
  double squaredNormOf(const MatrixXd& followed) const {
    MatrixXd B = -followed;
    B.diagonal() += squares_;
    return B.squaredNorm();
  }

  double byGroups() const {
    MatrixXd Y = MatrixXd::Zero(linearized_.structure().system.unknowns(), scores_.count());
    for (int g = 0; g < scores_.count(); ++g) addTo(Y.col(g), g, 1);
    return squaredNormOf(Y.transpose() * linearized_.covarianceTimes(gauge_, Y));
  }

  double byProbes() const {
    std::mt19937 engine(1);
    MatrixXd signs(scores_.count(), kProbes),
        Y = MatrixXd::Zero(linearized_.structure().system.unknowns(), kProbes);
    for (Index i = 0; i < signs.size(); ++i) signs.data()[i] = (engine() & 1U) != 0 ? 1 : -1;
    for (int g = 0; g < scores_.count(); ++g) {
      for (int k = 0; k < kProbes; ++k) addTo(Y.col(k), g, signs(g, k));
    }
    const MatrixXd X = linearized_.covarianceTimes(gauge_, Y);
    MatrixXd product = squares_.asDiagonal() * signs;
    for (int g = 0; g < scores_.count(); ++g) {
      if (scores_.factors()[at(g)].has_leverage)
        product.row(g) -= y_[at(g)].transpose() * scores_.rowsOf(X, g);
    }
    return product.squaredNorm() / kProbes;
  }

  const LinearizedProblem& linearized_;
  FreeGauge gauge_;
  const ClusterScores& scores_;
  std::vector<VectorXd> y_;      // A_g x_g by J_g^T, on the unknowns of the factor
  VectorXd squares_, followed_;  // |A_g x_g|^2 and y_g^T H^-1 y_g
};

}  // namespace

VectorXd satterthwaite(const LinearizedProblem& linearized, FreeGauge gauge, const ClusterScores& scores,
                       ClusterCorrection correction, const MatrixXd& Z, const VectorXd& stated) {
  VectorXd result = VectorXd::Constant(Z.cols(), std::numeric_limits<double>::infinity());
  const double factor = scores.factorOf(correction);
  for (Index c = 0; c < Z.cols(); ++c) {
    const WorkingCovariance B(linearized, gauge, scores, correction, Z.col(c));
    const double mean = factor * B.trace() + stated[c], square = factor * factor * B.traceOfSquare();
    if (square > 0) result[c] = mean * mean / square;
  }
  return result;
}

}  // namespace slom
