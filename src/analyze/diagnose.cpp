#include "analyze/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>

#include "analyze/directions.hpp"
#include "analyze/gauge.hpp"
#include "analyze/null_space.hpp"
#include "analyze/residual_tests.hpp"
#include "analyze/singular.hpp"
#include "base/classic_numbers.hpp"
#include "base/decompositions.hpp"
#include "base/index.hpp"
#include "base/words.hpp"
#include "problem/stated_noise.hpp"

namespace slom {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Kind = Finding::Kind;

/// Correlation above which a pair of unknowns is reported.
constexpr double kCorrelated = 0.999;
/// Number of variables of a type up to which correlations are examined. In larger types, such as chains, neighbours are
/// always correlated.
constexpr int kFew = 20;
/// Number of unknowns up to which correlations are examined: their covariance matrix is dense.
constexpr int kMostDenseUnknowns = 600;
/// Ratio of the largest to the smallest |J_i| above which other units are recommended.
constexpr double kBadScale = 1e12;
/// Number of correlations that are reported, the largest first.
constexpr std::size_t kMostCorrelations = 5;
/// Number of poorly determined directions that are reported one by one, the worst first. The others are counted.
constexpr Index kMostWeak = 20;
/// A group's stated uncertainty is implausible if two conditions hold. The probability of its chi-square is below
/// kImplausible, and the factor sqrt(chi2 / redundancy) of its standard deviations is outside [1 / kNoteworthy,
/// kNoteworthy]. A factor below kNoNoise comes from data that were computed without noise.
constexpr double kImplausible = 1e-3, kNoteworthy = 1.2, kNoNoise = 1e-6;

class Examination {
 public:
  explicit Examination(const LinearizedProblem& linearized)
      : linearized_(linearized), problem_(linearized.problem()), structure_(linearized.structure()) {}

  Diagnosis run() {
    result_.residuals = structure_.residuals;
    result_.unknowns = result_.rank = structure_.system.unknowns() > 0 ? linearized_.freeUnknowns() : 0;
    findMeasurementsOfFixedVariables();
    if (result_.unknowns == 0) return std::move(result_);
    const NearNullSpace& least = linearized_.nearNullSpace();
    const Index none = least.countBelow(linearized_.digitsOfDerivatives());
    result_.rank -= least.dimension(linearized_.digitsOfDerivatives());
    const std::vector<ConnectedPart> parts = connectedParts(structure_.system);
    findUnobserved(least);
    for (const ConnectedPart& part : parts) explain(part, least.direction.leftCols(none), least.scale);
    describeWeak(least, none);
    findParts(parts);
    findBadScales(least);
    if (!result_.isDetermined() || !canInvert()) return std::move(result_);
    findCorrelations();
    judgeSigmas();
    return std::move(result_);
  }

 private:
  void add(Kind kind, bool is_fault, std::string text, std::vector<std::string> names, int dimension = 0) {
    result_.findings.push_back({kind, is_fault, std::move(text), std::move(names), dimension});
  }
  bool isFixedOrActive(int unknown) const {
    const int variable = variableOf(structure_, unknown);
    return isFixedOrActive(variable, unknown - structure_.offsetOf(variable));
  }
  bool isFixedOrActive(int variable, int component) const {
    return linearized_.activeSet().isFixedOrActive(variable, component);
  }
  std::string nameOf(int unknown) const { return unknownName(problem_, structure_, unknown); }
  const VariableRecord& recordOf(int variable) const { return problem_.variables()[at(variable)]; }

  void findMeasurementsOfFixedVariables() {
    struct Count {
      std::string name;
      int without_unknowns = 0, all = 0;
    };
    std::vector<Count> counts(at(problem_.groupCount()));
    for (std::size_t p = 0; p < problem_.pools().size(); ++p) {
      const MeasurementGroup& group = structure_.system.groups[p];
      Count& count = counts[at(problem_.pools()[p]->group())];
      count.name = problem_.pools()[p]->name();
      count.all += group.size();
      for (int m = 0; m < group.size(); ++m) {
        const auto first = group.blocks.begin() + m * group.arity;
        if (std::all_of(first, first + group.arity, [](int block) { return block < 0; }))
          ++count.without_unknowns;
      }
    }
    for (const auto& [name, unused, all] : counts) {
      if (unused == 0) continue;
      add(Kind::constant_measurements, false,
          std::to_string(unused) + " of " + counted(all, "measurement") + " " + name + " depend" +
              (unused == 1 ? "s" : "") +
              " on fixed variables alone: they count in chi-square and redundancy, but determine nothing",
          {name});
    }
  }

