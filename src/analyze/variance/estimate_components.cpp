#include "analyze/variance/estimate_components.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "analyze/variance/variance_kinds.hpp"
#include "base/decompositions.hpp"
#include "base/index.hpp"
#include "base/words.hpp"

namespace slom {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNoRedundancy = 1e-6;  // fraction of a component's residuals
constexpr double kRoundedComponent =
    1e-20;                             // theta; standard deviations 1e-10 times the stated ones are rounding
constexpr double kNoOwnError = 1e-12;  // theta over the largest theta
constexpr double kNoSharedError = 1e-8;  // theta over that of the measurements' own errors
constexpr double kLeastDistinct = 1e-8;  // least eigenvalue of the correlation matrix of the components
constexpr double kLeastDistinctByProbes = 0.02;  // likewise, if S is estimated
constexpr double kInvolvedEntry = 0.1;  // least entry of an eigenvector for a component that belongs to it
constexpr double kMostGrowth = 5;       // largest factor of theta in one iteration; the smallest is 1 / 5
constexpr int kLookAtZero = 20;         // iterations between tests of shared errors that may be 0
constexpr double kSmallSharedError = 1e-4;  // theta in that test, over that of the measurements' own errors
constexpr int kMostScoring = 50;  // iterations by scoring; later steps never decrease the likelihood
constexpr double kFarMove = 1;    // movement of values in standard deviations from which on a note is given

/// A component of the model, and the requested components that it represents.
struct Unknown {
  std::vector<int> kinds;  // several if they cannot be told apart
  int shared = -1;         // or the index of a shared error
};

class ComponentEstimation {
 public:
  ComponentEstimation(const LinearizedProblem& linearized, FreeGauge gauge, const VarianceOptions& options)
      : linearized_(linearized),
        gauge_(gauge),
        options_(options),
        kinds_(makeVarianceKinds(linearized.problem(), options)) {
    const int n = static_cast<int>(kinds_.names.size());
    for (int k = 0; k < n; ++k) {
      unknowns_.push_back({{k}, -1});
      VarianceComponent& own = result_.components.emplace_back();
      own.name = kinds_.names[at(k)];
      own.measurements = kinds_.measurements[at(k)];
    }
    for (std::size_t s = 0; s < kinds_.shared.size(); ++s) {
      unknowns_.push_back({{}, static_cast<int>(s)});
      VarianceComponent& own = result_.components.emplace_back();
      own.name = kinds_.shared_names[s];
      own.is_shared = true;
      own.measurements = kinds_.shared[s].groups.count();
      own.residuals = own.measurements * kinds_.shared[s].dimension;
    }
    for (std::size_t p = 0; p < kinds_.of_pool.size(); ++p) {
      for (std::size_t i = 0; i < kinds_.of_pool[p].size(); ++i) {
        if (const int k = kinds_.of_pool[p][i]; k >= 0)
          result_.components[at(k)].residuals += linearized.problem().pools()[p]->rows(static_cast<int>(i));
      }
    }
  }

  VarianceComponents run() {
    while (!unknowns_.empty() && !iterate()) {
    }
    if (unknowns_.empty()) result_.message = "no component can be estimated";
    finish();
    return std::move(result_);
  }

 private:
  int componentOf(const Unknown& unknown) const {
    return unknown.shared < 0 ? unknown.kinds.front()
                              : static_cast<int>(kinds_.names.size()) + unknown.shared;
  }
  std::string nameOf(const Unknown& unknown) const {
    if (unknown.shared >= 0) return kinds_.shared_names[at(unknown.shared)];
    std::vector<std::string> names;
    for (const int k : unknown.kinds) names.push_back(kinds_.names[at(k)]);
    return listed(names, 8);
  }

