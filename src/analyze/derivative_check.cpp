#include "slom/analyze/derivative_check.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>

#include <Eigen/Core>

#include "base/words.hpp"

namespace slom {

namespace {

using Block = Eigen::Map<const Eigen::MatrixXd>;

/// Returns |a - b| relative to the larger of the two, measured by their largest entries.
double distance(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const double scale = std::max(a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff());
  return scale > 0 ? (a - b).cwiseAbs().maxCoeff() / scale : 0;
}

/// Returns the likely mistake that turns `reference` into `used`. `left` maps perturbations on the left to
/// perturbations on the right.
std::string guessCause(const Eigen::MatrixXd& used, const Eigen::MatrixXd& reference,
                       const Eigen::MatrixXd& left) {
  constexpr double same = 1e-3;
  if (!used.allFinite())
    return "an entry is not finite: the function that gives the derivatives left it unset";
  if (!reference.allFinite()) return "the function is not finite next to this point";
  if (used.isZero(0)) return "all derivatives by this variable are zero: they were forgotten";
  if (reference.isZero(0)) return "the residual does not depend on this variable";
  if (distance(used, -reference) < same) return "the sign is wrong";
  const bool square = used.rows() == used.cols() && used.rows() > 1;
  if (square && distance(used, reference.transpose()) < same) return "it is transposed";
  if (square && distance(used, -reference.transpose()) < same)
    return "it is transposed, and the sign is wrong";
  const Eigen::MatrixXd on_the_left = reference * left;
  if (distance(used, on_the_left) < same) {
    return "it is the derivative by a rotation on the left, exp(d) R; rotations are perturbed on the right, R exp(d): "
           "multiply by the rotation matrix from the right";
  }
  if (distance(used, -on_the_left) < same) {
    return "it is the derivative by a rotation on the left, exp(d) R, with the wrong sign; rotations are perturbed on the "
           "right, R exp(d)";
  }
  const double factor = used.cwiseProduct(reference).sum() / reference.squaredNorm();
  if (std::abs(factor) > 0 && distance(used, factor * reference) < same) {
    constexpr double degrees = 57.29577951308232;
    std::string text = "it is too large by the factor " + number(factor, 6);
    if (std::abs(factor / degrees - 1) < same || std::abs(factor * degrees - 1) < same)
      text += ": degrees instead of radians, or the other way round";
    return text;
  }
  for (Eigen::Index c = 0; c < used.cols(); ++c) {
    if (used.col(c).isZero(0) && !reference.col(c).isZero(0))
      return "the derivatives by this component are zero: they were forgotten";
  }
  return "no simple cause: compare the formula with the function";
}

class Comparison {
 public:
  Comparison(const Problem& problem, MeasurementPool& pool) : problem_(problem), pool_(pool) {
    result_.group = pool.name();
    result_.source = pool.derivatives();
  }

  /// Excludes from now on entries that differences cannot judge.
  void beCautious() { is_cautious_ = true; }

  GroupDerivativeCheck run(int most) {
    const int count = std::min(pool_.size(), most);
    const auto chosen = [&](int i) {
      return static_cast<int>(static_cast<long long>(i) * pool_.size() / count);
    };
    for (int i = 0; i < count; ++i) findLargest(chosen(i));
    for (int i = 0; i < count; ++i) compare(chosen(i));
    if (result_.error <= DerivativeCheck::kTolerance) result_.guess.clear();
    return result_;
  }
  bool hasEntries() const { return compared_; }

