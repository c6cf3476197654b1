// Variances for ordered groups, whose neighbours may share errors.
#include <algorithm>
#include <cmath>
#include <vector>

#include "analyze/clustered/clustered_state.hpp"
#include "analyze/variance/series_variance.hpp"
#include "base/index.hpp"
#include "slom/analyze/long_memory.hpp"
#include "slom/analyze/student.hpp"

namespace slom {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kFewestBlocks = 8;      // number of blocks of successive groups
constexpr int kFewestForBlocks = 32;  // number of groups below which the length of blocks cannot be chosen
constexpr int kMostForSeries = 100;   // number of groups above which blocks suffice, without a model
constexpr double kCompared = 0.05;    // the wider of two intervals with this probability to miss is taken

}  // namespace

bool Clustered::State::isSeries() const { return options.ordered && ways[0].count() >= kFewestInSeries; }

int Clustered::State::levelCount() const {
  int count = 1;
  while (isSeries() && ways[0].count() >> count >= kFewestBlocks) ++count;
  return count;
}

const Clustered::State::Choice& Clustered::State::choice(int variable) {
  const auto found = choices.find(variable);
  if (found != choices.end()) return found->second;
  Choice result;
  const int groups = ways[0].count();
  result.deviation = result.dof = result.correlation = VectorXd::Zero(columns(variable).cols());
  if (groups >= kFewestForBlocks) chooseBlocks(variable, result);
  if (groups <= kMostForSeries) chooseAutoregression(variable, result);
  return choices.emplace(variable, std::move(result)).first->second;
}

/// Tries blocks of 1, 2, 4, ... groups until the variance grows by less than its standard deviation, sqrt(2 / dof)
/// times the variance. Blocks of length b miss a part of order 1 / b, so 2 V(2 b) - V(b) misses less. If V(b) comes
/// from the halves of the blocks of V(2 b), the extrapolation has the variance 5 / dof, and V(2 b) has 2 / dof. If the
/// variance of some component still grows at the longest blocks, it is extrapolated to the whole series.
///   source   Flegal and Jones 2010; Politis and Romano 1995 for the extrapolation
void Clustered::State::chooseBlocks(int variable, Choice& result) {
  VectorXd before = covarianceAt(0, {variable}).C.diagonal(), largest = before;
  result.deviation = before.cwiseSqrt();
  std::vector<std::vector<double>> by_length(
      static_cast<std::size_t>(before.size()));  // variances, by component
  const auto keep = [&](const VectorXd& variances) {
    for (Index i = 0; i < variances.size(); ++i)
      by_length[static_cast<std::size_t>(i)].push_back(variances[i]);
  };
  keep(before);
  for (int l = 1; l < levelCount(); ++l) {
    const VectorXd now = covarianceAt(l, {variable}).C.diagonal(), dof = degreesOfFreedom(variable, l);
    keep(now);
    result.level = l;
    result.dof = dof;
    result.levels_off = true;
    for (Index i = 0; i < now.size(); ++i) {
      if (now[i] > before[i] * (1 + std::sqrt(2 / dof[i]))) result.levels_off = false;
    }
    largest = largest.cwiseMax(now);
    result.deviation = largest.cwiseSqrt();
    if (result.levels_off) {
      result.deviation = now.cwiseMax(2 * now - before).cwiseSqrt();
      for (Index i = 0; i < now.size(); ++i) result.dof[i] = now[i] > before[i] ? 0.4 * dof[i] : dof[i];
      result.dof = result.dof.cwiseMax(1);
      break;
    }
    before = now;
  }
  for (Index i = 0; !result.levels_off && i < largest.size(); ++i) {
    const double factor =
        longMemoryFactor(by_length[static_cast<std::size_t>(i)], ways[0].count(), 1 << result.level);
    if (!(factor > 1)) continue;
    result.deviation[i] *= std::sqrt(factor);
    result.dof[i] = std::max(1.0, 0.4 * result.dof[i]);
  }
}

/// Computes the variance of the sum of the groups' contributions, as a series with correlated neighbours. For each
/// component, the wider of this interval and the one chosen before counts.
void Clustered::State::chooseAutoregression(int variable, Choice& result) {
  const VectorXd all = covarianceAt(0, {variable}).C.diagonal(), dof = degreesOfFreedom(variable, 0);
  const ClusterScores& scores = level(0).terms[0].scores;
  const Eigen::MatrixXd effects = scores.effects(columns(variable), options.correction);
  for (Index i = 0; i < all.size(); ++i) {
    const SeriesVariance series = seriesVariance(effects.col(i));
    const double own = scores.factorOf(options.correction) * effects.col(i).squaredNorm();
    const double deviation = std::sqrt(std::max(0.0, all[i] + (series.factor - 1) * own));
    const double own_dof = std::max(1.0, dof[i] * series.dof / (scores.count() - 1));
    result.correlation[i] = series.correlation;
    if (result.deviation[i] * studentCritical(kCompared, std::max(1.0, result.dof[i])) >
        deviation * studentCritical(kCompared, own_dof))
      continue;
    result.deviation[i] = deviation;
    result.dof[i] = own_dof;
  }
}

}  // namespace slom