  /// Makes a model of the remaining unknowns: kinds, then shared errors.
  VarianceModel makeModel() const {
    std::vector<int> number(kinds_.names.size(), -1);
    std::vector<SharedTerm> shared;
    int n = 0;
    for (const Unknown& unknown : unknowns_) {
      for (const int k : unknown.kinds) number[at(k)] = n;
      n += unknown.shared < 0 ? 1 : 0;
      if (unknown.shared >= 0) shared.push_back(kinds_.shared[at(unknown.shared)]);
    }
    std::vector<std::vector<int>> of_pool = kinds_.of_pool;
    for (std::vector<int>& of : of_pool) {
      for (int& kind : of) kind = kind < 0 ? -1 : number[at(kind)];
    }
    return {linearized_, gauge_, std::move(of_pool), std::move(shared), n};
  }

  /// Removes unknown u: its variance stays as stated, or becomes 0 for a shared error.
  void keep(std::size_t u, const std::string& reason) {
    const Unknown unknown = unknowns_[u];
    const auto say = [&](int c) {
      VarianceComponent& own = result_.components[at(c)];
      own.is_estimated = false;
      own.reason = reason;
      own.factor = own.is_shared ? 0 : 1;
    };
    if (unknown.shared >= 0) say(componentOf(unknown));
    for (const int k : unknown.kinds) say(k);
    unknowns_.erase(unknowns_.begin() + static_cast<std::ptrdiff_t>(u));
  }

  /// Returns whether all unknowns have redundancy; otherwise removes one without. If that one had some at first, its
  /// variance has gone to 0.
  bool haveRedundancy(const VarianceModel& model, const VarianceModel::Evaluation& now, bool is_first) {
    for (std::size_t u = unknowns_.size(); u-- > 0;) {
      const Index k = static_cast<Index>(u);
      const int c = componentOf(unknowns_[u]);
      if (is_first) result_.components[at(c)].redundancy = std::max(0.0, now.redundancy[k]);
      if (now.redundancy[k] / model.residuals()[k] > kNoRedundancy) continue;
      if (!is_first) {
        keepZero(u);
      } else {
        keep(u, unknowns_[u].shared < 0 ? "its redundancy is 0: no other measurement checks it"
                                        : "its redundancy is 0: the values of the fit follow it");
      }
      return false;
    }
    return true;
  }

  /// Removes unknown u, whose variance went to 0.
  void keepZero(std::size_t u) {
    keep(u, unknowns_[u].shared >= 0 ? "the estimate is 0: no shared error is seen"
                                     : "the estimate is 0: its residuals are 0, or too few");
  }

  /// Returns whether the information tells all unknowns apart. Otherwise the unknowns of the least eigenvalue are
  /// joined; if a shared error is among them, the last one is removed instead.
  bool canBeToldApart(const VarianceModel& model, const MatrixXd& S) {
    if (unknowns_.size() < 2) return true;
    const VectorXd scale = S.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const SymmetricEigen eigen = eigenOf(scale.asDiagonal() * S * scale.asDiagonal());
    if (eigen.eigenvalues()[0] > (model.isExact() ? kLeastDistinct : kLeastDistinctByProbes)) return true;
    std::vector<std::size_t> involved;
    std::vector<std::string> names;
    for (std::size_t u = 0; u < unknowns_.size(); ++u) {
      if (std::abs(eigen.eigenvectors()(static_cast<Index>(u), 0)) < kInvolvedEntry) continue;
      involved.push_back(u);
      names.push_back(nameOf(unknowns_[u]));
    }
    const std::string sentence = "the residuals cannot tell apart the errors of " + listed(names, 8);
    const std::size_t last = involved.back();
    if (unknowns_[last].shared >= 0) {
      result_.notes.push_back(sentence + "; the last of them is left out");
      keep(last, "it cannot be told apart from others");
      return false;
    }
    result_.notes.push_back(sentence + "; they get one factor");
    for (std::size_t i = involved.size(); i-- > 1;) {
      std::vector<int>& first = unknowns_[involved[0]].kinds;
      const std::vector<int>& own = unknowns_[involved[i]].kinds;
      first.insert(first.end(), own.begin(), own.end());
      unknowns_.erase(unknowns_.begin() + static_cast<std::ptrdiff_t>(involved[i]));
    }
    return false;
  }

