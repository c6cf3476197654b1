#include "analyze/residual_tests.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <ostream>

#include "base/classic_numbers.hpp"
#include "base/decompositions.hpp"
#include "base/index.hpp"
#include "base/threads.hpp"
#include "base/words.hpp"
#include "slom/analyze/chi_square.hpp"
#include "slom/analyze/covariance.hpp"

namespace slom {

namespace {

using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Directions of a residual in which Q is smaller are determined by nothing but the measurement itself.
constexpr double kUnchecked = 1e-8;
constexpr int kMeasurementsPerTask = 64;

class GroupExamination {
 public:
  GroupExamination(System& system, const InverseBlocks& inverse, std::size_t group, double variance_factor)
      : problem_(system.problem()),
        structure_(system.structure()),
        inverse_(inverse),
        pool_(*problem_.pools()[group]),
        variance_factor_(variance_factor) {}

  struct Result {
    MeasurementCheck check;
    double chi2 = 0, redundancy = 0;
  };

  std::vector<Result> run() const {
    std::vector<Result> results(at(pool_.size()));
    const int tasks = (pool_.size() + kMeasurementsPerTask - 1) / kMeasurementsPerTask;
    detail::forEachIndex(tasks, [&](int t) {
      const int last = std::min(pool_.size(), (t + 1) * kMeasurementsPerTask);
      for (int i = t * kMeasurementsPerTask; i < last; ++i) results[at(i)] = examine(i);
    });
    return results;
  }

 private:
  /// J C J^T of measurement i.
  MatrixXd leverage(int i, const MatrixXd& J) const {
    const int arity = pool_.arity();
    std::vector<int> block(at(arity)), column(at(arity));
    int width = 0;
    for (int k = 0; k < arity; ++k) {
      const int variable = pool_.variables(i)[k];
      column[at(k)] = width;
      block[at(k)] = structure_.block_of_variable[at(variable)];
      width += problem_.variables()[at(variable)].dof;
    }
    MatrixXd result = MatrixXd::Zero(J.rows(), J.rows()), C;
    for (int k = 0; k < arity; ++k) {
      for (int l = 0; l < arity; ++l) {
        if (block[at(k)] < 0 || block[at(l)] < 0) continue;
        C.resize(structure_.system.dof(block[at(k)]), structure_.system.dof(block[at(l)]));
        inverse_.block(block[at(k)], block[at(l)], C.data());
        result.noalias() +=
            J.middleCols(column[at(k)], C.rows()) * C * J.middleCols(column[at(l)], C.cols()).transpose();
      }
    }
    return (result + result.transpose()) / 2;
  }

  void clearHeld(int i, MatrixXd& J) const {
    int column = 0;
    for (int k = 0; k < pool_.arity(); ++k) {
      const int variable = pool_.variables(i)[k];
      const VariableRecord& record = problem_.variables()[at(variable)];
      for (int c = 0; c < record.dof; ++c, ++column) {
        if (!problem_.activeSet().isOptimized(variable) || problem_.activeSet().isHeld(variable, c))
          J.col(column).setZero();
      }
    }
  }

  Result examine(int i) const {
    VectorXd w(pool_.rows(i));
    MatrixXd J = MatrixXd::Zero(pool_.rows(i), pool_.columns(i));
    problem_.naming(pool_, [&] { return pool_.linearize(i, i + 1, w.data(), J.data()); });
    clearHeld(i, J);
    Result result;
    MeasurementCheck& check = result.check;
    check.measurement = pool_.measurementName(i);
    const double squared = w.squaredNorm();
    if (pool_.lossOf(i) != nullptr) check.weight = pool_.lossOf(i)->evaluate(squared).first;
    if (w.size() == 0) return result;
    const MatrixXd H = leverage(i, J);
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
    result.chi2 = squared / variance_factor_;
    result.redundancy = std::max(0.0, Q.trace());
    check.residual = std::sqrt(squared);
    check.redundancy = w.size() > 0 ? result.redundancy / static_cast<double>(w.size()) : 0;
    check.statistic /= variance_factor_;
    check.effect = check.weight * std::sqrt(std::max(0.0, solved.dot(H * solved)) / variance_factor_);
    if (check.dof > 0) {
      check.studentized = std::sqrt(check.statistic / check.dof);
      check.probability = chiSquareProbability(check.statistic, check.dof);
    }
    return result;
  }