  bool dependsByDifferences(int variable) const {
    bool depends = false;
    problem_.forEachUse(variable, [&](const MeasurementPool& pool, int) {
      depends = depends || pool.derivatives() == DerivativeSource::numeric;
    });
    return depends;
  }

  void findUnobserved(const NearNullSpace& least) {
    std::map<int, std::vector<std::string>> components_of;  // by variable
    for (const int unknown : least.unobserved) {
      components_of[variableOf(structure_, unknown)].push_back(nameOf(unknown));
    }
    for (const auto& [variable, names] : components_of) {
      if (recordOf(variable).uses == 0) {
        add(Kind::unmeasured_variable, true, unmeasured(problem_.variableName(variable)),
            {problem_.variableName(variable)}, static_cast<int>(names.size()));
      } else {
        const std::string them = names.size() == 1 ? "it" : "them";
        add(Kind::unobserved_component, true,
            "no residual changes with " + listed(names) +
                (dependsByDifferences(variable)
                     ? ", by differences of small steps: if the function rounds its results, pass larger "
                       "steps, as in slom::numeric(f, slom::differences(1e-2)); otherwise add"
                     : ", to first order: add") +
                " measurements that depend on " + them + " or a prior, or fix " + them,
            names, static_cast<int>(names.size()));
      }
    }
  }

  void explain(const ConnectedPart& part, const MatrixXd& none, const VectorXd& scale) {
    MatrixXd own = none(part.unknowns, Eigen::all);
    if (own.norm() < 0.5) return;  // a near-null direction of this part has unit length
    const SVD svd = svdOf(own, Eigen::ComputeThinU);
    own = svd.matrixU().leftCols((svd.singularValues().array() > 0.5).count());
    const Gauge gauge =
        part.variables.size() > 1 ? findGauge(problem_, structure_, part, own, scale) : Gauge();
    if (gauge.count() > 0) {
      result_.findings.push_back(findingOf(gauge, part, problem_, structure_));
      const MatrixXd rest = own - gauge.directions * (gauge.directions.transpose() * own);
      const SVD rest_svd = svdOf(rest, Eigen::ComputeThinU);
      own = rest_svd.matrixU().leftCols(own.cols() - gauge.count());
    }
    if (own.cols() > 0) describeUndetermined(part, own, scale);
  }

  Movement movement(const std::vector<int>& unknowns, const VectorXd& direction,
                    const VectorXd& scale) const {
    return movementAlong(direction, scale, unknowns, [this](int unknown) { return nameOf(unknown); });
  }

  /// Returns whether several numbers move by the same amount, such as the heights of a levelling network.
  bool isShift(const Movement& moves, const std::vector<int>& unknowns, const VectorXd& direction) const {
    const auto is_same = [](const std::string& amount) { return amount == "+1"; };
    if (moves.names.size() < 2 || !std::ranges::all_of(moves.amounts, is_same)) return false;
    const double least = kNegligibleEntry * direction.cwiseAbs().maxCoeff();
    for (Index i = 0; i < direction.size(); ++i) {
      if (std::abs(direction[i]) > least &&
          recordOf(variableOf(structure_, unknowns[at(static_cast<int>(i))])).dof > 1)
        return false;
    }
    return true;
  }