 private:
  /// Notes the largest derivatives of a measurement by each of its variables.
  void findLargest(int i) {
    const int rows = pool_.rows(i);
    residual_.resize(static_cast<std::size_t>(rows));
    used_.assign(static_cast<std::size_t>(rows) * static_cast<std::size_t>(pool_.columns(i)), 0);
    pool_.linearizeRaw(i, residual_.data(), used_.data());
    largest_.resize(static_cast<std::size_t>(pool_.arity()), 0);
    std::ptrdiff_t start = 0;
    for (int k = 0; k < pool_.arity(); ++k) {
      const int dof = problem_.variables()[static_cast<std::size_t>(pool_.variables(i)[k])].dof;
      const Block block(used_.data() + start, rows, dof);
      double& largest = largest_[static_cast<std::size_t>(k)];
      if (block.size() > 0 && block.allFinite()) largest = std::max(largest, block.cwiseAbs().maxCoeff());
      start += block.size();
    }
  }
  void compare(int i) {
    const int rows = pool_.rows(i);
    const auto entries = static_cast<std::size_t>(rows) * static_cast<std::size_t>(pool_.columns(i));
    residual_.resize(static_cast<std::size_t>(rows));
    used_.assign(entries, 0);
    reference_.assign(entries, 0);
    pool_.linearizeRaw(i, residual_.data(), used_.data());
    pool_.differenceRaw(i, residual_.data(), reference_.data());
    if (is_cautious_) {
      central_.assign(entries, 0);
      forward_.assign(entries, 0);
      pool_.differenceRaw(i, residual_.data(), central_.data(), Differences::central);
      pool_.differenceRaw(i, residual_.data(), forward_.data(), Differences::forward);
    }
    ++result_.measurements;
    std::ptrdiff_t start = 0;
    for (int k = 0; k < pool_.arity(); ++k) {
      const int variable = pool_.variables(i)[k];
      const VariableRecord& record = problem_.variables()[static_cast<std::size_t>(variable)];
      if (problem_.activeSet().isOptimized(variable)) compareBlock(i, k, record, rows, start);
      start += static_cast<std::ptrdiff_t>(rows) * record.dof;
    }
  }

  void compareBlock(int i, int k, const VariableRecord& record, int rows, std::ptrdiff_t start) {
    // Differences of other measurements lose derivatives of this size to rounding, such as those where a curve is flat.
    constexpr double kLost = 1e-9;
    if (rows == 0 || record.dof == 0) return;
    const int variable = pool_.variables(i)[k];
    const Block used(used_.data() + start, rows, record.dof),
        reference(reference_.data() + start, rows, record.dof);
    if (is_cautious_ && !canJudge(used, reference, start)) return;
    const double scale = std::max(used.cwiseAbs().maxCoeff(), reference.cwiseAbs().maxCoeff());
    Eigen::Index row = 0, column = 0;
    double error = 0;
    if (used.allFinite() && reference.allFinite()) {
      error = (used - reference).cwiseAbs().maxCoeff(&row, &column);
      error = error > kLost * largest_[static_cast<std::size_t>(k)] ? error / scale : 0;
    } else {
      error = std::numeric_limits<double>::infinity();
      for (Eigen::Index e = 0; e < used.size(); ++e) {
        if (std::isfinite(used.data()[e]) && std::isfinite(reference.data()[e])) continue;
        row = e % rows;
        column = e / rows;
        break;
      }
    }
    if (compared_ && !(error > result_.error)) return;
    compared_ = true;
    result_.error = error;
    result_.measurement = pool_.measurementName(i);
    result_.row = static_cast<int>(row);
    result_.component = problem_.componentNames(variable)[static_cast<std::size_t>(column)];
    result_.used = used(row, column);
    result_.reference = reference(row, column);
    Eigen::MatrixXd left(record.dof, record.dof);
    record.store->leftPerturbation(record.store->valueAt(record.slot), left.data());
    result_.guess = guessCause(used, reference, left);
  }

