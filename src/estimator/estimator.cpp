#include "slom/estimator.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analyze/covariance.hpp"
#include "analyze/diagnose.hpp"
#include "analyze/fit_tables.hpp"
#include "analyze/free_directions.hpp"
#include "analyze/singular.hpp"
#include "base/index.hpp"
#include "base/words.hpp"
#include "estimator/state.hpp"
#include "optimize/lost_rank.hpp"
#include "problem/value_snapshot.hpp"
#include "slom/analyze/chi_square.hpp"
#include "slom/optimize/optimizer.hpp"

namespace slom {

namespace {
double squaredResidual(const Problem& problem, MeasurementPool& pool, int i) {
  Eigen::VectorXd r(pool.rows(i));
  problem.naming(pool, [&] { pool.evaluate(i, i + 1, r.data()); });
  return r.squaredNorm();
}

}  // namespace

void detail::raiseMovedFrom() {
  throw Error("slom.moved-from",
              "the estimator has been moved from and holds nothing; use the one that it was moved to, or "
              "assign another one to it");
}

Estimator::Estimator() : state_(new State) {}
Estimator::~Estimator() = default;
Estimator::Estimator(Estimator&&) noexcept = default;
Estimator& Estimator::operator=(Estimator&&) noexcept = default;

Problem& Estimator::problem() const { return state_->problem; }

int Estimator::dofOf(int variable) const {
  return problem().variables()[static_cast<std::size_t>(variable)].dof;
}

void Estimator::setGroup(const MeasurementHandle& id, const Group& group) {
  const auto [pool, i] = problem().locate(id);
  problem().assignGroups(*pool, i, &group, 1);
}

AnyVarID Estimator::insertVariable(const RuntimeValue& value, bool optimize, std::string_view name) {
  if (value.type == nullptr)
    throw Error("slom.bad-type", "a RuntimeValue has no type; give it one of RuntimeType::make",
                "RuntimeValue");
  const std::vector<double> numbers = value.type->normalized(value.numbers);
  return AnyVarID(problem().insertVariable(value.type, numbers.data(), optimize, name));
}

void Estimator::reinitRV(const AnyVarID& id, const RuntimeValue& value) {
  const int variable = problem().indexOf(id);
  if (value.type == nullptr || RuntimeType::of(id) != value.type) {
    const std::string own = id.store()->typeName();
    const std::string given = value.type == nullptr       ? "has no type"
                              : value.type->name() == own ? "is one with other fields"
                                                          : "is a " + value.type->name();
    throw Error("slom.wrong-type",
                "variable " + problem().variableName(variable) + " is a " + own + ", the new value " + given +
                    "; pass a value of the variable's type",
                problem().variableName(variable));
  }
  problem().setValue(variable, value.type->normalized(value.numbers).data());
}

void Estimator::removeMeasurement(const MeasurementHandle& id) {
  const auto [pool, i] = problem().locate(id);
  problem().removeMeasurement(*pool, i);
}

std::string Estimator::nameOf(const MeasurementHandle& id) const {
  const auto [pool, i] = problem().locate(id);
  return pool->measurementName(i);
}

namespace {
/// Returns enough iterations to leave a singular start.
int fewIterations(const Options& options) {
  constexpr int few = 300;
  return options.max_iterations == Options::kByTheSize ? few : std::min(options.max_iterations, few);
}
}  // namespace

Eigen::VectorXd Estimator::State::stepFromSingularStart(const Summary& summary) {
  constexpr int most_unknowns = 500;
  if (summary.final_rss != summary.initial_rss || evaluator.structure().system.unknowns() > most_unknowns)
    return {};
  const FreeDirections free = analyze(&findFreeDirections);
  const auto freeThere = [&] {
    const FreeDirections there = analyze(&findFreeDirections);
    return there.count - there.gauge;
  };
  if (free.count <= free.gauge) return {};
  ValueSnapshot start(problem);
  const auto isBetterAfter = [&](const Eigen::VectorXd& step) {
    bool is_better = false;
    try {
      is_better = std::isfinite(evaluator.tryStep(step)) && freeThere() < free.count - free.gauge;
    } catch (const Error&) {  // a function or its derivatives have no value there
    }
    start.restore();  // and not evaluator.undo(): the solver has been given other values since
    return is_better;
  };
  return run([&]() -> Eigen::VectorXd {
    evaluator.linearize();
    const Eigen::MatrixXd steps = asSteps(evaluator, free.basis);
    // Steps of the other unknowns: in b exp(-c t), a step of b from 0 determines c.
    const Eigen::VectorXd scale = evaluator.solver().diagonal(), gradient = evaluator.solver().gradient();
    const Eigen::VectorXd downhill = (scale.array() > 0).select(-gradient.array() / scale.array(), 0.0);
    for (Eigen::Index k = 0; k < steps.cols(); ++k) {
      for (const double length : {0.1, -0.1, 1.0, -1.0, 10.0, -10.0}) {
        if (isBetterAfter(length * steps.col(k))) return length * steps.col(k);
      }
    }
    for (const double length : {1.0, 0.1}) {
      if (isBetterAfter(length * downhill)) return length * downhill;
    }
    return {};
  });
}

void Estimator::State::fitFromNearer(const Fit& fit, const Fit& by_damping, const char* why,
                                     Summary& summary) {
  ValueSnapshot before(problem);
  Summary nearer = by_damping();
  if (nearer.converged) {
    Summary again = fit();
    if (again.converged) {
      goOn(summary, std::move(nearer));
      goOn(summary, std::move(again));
      summary.warnings.push_back(std::string(why) + "; Levenberg-Marquardt took the first steps");
      return;
    }
  }
  before.restore();
  current.reset();
}

Summary Estimator::optimize(const Options& options) { return state_->optimize(*state_->algorithm, options); }

Summary Estimator::State::optimize(Algorithm& by, const Options& options) {
  by.reset();
  current.reset();
  Summary before;
  const Collective& processes = evaluator.collective();
  processes.agree(
      [&] { fillGroups(problem, run([&] { return linearizer.rssPerPool(problem); }), before, true); });
  RankAtEnd rank;
  std::function<FreeDirections()> find_free;
  if (processes.isAlone()) find_free = [this] { return analyze(&findFreeDirections); };
  const auto fitBy = [&](Algorithm& algorithm, const Options& limits) {
    return run([&] {
      return runAlgorithm(evaluator, algorithm, limits, sigma == Sigma::estimated, rank, find_free);
    });
  };
  const auto fit = [&] { return fitBy(by, options); };
  std::unique_ptr<FreeNetwork> network = gauge == FreeGauge::inner_constraints ? freeNetwork() : nullptr;
  const bool is_free = network != nullptr;
  Summary summary = is_free ? fitFreeNetwork(fit, std::move(network)) : fit();
  summary.is_free_network = is_free;
  const bool may_go_on = summary.stop_reason == StopReason::rank_deficient && options.fall_back &&
                         by.safeguarded() != nullptr && processes.isAlone();
  const bool is_hidden = evaluator.wasHidden();
  const Eigen::VectorXd step = may_go_on && !is_hidden ? stepFromSingularStart(summary) : Eigen::VectorXd();
  // A long step may bring data back to which a loss gives no weight, but which of them is for the user to say.
  const bool has_losses =
      std::ranges::any_of(problem.pools(), [](const auto& pool) { return pool->lossCount() > 0; });
  if (may_go_on && (is_hidden || step.size() > 0)) {
    LevenbergMarquardt damped;
    Options limits = options;
    if (!is_hidden) limits.max_iterations = fewIterations(options);
    const RankAtEnd rank_before = rank;
    fitFromNearer(
        fit,
        [&] {
          if (step.size() > 0 && !has_losses) run([&] { return evaluator.tryStep(step); });
          return fitBy(damped, limits);
        },
        is_hidden ? "rounding errors of the residuals at the start hide what an unknown changes"
                  : "the start leaves unknowns free, to first order",
        summary);
    if (!summary.converged) rank = rank_before;
  }
  summary.groups = std::move(before.groups);
  complete(summary, options, rank);
  unconverged = summary.converged ? "" : toString(summary.stop_reason);
  unconverged_values = problem.valueRevision();
  unconverged_structure = problem.structureRevision();
  return summary;
}

void Estimator::changeAlgorithm(Algorithm* algorithm) {
  if (algorithm == nullptr) {
    throw Error("slom.no-algorithm",
                "changeAlgorithm got a null pointer; pass a new GaussNewton, LevenbergMarquardt or "
                "DogLeg",
                "changeAlgorithm");
  }
  std::unique_ptr<Algorithm> owned(algorithm);  // owned even if there is no state
  state_->algorithm = std::move(owned);
}

void Estimator::changeSolver(std::unique_ptr<LinearSolver> solver) {
  if (!solver)
    throw Error("slom.no-solver", "changeSolver got a null pointer; pass a BlockSolver, BlockQR or DenseQR",
                "changeSolver");
  state_->current.reset();
  state_->evaluator.setSolver(*solver);
  state_->solver = std::move(solver);
}

void Estimator::setThreads(int threads) {
  if (threads < 0) {
    throw Error("slom.bad-option",
                "the number of threads is " + std::to_string(threads) +
                    "; pass a positive number, or 0 for as many as the machine has",
                "threads");
  }
  state_->arena.setThreads(threads);
  state_->threads = threads;
}

double Estimator::getRSS() const { return state_->rss(); }

double Estimator::rssOfPools(const std::vector<const MeasurementPool*>& pools) const {
  const std::vector<double> rss = state_->run([&] { return state_->linearizer.rssPerPool(problem()); });
  double sum = 0;
  for (std::size_t g = 0; g < rss.size(); ++g) {
    if (std::find(pools.begin(), pools.end(), problem().pools()[g].get()) != pools.end()) sum += rss[g];
  }
  return sum;
}

double Estimator::rssOfVariable(int variable) const {
  double sum = 0;
  problem().forEachUse(variable, [&](MeasurementPool& pool, int i) { sum += rssOfMeasurement(pool, i); });
  return sum;
}

double Estimator::getRSS(const MeasurementHandle& id) const {
  const auto [pool, i] = problem().locate(id);
  return rssOfMeasurement(*pool, i);
}

double Estimator::rssOfMeasurement(MeasurementPool& pool, int i) const {
  const double s = squaredResidual(problem(), pool, i);
  const Loss* loss = pool.lossOf(i);
  return loss == nullptr || !std::isfinite(s) ? s : loss->evaluate(s).rho;
}

double Estimator::weight(const MeasurementHandle& id) const {
  const auto [pool, i] = problem().locate(id);
  const Loss* loss = pool->lossOf(i);
  return loss == nullptr ? 1 : loss->evaluate(squaredResidual(problem(), *pool, i)).first;
}

double Estimator::getRMS() const {
  const int residuals = getM();
  return residuals > 0 ? std::sqrt(getRSS() / residuals) : 0;
}

int Estimator::getM() const { return state_->evaluator.structure().residuals; }
int Estimator::getN() const { return problem().freeCount(); }

void Estimator::writeResidual(MeasurementPool& pool, int i, bool whitened, double* r) const {
  problem().naming(pool, [&] {
    if (whitened) {
      pool.evaluate(i, i + 1, r);
    } else {
      pool.evaluateRaw(i, r);
    }
  });
}

void Estimator::writeResiduals(double* r) const { state_->linearizer.residuals(problem(), r); }

Eigen::MatrixXd Estimator::State::covariance(int variable_a, int variable_b) {
  const double factor = varianceFactor();
  return factor * analyze([&](const LinearizedProblem& linearized) {
           return covarianceBlock(linearized, gauge, variable_a, variable_b);
         });
}

void Estimator::writeCovariance(int variable_a, int variable_b, double* block) const {
  const Eigen::MatrixXd result = state_->covariance(variable_a, variable_b);
  std::copy(result.data(), result.data() + result.size(), block);
}

void Estimator::writeJointCovariance(const int* variables, int count, double* out) const {
  const double factor = state_->varianceFactor();
  const Eigen::MatrixXd result = factor * state_->analyze([&](const LinearizedProblem& linearized) {
    return slom::jointCovariance(linearized, state_->gauge, {variables, variables + count});
  });
  std::copy(result.data(), result.data() + result.size(), out);
}

void Estimator::writeDeviations(int variable, double* deviations) const {
  const Eigen::VectorXd result = detail::deviations(state_->covariance(variable, variable));
  std::copy(result.data(), result.data() + result.size(), deviations);
}

Marginals Estimator::marginals() const {
  const double factor = state_->varianceFactor();
  return state_->analyze(
      [&](const LinearizedProblem& linearized) { return makeMarginals(linearized, state_->gauge, factor); });
}

/// Writes the whitened Jacobian, residuals x unknowns, column-major.
void Estimator::writeJacobian(double* J) const {
  const Eigen::MatrixXd all = state_->analyze([](const LinearizedProblem& linearized) {
    const Eigen::Index n = linearized.structure().system.unknowns();
    return linearized.times(Eigen::MatrixXd::Identity(n, n));
  });
  std::copy_n(all.data(), all.size(), J);
}

void Estimator::setFreeGauge(FreeGauge gauge) { state_->gauge = gauge; }

FreeGauge Estimator::freeGauge() const { return state_->gauge; }

void Estimator::setSigma(Sigma sigma) { state_->sigma = sigma; }

Sigma Estimator::sigma() const { return state_->sigma; }

int Estimator::State::redundancy() {
  // With FreeGauge::error there are no covariances if directions are free.
  const bool may_be_free = gauge == FreeGauge::inner_constraints;
  return analyze([&](const LinearizedProblem& linearized) {
    return linearized.structure().residuals - linearized.freeUnknowns() +
           (may_be_free ? linearized.freeDirections() : 0);
  });
}

double Estimator::State::varianceFactor() {
  if (sigma == Sigma::known) return 1;
  const int dof = redundancy();
  if (dof > 0) return linearized().rss() / dof;
  const int residuals = evaluator.structure().residuals,
            unknowns = analyze([](const LinearizedProblem& linearized) { return linearized.freeUnknowns(); }),
            free = dof - residuals + unknowns;
  throw Error("slom.no-redundancy",
              "Sigma::estimated needs more residuals than unknowns, but there are " +
                  std::to_string(residuals) + " residuals and " + std::to_string(unknowns) + " unknowns" +
                  (free > 0 ? ", " + counted(free, "direction") + " of them free" : "") +
                  "; add measurements or use Sigma::known");
}

bool Estimator::State::isAtMinimum(double variance_factor) {
  if (analyze([](const LinearizedProblem& linearized) { return linearized.orthogonality(); }) < kAtMinimum)
    return true;
  return run([&] {
    evaluator.linearize();
    const Evaluator::Promise promise =
        evaluator.promise();  // residuals that are rounding errors may have any direction
    const double near = std::max(kAtMinimum, problem.largestStatedStep());
    return promise.is_known && promise.decrease <= near * near * variance_factor;
  });
}

void Estimator::addParametersTo(Summary& summary) const {
  const double factor = state_->varianceFactor();
  state_->analyze([&](const LinearizedProblem& linearized) {
    addParameters(linearized, state_->gauge, factor, summary);
  });
}

void Estimator::bound(int variable, const std::string& path, double lower, double upper) {
  std::vector<int> components(at(dofOf(variable)));
  std::iota(components.begin(), components.end(), 0);
  if (!path.empty()) components = problem().componentsAt(variable, path);
  problem().setBound(variable, components, lower, upper);
}

void Estimator::setFixed(int variable, int first, int count, bool is_fixed) {
  std::vector<int> components(static_cast<std::size_t>(count));
  std::iota(components.begin(), components.end(), first);
  problem().setFixed(variable, components, is_fixed);
}

void Estimator::raiseNoMember(int variable) const {
  throw Error("slom.no-component",
              "the member passed with variable " + problem().variableName(variable) +
                  " is not one of its manifold's parts; pass one that [+] moves",
              problem().variableName(variable));
}

std::vector<std::string> Estimator::warnings() const { return unmeasuredVariables(problem()); }

}  // namespace slom