  void describeUndetermined(const ConnectedPart& part, const MatrixXd& own, const VectorXd& scale) {
    const MatrixXd basis = basisOfFewEntries(own);
    for (Index j = 0; j < basis.cols(); ++j) {
      const Movement moves = movement(part.unknowns, basis.col(j), scale);
      std::string text;
      if (moves.names.size() == 1) {
        text = "nothing determines " + moves.names[0] +
               ": it can move without changing any residual; add measurements that depend on it or a prior, "
               "or fix it";
      } else if (moves.names.size() == 2) {
        text =
            moves.names[0] + " and " + moves.names[1] + " cannot be told apart: moving them by " +
            moves.amounts[0] + " and " + moves.amounts[1] +
            " changes no residual, to first order; fix one of them, or add a prior or measurements that depend on "
            "them in another way";
      } else {
        text = listed(moves.names) + " can move together (by " + listed(moves.amounts) +
               ") without changing any residual; fix " +
               "one of them, or add a prior or measurements that depend on them in another way";
      }
      add(isShift(moves, part.unknowns, basis.col(j)) ? Kind::gauge : Kind::undetermined, true, text,
          moves.names, 1);
    }
  }

  void describeWeak(const NearNullSpace& least, Index none) {
    std::vector<int> all(at(structure_.system.unknowns()));
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
    const Index weak = least.countBelow(kNearNull);
    for (Index k = none; k < std::min(weak, none + kMostWeak); ++k) {
      const VectorXd direction = least.direction.col(k);
      const Movement moves = movement(all, direction, least.scale);
      Index largest = 0;  // the first of the entries that are equal up to rounding
      const double most = direction.cwiseAbs().maxCoeff();
      while (std::abs(direction[largest]) * (1 + 1e-6) < most) ++largest;
      const double deviation = std::abs(direction[largest]) / least.scale[largest] / least.influence[k];
      add(Kind::weak, false,
          listed(moves.names) + (moves.names.size() == 1 ? " is" : " are") + " hardly determined: " +
              (moves.names.size() == 1 ? "" : "moving together (by " + listed(moves.amounts) + "), ") +
              nameOf(static_cast<int>(largest)) + " has a standard deviation of " + number(deviation),
          moves.names, 1);
    }
    if (weak > none + kMostWeak) {
      const Index more = weak - none - kMostWeak;
      add(Kind::weak, false,
          (least.may_miss_some ? "at least " : "") + counted(static_cast<int>(more), "more direction") +
              (more == 1 ? " is" : " are") +
              " hardly determined; check that all components of all measurements are as certain as stated",
          {}, static_cast<int>(more));
    }
  }

  void findParts(const std::vector<ConnectedPart>& parts) {
    if (parts.size() < 2) return;
    std::vector<std::string> who;
    for (const ConnectedPart& part : parts) {
      std::vector<std::string> names;
      for (const int variable : part.variables) names.push_back(problem_.variableName(variable));
      who.push_back(abridged(names));
    }
    std::string text =
        "the variables form " + std::to_string(parts.size()) + " groups that no measurement connects: ";
    for (std::size_t p = 0; p < who.size() && p < 3; ++p) text += (p > 0 ? "; " : "") + who[p];
    if (who.size() > 3) text += "; and " + std::to_string(who.size() - 3) + " more";
    add(Kind::disconnected, false, text, who);
  }

  void findBadScales(const NearNullSpace& least) {
    Index small = -1, large = -1;
    for (Index i = 0; i < least.scale.size(); ++i) {
      if (std::binary_search(least.unobserved.begin(), least.unobserved.end(), static_cast<int>(i)) ||
          isFixedOrActive(static_cast<int>(i)))
        continue;
      if (small < 0 || least.scale[i] < least.scale[small]) small = i;
      if (large < 0 || least.scale[i] > least.scale[large]) large = i;
    }
    if (small < 0 || !(least.scale[large] > kBadScale * least.scale[small])) return;
    const std::string a = nameOf(static_cast<int>(large)), b = nameOf(static_cast<int>(small));
    add(Kind::badly_scaled, false,
        "a unit of " + a + " changes the residuals " + number(least.scale[large] / least.scale[small], 1) +
            " times as much as a unit of " + b +
            ": choose units in which both are of a size that can be told apart from 0",
        {a, b});
  }

  /// Returns whether the solver can factorise J^T J. It may fail if some directions are poorly determined.
  bool canInvert() {
    MatrixXd ignored;
    return linearized_.solveFor(MatrixXd(structure_.system.unknowns(), 0), ignored).ok;
  }

