#include "analyze/residual_tests.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "analyze/singular.hpp"
#include "analyze/special_functions.hpp"
#include "base/decompositions.hpp"
#include "base/index.hpp"
#include "base/threads.hpp"
#include "base/words.hpp"
#include "slom/analyze/chi_square.hpp"

namespace slom {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Eigenvalue of Q below which only the measurement itself determines that direction of its residual.
constexpr double kUnchecked = 1e-8;
constexpr int kMeasurementsPerTask = 64;

/// The factor that divides chi-squares, and the redundancy of the residuals that it is estimated from; 0: it is known.
struct VarianceFactor {
  double value = 1;
  double redundancy = 0;
};

struct Test {
  double ratio;  ///< chi-square over its degrees of freedom, in units of the factor of all other residuals
  double probability;  ///< p-value: that good measurements have a ratio at least as large
};

/// Tests `chi2`, given in units of the factor. If the factor comes from these residuals alone, the p-value is 1.
Test testOf(double chi2, double dof, const VarianceFactor& factor) {
  if (factor.redundancy == 0) return {chi2 / dof, chiSquareProbability(chi2, dof)};
  const double rest = factor.redundancy - dof;
  if (!(rest > kUnchecked)) return {chi2 / dof, 1};
  const double ratio = (chi2 / dof) / (std::max(0.0, factor.redundancy - chi2) / rest);
  return {ratio, fProbability(ratio, dof, rest)};
}

class GroupExamination {
 public:
  GroupExamination(const LinearizedProblem& linearized, const InverseBlocks& inverse, std::size_t group,
                   const VarianceFactor& factor)
      : inverse_(inverse),
        group_(group),
        pool_(*linearized.problem().pools()[group]),
        rows_(pool_.lossCount() > 0 ? linearized.unweightedRows() : linearized.rows()),
        factor_(factor) {}

  struct Result {
    MeasurementCheck check;  ///< without its name and handle, which few need
    double chi2 = 0, redundancy = 0;
    const MeasurementPool* pool = nullptr;
    int measurement = 0;

    /// Returns the check with the name and the handle of its measurement.
    MeasurementCheck named() const {
      MeasurementCheck whole = check;
      whole.measurement = pool->measurementName(measurement);
      whole.number = pool->serial(measurement);
      whole.id = AnyMeasID(MeasurementHandle(pool->presence(), pool->handleOf(measurement)));
      return whole;
    }
  };

  /// Adds chi-square and redundancy of all measurements to those of the group. This takes a fraction of the time of run().
  void addSumsTo(GroupCheck& group) const {
    const int tasks = taskCount();
    std::vector<std::pair<double, double>> sums(at(tasks));
    detail::forEachIndex(tasks, [&](int t) {
      MatrixXd C;
      auto& [chi2, redundancy] = sums[at(t)];
      for (int i = t * kMeasurementsPerTask; i < endOf(t); ++i) {
        const auto w = rows_.residual(group_, i);
        const double squared = w.squaredNorm();
        const double weight = pool_.lossOf(i) != nullptr ? pool_.lossOf(i)->evaluate(squared).first : 1;
        chi2 += squared;
        redundancy += std::max(0.0, static_cast<double>(w.size()) + (1 - 2 * weight) * traceOfLeverage(i, C));
      }
    });
    for (const auto& [chi2, redundancy] : sums) {
      group.chi2 += chi2 / factor_.value;
      group.redundancy += redundancy;
    }
  }

  std::vector<Result> run() const {
    std::vector<Result> results(at(pool_.size()));
    detail::forEachIndex(taskCount(), [&](int t) {
      for (int i = t * kMeasurementsPerTask; i < endOf(t); ++i) results[at(i)] = examine(i);
    });
    return results;
  }

 private:
  int taskCount() const { return (pool_.size() + kMeasurementsPerTask - 1) / kMeasurementsPerTask; }
  int endOf(int task) const { return std::min(pool_.size(), (task + 1) * kMeasurementsPerTask); }