  /// Returns whether differences can judge the given derivatives. They can if central differences with another step and
  /// one-sided differences agree with `reference` 5 times as closely as `used` does.
  bool canJudge(const Block& used, const Block& reference, std::ptrdiff_t start) const {
    const Block central(central_.data() + start, used.rows(), used.cols()),
        forward(forward_.data() + start, used.rows(), used.cols());
    if (!used.allFinite() || !reference.allFinite() || !central.allFinite() || !forward.allFinite())
      return false;
    for (Eigen::Index c = 0; c < used.cols(); ++c) {  // a step function is flat between its steps
      if (reference.col(c).isZero(0) && !used.col(c).isZero(0)) return false;
    }
    const double error = (used - reference).cwiseAbs().maxCoeff();
    return 5 * (central - reference).cwiseAbs().maxCoeff() < error &&
           5 * (forward - reference).cwiseAbs().maxCoeff() < error;
  }

  const Problem& problem_;
  MeasurementPool& pool_;
  GroupDerivativeCheck result_;
  bool compared_ = false, is_cautious_ = false;
  std::vector<double> residual_, used_, reference_, central_, forward_;
  std::vector<double> largest_;  // largest derivative by each argument, of all compared measurements
};

/// Adds a check. Pools of one group share one entry, that of the worst pool.
void add(GroupDerivativeCheck check, DerivativeCheck& result) {
  const auto same = std::find_if(result.groups.begin(), result.groups.end(),
                                 [&](const auto& known) { return known.group == check.group; });
  if (same == result.groups.end()) {
    result.groups.push_back(std::move(check));
    return;
  }
  const int measurements = same->measurements + check.measurements;
  if (check.error > same->error) *same = std::move(check);
  same->measurements = measurements;
}

}  // namespace

std::string GroupDerivativeCheck::sentence() const {
  return "the " + std::string(toString(source)) + " derivative of residual " + std::to_string(row) + " of " +
         measurement + " by " + component + " is " + number(used, 6) + ", differences give " +
         number(reference, 6) + ": " + guess;
}

bool DerivativeCheck::ok() const {
  return std::all_of(groups.begin(), groups.end(),
                     [](const auto& group) { return group.error <= kTolerance; });
}

std::string DerivativeCheck::text() const {
  std::string all;
  for (const GroupDerivativeCheck& g : groups) {
    const bool agrees = g.error <= kTolerance;
    all += g.group + ": " + toString(g.source) + " derivatives of " + std::to_string(g.measurements) +
           (g.measurements == 1 ? " measurement " : " measurements ") + (agrees ? "agree" : "do NOT agree") +
           " with differences; worst: d residual[" + std::to_string(g.row) + "] / d " + g.component + " of " +
           g.measurement + " is " + number(g.used, 6) + ", by differences " + number(g.reference, 6) + "\n";
    if (!agrees) all += "  guess: " + g.guess + "\n";
  }
  return all;
}

std::ostream& operator<<(std::ostream& os, const DerivativeCheck& check) { return os << check.text(); }

DerivativeCheck compareDerivatives(const Problem& problem, int most_of_group) {
  DerivativeCheck result;
  for (const auto& pool : problem.pools()) {
    if (pool->statedStep() > 0) continue;  // differences with shorter steps show nothing
    Comparison comparison(problem, *pool);
    GroupDerivativeCheck group = problem.naming(*pool, [&] { return comparison.run(most_of_group); });
    if (comparison.hasEntries()) add(std::move(group), result);
  }
  return result;
}

DerivativeCheck findWrongDerivatives(const Problem& problem, int most_of_group) {
  DerivativeCheck result;
  for (const auto& pool : problem.pools()) {
    constexpr long most_entries = 100'000;  // of a Jacobian; with more, differences take as long as a fit
    if (pool->derivatives() != DerivativeSource::given || pool->size() == 0) continue;
    if (static_cast<long>(pool->rows(0)) * pool->columns(0) > most_entries) continue;
    Comparison comparison(problem, *pool);
    comparison.beCautious();
    GroupDerivativeCheck group = problem.naming(*pool, [&] { return comparison.run(most_of_group); });
    if (comparison.hasEntries() && group.error > DerivativeCheck::kDoubtful) add(std::move(group), result);
  }
  return result;
}

}  // namespace slom