  void findCorrelations() {
    std::map<const VariableStoreBase*, int> count_of;
    const int table = structure_.system.blockCount();
    for (int v = 0; v < table; ++v) count_of[recordOf(v).store] += structure_.system.isEmpty(v) ? 0 : 1;
    std::vector<int> unknowns;
    for (int v = 0; v < table; ++v) {
      if (count_of[recordOf(v).store] > kFew) continue;
      for (int c = 0; c < structure_.system.dof(v); ++c) {
        if (!isFixedOrActive(v, c)) unknowns.push_back(structure_.offsetOf(v) + c);
      }
    }
    const Index n = static_cast<Index>(unknowns.size());
    if (n < 2 || n > kMostDenseUnknowns) return;
    MatrixXd units = MatrixXd::Zero(structure_.system.unknowns(), n), columns;
    for (Index j = 0; j < n; ++j) units(unknowns[static_cast<std::size_t>(j)], j) = 1;
    if (!linearized_.solveFor(units, columns).ok) return;
    const MatrixXd C = columns(unknowns, Eigen::all);
    struct Pair {
      Index i, j;
      double correlation;
    };
    std::vector<Pair> pairs;
    for (Index j = 0; j < n; ++j) {
      for (Index i = 0; i < j; ++i) {
        const double correlation = C(i, j) / std::sqrt(C(i, i) * C(j, j));
        if (std::abs(correlation) > kCorrelated) pairs.push_back({i, j, correlation});
      }
    }
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
      return std::abs(a.correlation) > std::abs(b.correlation);
    });
    if (pairs.size() > kMostCorrelations) pairs.resize(kMostCorrelations);
    for (const Pair& pair : pairs) {
      const std::string a = nameOf(unknowns[static_cast<std::size_t>(pair.i)]),
                        b = nameOf(unknowns[static_cast<std::size_t>(pair.j)]);
      const ClassicNumbers points;
      char text[32];
      std::snprintf(text, sizeof text, "%.*f", std::abs(pair.correlation) > 0.9999 ? 6 : 4, pair.correlation);
      add(Kind::correlated, false,
          a + " and " + b + " can hardly be told apart (correlation " + text +
              "): add measurements that depend on them in another way or a prior, or fix one of them",
          {a, b});
    }
  }

  bool isStated(const std::string& group) const {
    return std::ranges::any_of(problem_.pools(),
                               [&](const auto& pool) { return pool->name() == group && statesNoise(*pool); });
  }

  /// Compares the residuals of each group with its stated standard deviations. Residuals are evidence for standard
  /// deviations only at a minimum and only if the data contain noise.
  void judgeSigmas() {
    if (!(linearized_.orthogonality() < kAtMinimum) || !linearized_.hasInverse()) return;
    for (const GroupCheck& group : checkGroups(linearized_)) {
      if (group.has_losses || !(group.redundancy > 0) || !isStated(group.name)) continue;
      const double factor = std::sqrt(group.chi2 / group.redundancy);
      if (!(group.probability < kImplausible) || (factor < kNoteworthy && factor > 1 / kNoteworthy) ||
          factor < kNoNoise)
        continue;
      add(Kind::implausible_sigma, false,
          "the residuals of " + group.name + " contradict its stated uncertainty: chi-square " +
              number(group.chi2) + " where " + number(group.redundancy) +
              " is expected; if function and data are right, its standard deviations are " +
              number(factor > 1 ? factor : 1 / factor) + " times as " + (factor > 1 ? "large" : "small") +
              " as stated",
          {group.name});
    }
  }

  const LinearizedProblem& linearized_;
  const Problem& problem_;
  const ProblemStructure& structure_;
  Diagnosis result_;
};

}  // namespace

Diagnosis diagnose(const LinearizedProblem& linearized) { return Examination(linearized).run(); }

std::string Diagnosis::text() const {
  std::string all = unconvergedLine(unconverged) + "rank " + std::to_string(rank) + " of " +
                    counted(unknowns, "unknown") + ", " + counted(residuals, "residual") + "\n";
  for (const Finding& finding : findings)
    all += std::string(finding.is_fault ? "  fault: " : "  hint: ") + finding.text + "\n";
  return all;
}

std::ostream& operator<<(std::ostream& os, const Diagnosis& diagnosis) { return os << diagnosis.text(); }

}  // namespace slom
