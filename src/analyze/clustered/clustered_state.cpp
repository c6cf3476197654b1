#include "analyze/clustered/clustered_state.hpp"

#include <algorithm>
#include <cmath>

#include "analyze/clustered/cluster_dof.hpp"
#include "base/decompositions.hpp"
#include "base/index.hpp"
#include "base/words.hpp"
#include "slom/problem/group_table.hpp"

namespace slom {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kFewGroups = 10;
constexpr int kFewInSeries = 60;        // number of groups whose neighbours may share errors
constexpr std::size_t kMostRecent = 8;  // number of variables whose columns are kept
constexpr double kNoShare = 1e-6;       // fraction of the stated variance that is rounding
constexpr int kMostWays = 4;
constexpr double kRoundedVariance = 1e-9;  // relative difference of variances that is rounding
constexpr double kLeverageMatters = 1.2;   // ratio of the standard deviations by cr3 and cr2
constexpr double kLeverageMattersInOrder = 1.5;

/// Returns the default ways of grouping, if the user names none.
std::vector<ClusterBy> usualWays(const Problem& problem) {
  const GroupTable* const groups = problem.groups();
  if (groups == nullptr || groups->find("") >= 0 || groups->dimensionCount() != 1) return {ClusterBy("")};
  return {ClusterBy(groups->dimension(0))};
}

void checkWay(const Clustering& way) {
  if (way.count() >= 2) return;
  throw Error("slom.too-few-groups",
              "clustered covariances compare groups, and by " + way.way + " there " +
                  (way.count() == 1 ? "is one group" : "are no groups") +
                  "; group measurements so that there are at least two, better ten",
              way.way);
}

/// Makes C positive semidefinite: sets its negative eigenvalues, in units of `scale`, to 0. Returns whether there were
/// any.
///   source   Cameron, Gelbach and Miller 2011, section 2.3
bool makeSemidefinite(MatrixXd& C, const VectorXd& scale) {
  const VectorXd inverse = scale.unaryExpr([](double s) { return s > 0 ? 1 / s : 0.0; });
  const SymmetricEigen eigen = eigenOf(inverse.asDiagonal() * C * inverse.asDiagonal());
  if (eigen.eigenvalues().size() == 0 || eigen.eigenvalues()[0] >= -1e-12) return false;
  C = scale.asDiagonal() * eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() *
      eigen.eigenvectors().transpose() * scale.asDiagonal();
  return true;
}

}  // namespace

Clustering Clustered::State::firstWay(const Problem& problem, const ClusterOptions& options) {
  Clustering way = makeClustering(problem, options.by.empty() ? usualWays(problem)[0] : options.by[0]);
  checkWay(way);
  return way;
}

Clustered::State::State(const std::shared_ptr<const LinearizedProblem>& problem, FreeGauge free_gauge,
                        double factor, ClusterOptions all)
    : linearized(problem), gauge(free_gauge), variance_factor(factor), options(std::move(all)) {
  if (options.most_columns < 0) {
    throw Error("slom.bad-option",
                "most_columns is " + std::to_string(options.most_columns) +
                    "; pass the number of columns of H^-1 that may be computed, such as 5000",
                "most_columns");
  }
  if (options.by.empty()) options.by = usualWays(problem->problem());
  if (options.by.size() > at(kMostWays)) {
    throw Error("slom.bad-option",
                "measurements are to be grouped in " + std::to_string(options.by.size()) +
                    " ways at once; pass at most " + std::to_string(kMostWays),
                "by");
  }
  for (const ClusterBy& by : options.by) {
    ways.push_back(makeClustering(problem->problem(), by));
    checkWay(ways.back());
  }
  levels.resize(at(levelCount()));
  curvature.emplace(*problem);
}

const LinearizedProblem& Clustered::State::problem() const {
  const std::shared_ptr<const LinearizedProblem> now = linearized.lock();
  if (now != nullptr && now->isCurrent()) return *now;  // the estimator keeps it alive
  throw Error(
      "slom.stale-clustered",
      "the clustered covariances belong to a fit that has changed or is gone; call slom::clustered(est) again",
      "Clustered");
}

const Clustered::State::Level& Clustered::State::level(int l) {
  std::unique_ptr<Level>& result = levels[at(l)];
  if (result != nullptr) return *result;
  auto made = std::make_unique<Level>();
  const int subsets = 1 << ways.size();
  for (int subset = 1; subset < subsets; ++subset) {
    Clustering all;
    int members = 0;
    for (std::size_t w = 0; w < ways.size(); ++w) {
      if ((subset >> w & 1) == 0) continue;
      Clustering way = w == 0 ? blocksOf(ways[w], 1 << l) : ways[w];
      all = members++ == 0 ? std::move(way) : intersectionOf(all, way);
    }
    if (all.count() == 0) continue;  // no measurement is in groups of all these ways
    const Level* const finer = ways.size() == 1 && l > 0 ? levels[at(l - 1)].get() : nullptr;
    made->terms.push_back({ClusterScores(problem(), gauge, std::move(all), options.most_columns,
                                         finer != nullptr ? &finer->terms[0].scores : nullptr),
                           members % 2 == 1 ? 1.0 : -1.0, members == 1});
  }
  result = std::move(made);
  return *result;
}