  /// Returns the variance of the own errors of measurements with this shared error.
  double ownVariance(const Unknown& shared, const VectorXd& theta) const {
    const int kind = kinds_.shared_kind[at(shared.shared)];
    for (std::size_t u = 0; u < unknowns_.size(); ++u) {
      const std::vector<int>& kinds = unknowns_[u].kinds;
      if (std::find(kinds.begin(), kinds.end(), kind) != kinds.end()) return theta[static_cast<Index>(u)];
    }
    return 1;
  }

  /// Returns chi-square / dof of all residuals, the start of the iteration.
  double commonVariance() const {
    const double redundancy = linearized_.structure().residuals - linearized_.freeUnknowns();
    const double result = linearized_.rss() / std::max(1.0, redundancy);
    return result > kRoundedComponent ? result : 1;
  }

  /// Returns whether no variance went to 0; otherwise removes one that did.
  bool haveErrors(const VectorXd& theta) {
    const double least = std::max(kRoundedComponent, kNoOwnError * theta.maxCoeff());
    for (std::size_t u = unknowns_.size(); u-- > 0;) {
      const bool is_shared = unknowns_[u].shared >= 0;
      if (theta[static_cast<Index>(u)] >
          (is_shared ? kNoSharedError * ownVariance(unknowns_[u], theta) : least))
        continue;
      keepZero(u);
      return false;
    }
    return true;
  }

  /// Returns theta_new / theta. It is a step of scoring, S (x - 1) = q - redundancy, within limits. Late in the
  /// iteration it is sqrt(q / redundancy), which never decreases the restricted likelihood.
  ///   source   Patterson and Thompson 1971; Zhou, Hu, Zhou and Lange, "MM algorithms for variance components models",
  ///            2019
  static VectorXd growth(const VarianceModel::Evaluation& now, int iteration) {
    const VectorXd safe = (now.square.array() / now.redundancy.array().max(1e-300)).sqrt();
    if (iteration > kMostScoring) return safe;
    const PivotedQR qr = pivotedQrOf(now.S);
    VectorXd x = VectorXd::Ones(safe.size()) + VectorXd(leastSquares(qr, now.square - now.redundancy));
    if (!x.allFinite()) x = safe;
    return x.cwiseMin(kMostGrowth).cwiseMax(1 / kMostGrowth);
  }

  /// Returns whether the likelihood of a barely visible shared error still rises towards 0. Removes such an error.
  bool dropsToZero(VarianceModel& model, const VectorXd& theta) {
    for (std::size_t u = unknowns_.size(); u-- > 0;) {
      const Index k = static_cast<Index>(u);
      if (unknowns_[u].shared < 0 || theta[k] > ownVariance(unknowns_[u], theta)) continue;
      VectorXd small = theta;
      small[k] = std::min(theta[k], kSmallSharedError * ownVariance(unknowns_[u], theta));
      const VarianceModel::Evaluation there = model.evaluate(small);
      ++result_.iterations;
      if (there.square[k] >= there.redundancy[k]) continue;
      keepZero(u);
      return true;
    }
    return false;
  }