  /// Returns the trace of J C J^T of measurement i; `C` is room for blocks.
  double traceOfLeverage(int i, MatrixXd& C) const {
    double trace = 0;
    rows_.forEachPart(group_, i, [&](int a, const JacobianRows::Part& Ja) {
      rows_.forEachPart(group_, i, [&](int b, const JacobianRows::Part& Jb) {
        if (b > a) return;
        C.resize(Ja.cols(), Jb.cols());
        inverse_.block(a, b, C.data());
        trace += (a == b ? 1 : 2) * Ja.lazyProduct(C).cwiseProduct(Jb).sum();
      });
    });
    return trace;
  }
  /// Returns J C J^T of measurement i.
  MatrixXd leverage(int i) const {
    const Index rows = rows_.residual(group_, i).size();
    MatrixXd result = MatrixXd::Zero(rows, rows), C;
    rows_.forEachPart(group_, i, [&](int a, const JacobianRows::Part& Ja) {
      rows_.forEachPart(group_, i, [&](int b, const JacobianRows::Part& Jb) {
        C.resize(Ja.cols(), Jb.cols());
        inverse_.block(a, b, C.data());
        result.noalias() += Ja * C * Jb.transpose();
      });
    });
    return (result + result.transpose()) / 2;
  }

  Result examine(int i) const {
    const VectorXd w = rows_.residual(group_, i);
    Result result;
    MeasurementCheck& check = result.check;
    result.pool = &pool_;
    result.measurement = i;
    const double squared = w.squaredNorm();
    if (pool_.lossOf(i) != nullptr) check.weight = pool_.lossOf(i)->evaluate(squared).first;
    if (w.size() == 0) return result;
    const MatrixXd H = leverage(i);
    const MatrixXd Q = MatrixXd::Identity(w.size(), w.size()) + (1 - 2 * check.weight) * H;
    const SymmetricEigen eigen = eigenOf(Q);
    VectorXd solved = VectorXd::Zero(w.size());  // Q^-1 w
    for (Eigen::Index k = 0; k < w.size(); ++k) {
      if (!(eigen.eigenvalues()[k] > kUnchecked)) continue;
      ++check.dof;
      const double part = eigen.eigenvectors().col(k).dot(w);
      check.statistic += part * part / eigen.eigenvalues()[k];
      solved += part / eigen.eigenvalues()[k] * eigen.eigenvectors().col(k);
    }
    result.chi2 = squared / factor_.value;
    result.redundancy = std::max(0.0, Q.trace());
    check.residual = std::sqrt(squared);
    check.redundancy = w.size() > 0 ? result.redundancy / static_cast<double>(w.size()) : 0;
    check.statistic /= factor_.value;
    check.effect = check.weight * std::sqrt(std::max(0.0, solved.dot(H * solved)) / factor_.value);
    if (check.dof > 0) {
      const Test test = testOf(check.statistic, check.dof, factor_);
      check.studentized = std::sqrt(test.ratio);
      check.probability = test.probability;
    }
    return result;
  }