MatrixXd Clustered::State::columns(int variable) {
  const auto found =
      std::find_if(recent.begin(), recent.end(), [&](const auto& one) { return one.first == variable; });
  if (found != recent.end()) return found->second;
  const LinearizedProblem& all = problem();
  const ProblemStructure& structure = all.structure();
  const int dof = all.problem().variables()[at(variable)].dof;
  MatrixXd Z = MatrixXd::Zero(structure.system.unknowns(), dof);
  if (!structure.system.isEmpty(variable)) {
    Z = all.covarianceColumns(gauge, structure.offsetOf(variable), dof);
    for (int c = 0; c < dof; ++c) {
      if (all.activeSet().isFixedOrActive(variable, c)) Z.col(c).setZero();
    }
    is_convex = curvature->correct(gauge, Z) && is_convex;
  }
  if (recent.size() >= kMostRecent) recent.erase(recent.begin());
  recent.emplace_back(variable, Z);
  return Z;
}

MatrixXd Clustered::State::refitted(const std::vector<int>& variables) const {
  MatrixXd result(refits->change.rows(), 0);
  for (const int v : variables) {
    const Index dof = problem().problem().variables()[at(v)].dof, before = result.cols();
    result.conservativeResize(Eigen::NoChange, before + dof);
    if (problem().structure().system.isEmpty(v)) {
      result.rightCols(dof).setZero();
    } else {
      result.rightCols(dof) = refits->change.middleCols(problem().structure().offsetOf(v), dof);
    }
  }
  return result;
}

/// Returns the scores of term k at level l that choose its correction. A block of successive groups has a large
/// leverage even if no single group has one, so the single groups decide.
const ClusterScores& Clustered::State::scoresOfGroups(int l, std::size_t k) {
  const Level& single = level(0);
  return single.terms.size() == level(l).terms.size() ? single.terms[k].scores : level(l).terms[k].scores;
}

ClusterCorrection Clustered::State::correctionFor(const ClusterScores& scores, const MatrixXd& Z,
                                                  std::vector<std::string>* carriers) const {
  if (options.correction != ClusterCorrection::by_leverage) return options.correction;
  ClusterCorrection result = ClusterCorrection::cr2;
  const double factor = scores.factorOf(ClusterCorrection::cr3);
  const double limit = options.ordered ? kLeverageMattersInOrder : kLeverageMatters;
  const auto isWider = [&](const auto& wide, const auto& usual) {
    return factor * wide.sum() > limit * limit * usual.sum();
  };
  // Residuals of a dominant group may be small by chance, so expected squares count as well as actual ones.
  const MatrixXd usual = scores.effects(Z, ClusterCorrection::cr2).cwiseAbs2(),
                 wide = scores.effects(Z, ClusterCorrection::cr3).cwiseAbs2(),
                 usual_expected = scores.expectedSquares(Z, ClusterCorrection::cr2),
                 wide_expected = scores.expectedSquares(Z, ClusterCorrection::cr3);
  for (Index i = 0; i < Z.cols(); ++i) {
    if (!isWider(wide.col(i), usual.col(i)) && !isWider(wide_expected.col(i), usual_expected.col(i)))
      continue;
    result = ClusterCorrection::cr3;
    if (carriers == nullptr) break;
    Index most = 0;
    wide_expected.col(i).maxCoeff(&most);
    (*carriers)[at(i)] = scores.clustering().names[at(most)];
  }
  return result;
}

Clustered::State::Covariance Clustered::State::covarianceAt(int l, const std::vector<int>& variables) {
  const LinearizedProblem& all = problem();
  Index n = 0;
  for (const int v : variables) n += all.problem().variables()[at(v)].dof;
  MatrixXd Z(all.structure().system.unknowns(), n), stated(n, n);
  Index column = 0;
  for (const int v : variables) {
    const MatrixXd own = columns(v);
    Z.middleCols(column, own.cols()) = own;
    column += own.cols();
  }
  // The stated covariance is Z^T H Z. times() adds the rows that hold components, in which Z is 0.
  const MatrixXd image = all.times(Z);
  stated = image.transpose() * image;
  Covariance result;
  result.C = MatrixXd::Zero(n, n);
  result.stated_share = VectorXd::Zero(n);
  result.carriers.resize(at(n));
  MatrixXd as_stated = MatrixXd::Zero(n, n);
  VectorXd largest = VectorXd::Zero(n), scale = largest;  // over single ways, and over all terms
  for (std::size_t k = 0; k < level(l).terms.size(); ++k) {
    const Term& term = level(l).terms[k];
    const ClusterCorrection correction =
        correctionFor(scoresOfGroups(l, k), Z, term.is_single ? &result.carriers : nullptr);
    MatrixXd effects = term.scores.effects(Z, correction);
    if (refits && options.correction == ClusterCorrection::cr3 && ways.size() == 1 && !options.ordered) {
      const MatrixXd change = refitted(variables);
      effects = change.array().isFinite().select(change, effects).eval();
    }
    MatrixXd rest = stated - term.scores.vouchedFor(Z, Z);
    for (Index i = 0; i < n; ++i) {
      if (rest(i, i) > kNoShare * stated(i, i)) continue;
      rest.row(i).setZero();
      rest.col(i).setZero();
    }
    const MatrixXd C =
        term.scores.factorOf(correction) * (effects.transpose() * effects) + variance_factor * rest;
    result.C += term.sign * C;
    as_stated += term.sign * rest;
    scale = scale.cwiseMax(C.diagonal().cwiseSqrt());
    if (term.is_single) largest = largest.cwiseMax(C.diagonal());
  }
  for (Index i = 0; i < n; ++i)
    result.stated_share[i] = stated(i, i) > 0 ? std::clamp(as_stated(i, i) / stated(i, i), 0.0, 1.0) : 0;
  result.C = ((result.C + result.C.transpose()) / 2).eval();
  if (level(l).terms.size() > 1) {
    result.was_indefinite = makeSemidefinite(result.C, scale);
    // Errors that are dependent by one way are dependent by all ways together too. With few groups, the difference may
    // come out smaller.
    for (Index i = 0; i < n; ++i) {
      if (!(result.C(i, i) < largest[i] * (1 - kRoundedVariance))) continue;
      result.C(i, i) = largest[i];
      result.was_smaller = true;
    }
  }
  return result;
}