  /// Iterates to the end. Returns false if the set of unknowns has changed; then the iteration starts anew.
  bool iterate() {
    VarianceModel model = makeModel();
    VectorXd theta = VectorXd::Constant(model.components(), commonVariance());
    result_.converged = false;
    for (int i = 0; i < options_.max_iterations; ++i) {
      VarianceModel::Evaluation now = model.evaluate(theta, i > 0);
      ++result_.iterations;
      if (i == 0 && (!haveRedundancy(model, now, true) || !canBeToldApart(model, now.S))) return false;
      if (i > 0 && i % kLookAtZero == 0 && dropsToZero(model, theta)) return false;
      const VectorXd x = growth(now, i);
      const double change = (x.array() - 1).abs().maxCoeff();
      result_.converged = change <= options_.tolerance;
      if (result_.converged || i + 1 == options_.max_iterations) {
        if (i > 0 && !model.isExact()) now = model.evaluate(theta);
        if (!haveRedundancy(model, now, false) || !canBeToldApart(model, now.S)) return false;
        result_.message = result_.converged
                              ? "the variances changed by less than the tolerance"
                              : "iteration limit of " + std::to_string(options_.max_iterations) + " reached";
        record(model, theta, now);
        return true;
      }
      theta = theta.cwiseProduct(x);
      if (!haveErrors(theta)) return false;
    }
    result_.message = "iteration limit of 0 reached";
    return true;
  }

  void record(const VarianceModel& model, const VectorXd& theta, const VarianceModel::Evaluation& now) {
    const Index n = theta.size();
    const MatrixXd inverse = leastSquares(pivotedQrOf(now.S), MatrixXd::Identity(n, n));
    const std::size_t all = result_.components.size();
    result_.correlations.assign(all * all, 0);
    for (Index i = 0; i < n; ++i) {
      const Unknown& unknown = unknowns_[static_cast<std::size_t>(i)];
      std::vector<int> own = unknown.kinds;
      if (unknown.shared >= 0) own = {componentOf(unknown)};
      for (const int c : own) {
        VarianceComponent& component = result_.components[at(c)];
        component.factor = std::sqrt(theta[i]);
        component.redundancy = now.redundancy[i];
        component.dof = 1 / inverse(i, i);
        component.standard_deviation = component.factor * std::sqrt(inverse(i, i) / 2);
        component_of_[c] = static_cast<int>(i);
        if (unknown.shared >= 0)
          component.length_slope = model.lengthSlope(static_cast<int>(i) - model.kinds());
      }
    }
    for (const auto& [a, i] : component_of_) {
      for (const auto& [b, j] : component_of_)
        result_.correlations[at(a) * all + at(b)] = inverse(i, j) / std::sqrt(inverse(i, i) * inverse(j, j));
    }
    result_.largest_move = model.largestMove();
    if (!model.isAccurate())
      result_.notes.push_back(
          "the problem is close to singular, and redundancies have fewer than six digits");
    if (!model.isExact())
      result_.notes.push_back(
          "the problem is large: standard deviations of the factors are from random signs, and have one or two digits");
  }

  void finish() {
    for (VarianceComponent& own : result_.components) {
      if (own.is_estimated) continue;
      own.standard_deviation = std::numeric_limits<double>::quiet_NaN();
      own.dof = 0;
      result_.notes.push_back(own.name + ": " + own.reason +
                              (own.is_shared ? "" : "; its standard deviations are taken as stated"));
    }
    if (!kinds_.kept.empty()) result_.notes.push_back("taken as stated: " + listed(kinds_.kept, 8));
    if (result_.largest_move > kFarMove)
      result_.notes.push_back("with these weights a value moves by " + number(result_.largest_move, 2) +
                              " of its standard deviations; apply them, optimize, and estimate again");
    result_.assignment = std::make_shared<VarianceComponents::Assignment>(VarianceComponents::Assignment{
        &linearized_.problem(), linearized_.problem().structureRevision(), kinds_.of_pool});
  }

  const LinearizedProblem& linearized_;
  FreeGauge gauge_;
  const VarianceOptions& options_;
  VarianceKinds kinds_;
  std::vector<Unknown> unknowns_;
  std::map<int, int> component_of_;  // index in the last model, by component
  VarianceComponents result_;
};

}  // namespace

VarianceComponents estimateComponents(const LinearizedProblem& linearized, FreeGauge gauge,
                                      const VarianceOptions& options) {
  return ComponentEstimation(linearized, gauge, options).run();
}

}  // namespace slom