  const InverseBlocks& inverse_;
  std::size_t group_;
  const MeasurementPool& pool_;
  const JacobianRows& rows_;  // not reweighted by losses
  VarianceFactor factor_;
};

/// Sets the p-value of the group's chi-square.
void setProbability(GroupCheck& group, const VarianceFactor& factor) {
  if (!(group.redundancy > kUnchecked)) return;
  const double above = testOf(group.chi2, group.redundancy, factor).probability;
  group.probability = above == 1 ? 1 : 2 * std::min(above, 1 - above);
}

/// Calls f(pool index) for the pools of group g that have measurements. Returns the group with its name.
template <class F>
GroupCheck forEachPool(const Problem& problem, int g, const F& f) {
  GroupCheck group;
  for (std::size_t p = 0; p < problem.pools().size(); ++p) {
    const MeasurementPool& pool = *problem.pools()[p];
    if (pool.group() != g || pool.size() == 0) continue;
    f(p);
    group.measurements += pool.size();
    group.name = pool.name();
    group.has_losses = group.has_losses || pool.lossCount() > 0;
  }
  return group;
}

/// Returns the first `most` in this order. Changes the order of `all`.
template <class Order>
std::vector<MeasurementCheck> firstOf(std::vector<const GroupExamination::Result*>& all, std::size_t most,
                                      const Order& order) {
  const auto end = all.begin() + static_cast<std::ptrdiff_t>(std::min(most, all.size()));
  std::partial_sort(all.begin(), end, all.end(),
                    [&](const auto* a, const auto* b) { return order(a->check, b->check); });
  std::vector<MeasurementCheck> first;
  for (auto result = all.begin(); result != end; ++result) first.push_back((*result)->named());
  return first;
}

/// Summarizes the results of a group; `group` holds its name.
GroupCheck summarized(std::vector<GroupExamination::Result> results, GroupCheck group,
                      const OutlierOptions& options, double significance, const VarianceFactor& factor) {
  std::vector<const GroupExamination::Result*> all;
  all.reserve(results.size());
  for (GroupExamination::Result& result : results) {
    group.chi2 += result.chi2;
    group.redundancy += result.redundancy;
    result.check.is_suspect = result.check.probability < significance;
    group.suspects += result.check.is_suspect ? 1 : 0;
    group.hardly_checkable += result.check.isHardlyCheckable() ? 1 : 0;
    all.push_back(&result);
  }
  setProbability(group, factor);
  const auto most = static_cast<std::size_t>(std::max(0, options.worst));
  group.least_checkable = firstOf(all, std::min(most, at(group.hardly_checkable)), lessCheckable);
  group.worst = firstOf(all, most, lessProbable);
  return group;
}

}  // namespace

OutlierReport checkResiduals(const LinearizedProblem& linearized, const OutlierOptions& options,
                             double variance_factor, int redundancy, FreeGauge gauge) {
  if (!(options.significance > 0 && options.significance < 1)) {
    throw Error("slom.bad-option",
                "the significance of OutlierOptions is " + number(options.significance, 6) +
                    "; pass a probability between 0 and 1, such as 0.01",
                "significance");
  }
  OutlierReport report;
  report.variance_factor = variance_factor;
  const Problem& problem = linearized.problem();
  int count = 0;
  for (const auto& pool : problem.pools()) count += pool->size();
  report.significance = options.significance / std::max(1, count);
  // If there are losses, their weights keep errors out of the factor, so it counts as known. So does a factor of 0, in
  // which no error can hide.
  const bool has_losses =
      std::ranges::any_of(problem.pools(), [](const auto& pool) { return pool->lossCount() > 0; });
  const VarianceFactor factor{variance_factor, has_losses || !(variance_factor > 0) ? 0.0 : redundancy};
  const InverseBlocks& inverse = linearized.inverse(gauge);
  for (int g = 0; g < problem.groupCount(); ++g) {
    std::vector<GroupExamination::Result> results;
    GroupCheck group = forEachPool(problem, g, [&](std::size_t p) {
      std::vector<GroupExamination::Result> more = GroupExamination(linearized, inverse, p, factor).run();
      std::move(more.begin(), more.end(), std::back_inserter(results));
    });
    if (results.empty()) continue;
    report.groups.push_back(
        summarized(std::move(results), std::move(group), options, report.significance, factor));
  }
  return report;
}

std::vector<GroupCheck> checkGroups(const LinearizedProblem& linearized, FreeGauge gauge) {
  const Problem& problem = linearized.problem();
  const InverseBlocks& inverse = linearized.inverse(gauge);
  std::vector<GroupCheck> groups;
  for (int g = 0; g < problem.groupCount(); ++g) {
    GroupCheck sums;
    GroupCheck group = forEachPool(problem, g, [&](std::size_t p) {
      GroupExamination(linearized, inverse, p, VarianceFactor{}).addSumsTo(sums);
    });
    if (group.measurements == 0) continue;
    group.chi2 = sums.chi2;
    group.redundancy = sums.redundancy;
    setProbability(group, {});
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace slom