Clustered::State::Covariance Clustered::State::covariance(const std::vector<int>& variables) {
  if (!isSeries()) return covarianceAt(0, variables);
  int l = 0;
  std::vector<double> deviations;
  for (const int v : variables) {
    const Choice& own = choice(v);
    l = std::max(l, own.level);
    deviations.insert(deviations.end(), own.deviation.data(), own.deviation.data() + own.deviation.size());
  }
  Covariance result = covarianceAt(l, variables);
  VectorXd scale(result.C.rows());
  for (Index i = 0; i < scale.size(); ++i)
    scale[i] = result.C(i, i) > 0 ? deviations[static_cast<std::size_t>(i)] / std::sqrt(result.C(i, i)) : 0;
  result.C = (scale.asDiagonal() * result.C * scale.asDiagonal()).eval();
  return result;
}

VectorXd Clustered::State::degreesOfFreedom(int variable, int l) {
  const MatrixXd Z = columns(variable);
  const MatrixXd image = problem().times(Z);
  const VectorXd stated = image.colwise().squaredNorm();
  VectorXd least;
  for (std::size_t k = 0; k < level(l).terms.size(); ++k) {
    const Term& term = level(l).terms[k];
    if (!term.is_single) continue;
    VectorXd rest = stated - term.scores.vouchedFor(Z, Z).diagonal();
    rest = (rest.array() > kNoShare * stated.array()).select(rest, 0).eval();
    const ClusterCorrection correction = correctionFor(scoresOfGroups(l, k), Z, nullptr);
    const VectorXd dof = satterthwaite(problem(), gauge, term.scores, correction, Z, rest);
    least = least.size() == 0 ? dof : least.cwiseMin(dof).eval();
  }
  return least;
}

std::vector<std::string> Clustered::State::notes() const {
  std::vector<std::string> result;
  for (const Clustering& way : ways) {
    if (way.count() < kFewGroups)
      result.push_back(
          "there are only " + counted(way.count(), "group") + " by " + way.way +
          ": the variances are estimated from as few numbers, and are as uncertain as their degrees of "
          "freedom say");
    if (way.ungrouped > 0)
      result.push_back(counted(way.ungrouped, "measurement") +
                       (way.ungrouped == 1 ? " is in no group by " : " are in no group by ") + way.way +
                       "; such errors count as independent, as stated");
  }
  for (const std::unique_ptr<Level>& one : levels) {
    if (one == nullptr || one->terms[0].scores.withoutLeverage() == 0) continue;
    result.push_back(
        "the leverage of " + counted(one->terms[0].scores.withoutLeverage(), "group") +
        " takes too many columns of H^-1 (ClusterOptions::most_columns); their residuals are corrected as by cr1");
    break;
  }
  if (options.ordered && !isSeries()) {
    result.push_back("there are too few groups by " + ways[0].way +
                     " to see whether neighbours share errors; " + std::to_string(kFewestInSeries) +
                     " are needed, better " + std::to_string(kFewInSeries));
  } else if (options.ordered && ways[0].count() < kFewInSeries) {
    result.push_back("there are only " + counted(ways[0].count(), "group") + " by " + ways[0].way +
                     " in order: if neighbours are much alike, intervals hold less often than stated; " +
                     std::to_string(kFewInSeries) + " are better");
  }
  if (refits && !refits->failed.empty())
    result.push_back("the fit does not converge without " + listed(refits->failed, 8) +
                     "; covariances take one step there, and changes are not known");
  if (!is_convex)
    result.push_back(
        "the robust cost is not convex at these values; variances hold for the curvature that its weights give");
  return result;
}

}  // namespace slom