  Problem& problem_;
  const ProblemStructure& structure_;
  const InverseBlocks& inverse_;
  MeasurementPool& pool_;
  double variance_factor_;
};

/// `group` has its name.
GroupCheck summarized(std::vector<GroupExamination::Result> results, GroupCheck group,
                      const OutlierOptions& options, double significance) {
  group.measurements = static_cast<int>(results.size());
  for (auto& [check, chi2, redundancy] : results) {
    group.chi2 += chi2;
    group.redundancy += redundancy;
    check.is_suspect = check.probability < significance;
    group.suspects += check.is_suspect ? 1 : 0;
  }
  if (group.redundancy > kUnchecked) {
    const double above = chiSquareProbability(group.chi2, group.redundancy);
    group.probability = 2 * std::min(above, 1 - above);
  }
  const auto worse = [](const auto& a, const auto& b) {
    const auto& x = a.check;
    const auto& y = b.check;
    return x.probability != y.probability ? x.probability < y.probability : x.studentized > y.studentized;
  };
  const std::size_t count = std::min(results.size(), static_cast<std::size_t>(std::max(0, options.worst)));
  std::partial_sort(results.begin(), results.begin() + static_cast<std::ptrdiff_t>(count), results.end(),
                    worse);
  for (std::size_t i = 0; i < count; ++i) group.worst.push_back(std::move(results[i].check));
  return group;
}

std::string row(const char* name, const MeasurementCheck& check) {
  const ClassicNumbers points;
  char text[160];
  std::snprintf(text, sizeof text, "  %-24s %9.3g %11.3g %10.3g %7.3g %11.2g %9.3g%s\n", name, check.residual,
                check.studentized, check.redundancy, check.weight, check.probability, check.effect,
                check.is_suspect ? "  suspect" : "");
  return text;
}

}  // namespace

OutlierReport checkResiduals(System& system, Linearizer& linearizer, const OutlierOptions& options,
                             double variance_factor, FreeGauge gauge) {
  if (!(options.significance > 0 && options.significance < 1)) {
    throw Error("slom.bad-option", "the significance of OutlierOptions is " +
                                       number(options.significance, 6) +
                                       "; pass a probability between 0 and 1, such as 0.01");
  }
  OutlierReport report;
  report.variance_factor = variance_factor;
  Problem& problem = system.problem();
  int count = 0;
  for (const auto& pool : problem.pools()) count += pool->size();
  report.significance = options.significance / std::max(1, count);
  const auto inverse = inverseBlocks(system, linearizer, gauge);
  for (int g = 0; g < problem.groupCount(); ++g) {
    GroupCheck group;
    std::vector<GroupExamination::Result> results;
    for (std::size_t p = 0; p < problem.pools().size(); ++p) {
      const MeasurementPool& pool = *problem.pools()[p];
      if (pool.group() != g || pool.size() == 0) continue;
      std::vector<GroupExamination::Result> more =
          GroupExamination(system, *inverse, p, variance_factor).run();
      std::move(more.begin(), more.end(), std::back_inserter(results));
      group.name = pool.name();
      group.has_losses = group.has_losses || pool.lossCount() > 0;
    }
    if (results.empty()) continue;
    report.groups.push_back(summarized(std::move(results), std::move(group), options, report.significance));
  }
  return report;
}

int OutlierReport::suspects() const {
  int sum = 0;
  for (const GroupCheck& group : groups) sum += group.suspects;
  return sum;
}

std::string OutlierReport::text() const {
  const ClassicNumbers points;
  std::string all;
  char line[200];
  for (const GroupCheck& group : groups) {
    std::snprintf(line, sizeof line,
                  "%s: %s, chi-square %.6g where %.6g is expected (probability %.2g), %s\n",
                  group.name.c_str(), counted(group.measurements, "measurement").c_str(), group.chi2,
                  group.redundancy, group.probability, counted(group.suspects, "suspect").c_str());
    all += line;
    std::snprintf(line, sizeof line, "  %-24s %9s %11s %10s %7s %11s %9s\n", "measurement", "residual",
                  "studentized", "redundancy", "weight", "probability", "effect");
    all += line;
    for (const MeasurementCheck& check : group.worst) all += row(check.measurement.c_str(), check);
  }
  return all;
}

std::ostream& operator<<(std::ostream& os, const OutlierReport& report) { return os << report.text(); }

}  // namespace slom
