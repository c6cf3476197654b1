#include "slom/optimize/evaluator.hpp"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/stopwatch.hpp"
#include "optimize/active_bounds.hpp"
#include "optimize/lengths.hpp"
#include "optimize/second_look.hpp"

namespace slom {

namespace {
/// Returns whether the largest of some products of squares is right: no product that matters overflowed or underflowed.
bool isWellScaled(double largest) { return largest > 1e-200 && largest < 1e200; }
}  // namespace

Evaluator::~Evaluator() = default;

void Evaluator::setSolver(LinearSolver& solver) {
  given_ = solver_ = &solver;
  collective_ = &solver.collective();
  careful_.reset();
  changes_ = StructureChanges::all();
  analyzed_at_ = linearized_at_ = ~std::uint64_t{0};
}

const ProblemStructure& Evaluator::structure() {
  if (structured_at_ != problem_.structureRevision()) {
    const detail::Stopwatch watch(setup_seconds_);
    const std::uint64_t before = std::exchange(structured_at_, ~std::uint64_t{0});
    if (const auto changes = problem_.changesSince(before)) {
      changes_.add(updateStructure(problem_, *changes, structure_));
    } else {
      structure_ = makeStructure(problem_);
      changes_ = StructureChanges::all();
    }
    structured_at_ = problem_.structureRevision();
    linearized_at_ = ~std::uint64_t{0};
  }
  return structure_;
}

int Evaluator::unknowns() {
  const BlockStructure& system = structure().system;
  if (collective_->isAlone()) return system.unknowns();
  int own = 0;
  for (int b = 0; b < system.blockCount(); ++b) own += collective_->counts(b) ? system.dof(b) : 0;
  return static_cast<int>(collective_->sum(own));
}

int Evaluator::residuals() { return static_cast<int>(collective_->sum(structure().residuals)); }

int Evaluator::fixedOrActiveCount() {
  const ActiveSet& active = problem_.activeSet();
  if (collective_->isAlone()) return active.fixedOrActiveCount();
  int own = 0;
  for (const int v : active.constrained()) {
    if (!active.isOptimized(v) || !collective_->counts(v)) continue;
    for (int c = 0; c < structure().system.dof(v); ++c) own += active.isFixedOrActive(v, c) ? 1 : 0;
  }
  return static_cast<int>(collective_->sum(own));
}

void Evaluator::analyze() {
  structure();
  if (collective_->all(analyzed_at_ == structured_at_)) return;
  const detail::Stopwatch watch(setup_seconds_);
  solver_ = given_;
  careful_.reset();
  ++content_of_solver_;
  const StructureChanges changes = std::exchange(changes_, StructureChanges::all());
  if (!collective_->isAlone()) {
    solver_->update(structure_.system, StructureChanges::all());
  } else if (changes.any()) {
    solver_->update(structure_.system, changes);
  }
  changes_ = {};
  analyzed_at_ = structured_at_;
}

bool Evaluator::isSolverExact() {
  analyze();
  return solver_->isExact();
}

LinearSolver& Evaluator::lendSolver() {
  analyze();
  linearized_at_ = ~std::uint64_t{0};
  ++content_of_solver_;
  return *solver_;
}

double Evaluator::linearize() {
  structure();
  if (collective_->all(linearized_at_ == problem_.valueRevision() && analyzed_at_ == structured_at_))
    return rss_;
  analyze();
  const detail::Stopwatch watch(linearize_seconds_);
  linearized_at_ = ~std::uint64_t{0};
  ++content_of_solver_;
  ActiveSet& active = problem_.activeSet();
  collective_->agree([&] {
    rss_ = linearizeAtBounds(problem_, structure_, linearizer_, active, *solver_, [this] {
      requireGradientLengths(*solver_, structure_.system.unknowns());
      return solver_->gradient();
    });
  });
  solver_->completeLinearization();
  rss_ = collective_->sum(rss_);
  squared_norm_ = collective_->sum(linearizer_.squaredNormSent());
  requireRange();
  linearized_at_ = problem_.valueRevision();
  return rss_;
}

/// Checks that products of the linearisation are finite.
void Evaluator::requireRange() {
  requireGradientLengths(*solver_, structure_.system.unknowns());
  const bool is_good =
      rss_ <= Linearizer::kLargestRss && solver_->gradient().allFinite() && solver_->diagonal().allFinite();
  if (collective_->all(is_good)) return;
  collective_->agree([&] {
    if (!is_good) linearizer_.raiseOverflow(problem_);
  });
}

void Evaluator::move(const Eigen::VectorXd& d) {
  requireStepLength(d.size(), structure_.system.unknowns());
  problem_.save();
  if (problem_.activeSet().hasBounds()) {
    problem_.applyStep(structure_.system.offset, clampedToBounds(problem_, structure_, d).data());
    roundToBounds(problem_);
  } else {
    problem_.applyStep(structure_.system.offset, d.data());
  }
}

Eigen::VectorXd Evaluator::withinBounds(const Eigen::VectorXd& d) const {
  requireStepLength(d.size(), structure_.system.unknowns());
  return clampedToBounds(problem_, structure_, d);
}

double Evaluator::tryStep(const Eigen::VectorXd& d) {
  const detail::Stopwatch watch(linearize_seconds_);
  saved_is_linearized_ = linearized_at_ == problem_.valueRevision();
  move(d);
  try {
    return rss();
  } catch (...) {
    undo();
    throw;
  }
}

double Evaluator::rss() {
  double rss = 0;
  collective_->agree([&] { rss = linearizer_.rss(problem_); });
  rss = collective_->sum(rss);
  return rss <= Linearizer::kLargestRss ? rss : std::numeric_limits<double>::quiet_NaN();
}

double Evaluator::largestLossArgument() {
  double largest = -1;
  collective_->agree([&] { largest = linearizer_.largestLossArgument(problem_); });
  return collective_->max(largest);
}

double Evaluator::tryLikelyStep(const Eigen::VectorXd& d) {
  if (hasNumericDerivatives()) return tryStep(d);
  saved_is_linearized_ = false;
  move(d);
  try {
    return linearize();
  } catch (const Error&) {  // not finite, or the function threw; the usual path reports it
    undo();
    return tryStep(d);
  } catch (...) {
    undo();
    throw;
  }
}

bool Evaluator::hasFiniteDerivatives() {
  if (linearized_at_ != problem_.valueRevision()) saved_is_linearized_ = false;
  try {
    linearize();
    return true;
  } catch (const Error& error) {
    if (error.id() == "slom.not-finite" || error.id() == "slom.overflow") return false;
    undo();
    throw;
  } catch (...) {
    undo();
    throw;
  }
}

bool Evaluator::cameCloser(const Eigen::VectorXd& damping, double promised) {
  if (!hasFiniteDerivatives()) return false;
  Eigen::VectorXd next;
  return (collective_->all(damping.size() == 0) ? solveUndamped(next) : solveDamped(damping, next)).ok &&
         predictedDecrease(next, damping) < promised;
}

void Evaluator::undo() {
  problem_.restore();
  linearized_at_ = saved_is_linearized_ ? problem_.valueRevision() : ~std::uint64_t{0};
}

void Evaluator::setLossGraduation(double mu) {
  linearizer_.setLossGraduation(mu);
  linearized_at_ = ~std::uint64_t{0};
}

bool Evaluator::mayBeRounding(double change) const {
  constexpr double most = 1e-8;
  constexpr double steep = 0.1;  // from here on, a step changes residuals much more than rounding does
  return std::abs(change) <= kNoise * rss_ || (std::abs(change) <= most * rss_ && orthogonality() <= steep);
}

double Evaluator::orthogonality() const {
  return collective_->max(orthogonality(solver_->gradient(), solver_->diagonal(), squared_norm_));
}

double Evaluator::orthogonality(const Eigen::VectorXd& gradient, const Eigen::VectorXd& diagonal,
                                double squared_norm) {
  const double r = std::sqrt(squared_norm);
  const auto g = gradient.array();
  const auto h = diagonal.array();
  if (g.size() == 0 || !(r > 0)) return 0;
  if ((h <= 0 && g != 0).any()) return 1;  // rounding or underflow destroyed the length of a column
  const double squared = (h > 0).select(g.square() / h, 0.0).maxCoeff();
  if (isWellScaled(squared)) return std::sqrt(squared) / r;
  return (h > 0).select(g.abs() / h.sqrt(), 0.0).maxCoeff() / r;
}

double Evaluator::promiseOfOneUnknown() const { return std::pow(orthogonality(), 2) * squared_norm_; }

double Evaluator::stepInDeviations(const Eigen::VectorXd& d) const {
  const auto h = solver_->diagonal().array();
  if (d.size() == 0) return collective_->max(0);
  const double squared = (d.array().square() * h).maxCoeff();
  return collective_->max(isWellScaled(squared) ? std::sqrt(squared)
                                                : (d.array().abs() * h.sqrt()).maxCoeff());
}

Eigen::VectorXd Evaluator::typicalSizes() {
  Eigen::VectorXd sizes(structure_.system.unknowns());
  const auto& table = problem_.variables();
  for (int b = 0; b < structure_.system.blockCount(); ++b) {
    if (structure_.system.isEmpty(b)) continue;
    const VariableRecord& record = table[static_cast<std::size_t>(b)];
    record.store->typicalSizes(record.slot, sizes.data() + structure_.offsetOf(b));
  }
  return sizes;
}

SolveStatus Evaluator::solve(const Eigen::VectorXd& damping, Eigen::VectorXd& step) {
  const SolveStatus status = solver_->solve(damping, step);
  if (status.ok) requireSolutionLength(*solver_, step.size(), structure_.system.unknowns());
  return status;
}

/// Lets the careful solver look again if the solver found no full rank; if it finds full rank, it takes over. Returns
/// the final status. Sets `has_changed` if another solver is to be used.
SolveStatus Evaluator::lookAgain(SolveStatus status, bool& has_changed) {
  has_changed = false;
  if (status.ok) return status;
  status.least = solver_->leastOfColumn();
  if (careful_ != nullptr || !collective_->isAlone() || mustStop()) return status;
  SecondLook look = slom::lookAgain(
      problem_, structure_, *given_, status, digitsOfDerivatives(problem_),
      [this](LinearSolver& careful) { linearizer_.linearize(problem_, problem_.activeSet(), careful); });
  if (look.was_asked && look.solver == nullptr) careful_failed_at_ = structured_at_;
  if (look.solver == nullptr) return look.status;
  careful_ = std::move(look.solver);
  solver_ = careful_.get();
  ++content_of_solver_;
  has_changed = true;
  return look.status;
}

double Evaluator::digitsOfDerivatives(const Problem& problem) {
  return problem.hasNumericDerivatives() ? kNumericDigits : kExactDigits;
}

/// Sets d to 0 for components that are fixed or at an active bound: rounding in their equations must not move them.
void Evaluator::clearConstrained(Eigen::VectorXd& d) const {
  for (const int v : problem_.activeSet().constrained()) {
    const VariableRecord& record = problem_.variables()[static_cast<std::size_t>(v)];
    if (!problem_.activeSet().isOptimized(v)) continue;
    for (int c = 0; c < record.dof; ++c) {
      if (problem_.activeSet().isFixedOrActive(v, c)) d[structure_.offsetOf(v) + c] = 0;
    }
  }
}

bool Evaluator::isNegligible(const Eigen::VectorXd& d, double tolerance) {
  return collective_->all(isNegligibleHere(d, tolerance));
}

bool Evaluator::isNegligibleHere(const Eigen::VectorXd& d, double tolerance) {
  std::vector<double> sizes;
  for (int v = 0; v < structure_.system.blockCount(); ++v) {  // usually ends at the first one
    if (structure_.system.isEmpty(v)) continue;
    const VariableRecord& record = problem_.variables()[static_cast<std::size_t>(v)];
    sizes.resize(static_cast<std::size_t>(record.dof));
    record.store->typicalSizes(record.slot, sizes.data());
    for (int c = 0; c < record.dof; ++c) {
      const int i = structure_.offsetOf(v) + c;
      const double column = std::sqrt(solver_->diagonal()[i]);
      const double limit = tolerance * (sizes[static_cast<std::size_t>(c)] + (column > 0 ? 1 / column : 0));
      if (!(std::abs(d[i]) <= limit)) return false;
    }
  }
  return true;
}

double Evaluator::predictedDecrease(const Eigen::VectorXd& d) const {
  requireStepLength(d.size(), structure_.system.unknowns());
  return -(2 * collective_->dot(solver_->gradient(), d) + solver_->squaredNormOfJd(d));
}

double Evaluator::predictedDecrease(const Eigen::VectorXd& d, const Eigen::VectorXd& damping) const {
  if (!solver_->isExact()) return predictedDecrease(d);
  requireStepLength(d.size(), structure_.system.unknowns());
  // A process without unknowns has an empty vector in any case.
  const double damped = collective_->any(damping.size() > 0) ? collective_->dot(damping, d.cwiseAbs2()) : 0;
  return damped - collective_->dot(solver_->gradient(), d);
}

PhaseSeconds Evaluator::seconds() const {
  const SolverSeconds other = careful_ != nullptr ? careful_->seconds() : SolverSeconds{};
  return {setup_seconds_, linearize_seconds_, given_->seconds().factorize + other.factorize,
          given_->seconds().solve + other.solve};
}

}  // namespace slom
