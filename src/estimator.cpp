#include "slom/estimator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analyze/covariance.hpp"
#include "analyze/diagnose.hpp"
#include "analyze/fit_tables.hpp"
#include "analyze/given_derivatives.hpp"
#include "analyze/linearized_problem.hpp"
#include "analyze/misfit.hpp"
#include "analyze/preflight.hpp"
#include "analyze/profile.hpp"
#include "analyze/residual_tests.hpp"
#include "analyze/singular.hpp"
#include "base/threads.hpp"
#include "base/words.hpp"
#include "problem/value_snapshot.hpp"
#include "slom/analyze/chi_square.hpp"
#include "slom/analyze/losses.hpp"
#include "slom/optimize/optimizer.hpp"
#include "slom/solve/block_solver.hpp"

namespace slom {

struct Estimator::State {
  Problem problem;
  Linearizer linearizer;
  System system{problem, linearizer};
  std::unique_ptr<LinearSolver> solver = std::make_unique<BlockSolver>();
  std::unique_ptr<Algorithm> algorithm = std::make_unique<GaussNewton>();
  detail::ThreadArena arena;
  std::unique_ptr<LinearizedProblem> current;  // null: none, or out of date

  /// f(), on as many threads as setThreads said.
  template <class F>
  auto run(const F& f) {
    return arena.run(f);
  }

  State() { system.setSolver(*solver); }

  /// The problem linearised at the current values, for all analyses there together.
  const LinearizedProblem& linearized() {
    if (current == nullptr || !current->isCurrent())
      current = std::make_unique<LinearizedProblem>(problem, system);
    return *current;
  }
  /// f(linearized()), on as many threads as setThreads said.
  template <class F>
  auto analyze(const F& f) {
    return run([&] { return f(linearized()); });
  }

  Sigma sigma = Sigma::known;
  FreeGauge gauge = FreeGauge::error;
  GivenDerivatives given_derivatives;
  double varianceFactor();
  std::string messageFor(const Summary& summary, const SolveStatus& status, double max_seconds);
};

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

double Estimator::optimizeStep() {
  state_->current.reset();
  const StepOutcome outcome = state_->run([&] { return state_->algorithm->step(state_->system, Options{}); });
  switch (outcome.kind) {
    case StepOutcome::Kind::singular:
      throw singularError(problem(), state_->system.structure(), outcome.status);
    case StepOutcome::Kind::not_finite:
      throw Error("slom.not-finite",
                  "the step of " + state_->algorithm->name() +
                      " led to values at which a residual is not finite, and was taken back; start "
                      "nearer to the solution, or use LevenbergMarquardt");
    default:
      break;
  }
  return outcome.rss_before > 0 ? (outcome.rss_before - outcome.rss_after) / outcome.rss_before : 0.0;
}

Summary Estimator::optimize(const Options& options) {
  state_->algorithm->reset();
  state_->current.reset();
  Summary before;
  state_->run([&] { fillGroups(problem(), state_->linearizer, before, true); });
  SolveStatus singular_at;
  Summary summary = state_->run([&] {
    return runAlgorithm(state_->system, *state_->algorithm, options, state_->sigma == Sigma::estimated,
                        singular_at);
  });
  const ProblemStructure& structure = state_->system.structure();
  summary.groups = std::move(before.groups);
  state_->run([&] { fillGroups(problem(), state_->linearizer, summary, false); });
  summary.solver = state_->system.solver().description();
  summary.variables = structure.system.blockCount();
  summary.measurements = structure.residuals;
  summary.unknowns = structure.system.unknowns() - problem().activeSet().heldCount();
  summary.redundancy = summary.measurements - summary.unknowns;
  summary.sigma_is_estimated = state_->sigma == Sigma::estimated;
  summary.message = state_->messageFor(summary, singular_at, options.max_seconds);
  summary.active_bounds = activeBounds(problem());
  if (summary.unknowns > 0 && summary.unknowns <= options.most_parameters &&
      summary.stop_reason != StopReason::rank_deficient) {
    try {
      const double factor = state_->varianceFactor();
      state_->analyze([&](const LinearizedProblem& linearized) {
        fillParameters(linearized, state_->gauge, factor, summary);
      });
    } catch (const Error&) {  // there are no covariances
    }
  }
  if (summary.stop_reason == StopReason::rank_deficient) {
    std::vector<std::string> weightless = weightlessMeasurements(summary.groups);
    const bool is_explained = !weightless.empty();
    for (std::string& text : weightless) summary.warnings.push_back(std::move(text));
    const bool has_time =
        summary.seconds < options.max_seconds / 2 && !(options.should_stop && options.should_stop());
    for (Finding& finding : is_explained || !has_time ? std::vector<Finding>() : diagnose().findings) {
      if (finding.is_fault && finding.kind != Finding::Kind::unmeasured_variable)
        summary.warnings.push_back(std::move(finding.text));
    }
  }
  for (std::string& text : unmeasuredVariables(problem())) summary.warnings.push_back(std::move(text));
  for (std::string& text : misfits(problem(), summary)) summary.warnings.push_back(std::move(text));
  state_->given_derivatives.check(problem(), summary.warnings);
  return summary;
}

std::string Estimator::State::messageFor(const Summary& summary, const SolveStatus& status,
                                         double max_seconds) {
  if (summary.stop_reason == StopReason::rank_deficient) {
    return singularError(problem, system.structure(), status).what();
  }
  if (summary.stop_reason == StopReason::max_iterations) {
    const double graduation = summary.trace.back().graduation;
    return "iteration limit of " + std::to_string(summary.iterations) + " reached" +
           (graduation > 1 ? " while the losses were still widened, mu = " + number(graduation, 6) +
                                 "; raise max_iterations"
                           : "");
  }
  if (summary.stop_reason == StopReason::no_progress) {
    const System::Promise promise = run([&] { return system.promise(false); });
    return std::string(toString(summary.stop_reason)) +
           (promise.is_known
                ? ", though the linear model promises a decrease by " + number(promise.decrease, 3)
                : "") +
           ": derivatives may be wrong (checkDerivatives() compares them with differences), residuals may jump, or values and residuals "
           "may be too large for what they have to resolve";
  }
  if (summary.stop_reason == StopReason::time_limit)
    return "time limit of " + number(max_seconds, 6) + " s reached";
  return toString(summary.stop_reason);
}

void Estimator::changeAlgorithm(Algorithm* algorithm) {
  if (algorithm == nullptr) {
    throw Error("slom.no-algorithm",
                "changeAlgorithm got a null pointer; pass a new GaussNewton, LevenbergMarquardt or "
                "DogLeg");
  }
  std::unique_ptr<Algorithm> owned(algorithm);  // also where there is no state
  state_->algorithm = std::move(owned);
}

void Estimator::changeSolver(std::unique_ptr<LinearSolver> solver) {
  if (!solver)
    throw Error("slom.no-solver", "changeSolver got a null pointer; pass a BlockSolver, BlockQR or DenseQR");
  state_->current.reset();
  state_->system.setSolver(*solver);
  state_->solver = std::move(solver);
}

void Estimator::setThreads(int threads) {
  if (threads < 0) {
    throw Error("slom.bad-option", "the number of threads is " + std::to_string(threads) +
                                       "; pass a positive number, or 0 for as many as the machine has");
  }
  state_->arena.setThreads(threads);
}

double Estimator::getRSS() const {
  return state_->run([&] { return state_->linearizer.rss(problem()); });
}

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

double Estimator::rssOfMeasurement(MeasurementPool& pool, int i) const {
  const double s = squaredResidual(problem(), pool, i);
  const Loss* loss = pool.lossOf(i);
  return loss == nullptr || !std::isfinite(s) ? s : loss->evaluate(s).rho;
}

double Estimator::weightOf(MeasurementPool& pool, int i) const {
  const Loss* loss = pool.lossOf(i);
  return loss == nullptr ? 1 : loss->evaluate(squaredResidual(problem(), pool, i)).first;
}

double Estimator::getRMS() const {
  const int residuals = getM();
  return residuals > 0 ? std::sqrt(getRSS() / residuals) : 0;
}

int Estimator::getM() const { return state_->system.structure().residuals; }
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

void Estimator::writeCovariance(int variable_a, int variable_b, double* block) const {
  const double factor = state_->varianceFactor();
  const Eigen::MatrixXd result = factor * state_->analyze([&](const LinearizedProblem& linearized) {
    return covarianceBlock(linearized, state_->gauge, variable_a, variable_b);
  });
  std::copy(result.data(), result.data() + result.size(), block);
}

void Estimator::writeDeviations(int variable, double* deviations) const {
  const int dof = problem().variables()[static_cast<std::size_t>(variable)].dof;
  Eigen::MatrixXd C(dof, dof);
  writeCovariance(variable, variable, C.data());
  Eigen::Map<Eigen::VectorXd>(deviations, dof) = detail::deviations(C);
}

Marginals Estimator::marginals() const {
  const double factor = state_->varianceFactor();
  return state_->analyze(
      [&](const LinearizedProblem& linearized) { return makeMarginals(linearized, state_->gauge, factor); });
}

/// Whitened, residuals x unknowns, column-major.
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

double Estimator::State::varianceFactor() {
  if (sigma == Sigma::known) return 1;
  const int unknowns = analyze([](const LinearizedProblem& linearized) { return linearized.freeUnknowns(); });
  const int residuals = system.structure().residuals;
  if (residuals > unknowns) return linearized().rss() / (residuals - unknowns);
  throw Error("slom.no-redundancy",
              "uncertainties can be estimated from residuals only when there are more of them than "
              "unknowns; here are " +
                  std::to_string(residuals) + " residuals and " + std::to_string(unknowns) +
                  " unknowns; add measurements or use Sigma::known");
}

Diagnosis Estimator::diagnose() const {
  return state_->analyze([](const LinearizedProblem& linearized) { return linearized.diagnosis(); });
}

OutlierReport Estimator::outliers(const OutlierOptions& options) const {
  const double factor = state_->varianceFactor();
  return state_->analyze([&](const LinearizedProblem& linearized) {
    return checkResiduals(linearized, options, factor, state_->gauge);
  });
}

Preflight Estimator::preflight() const {
  return state_->analyze([](const LinearizedProblem& linearized) { return slom::preflight(linearized); });
}

ProfileInterval Estimator::profile(int variable, const std::string& path, double probability) {
  if (!(probability > 0 && probability < 1)) {
    throw Error("slom.bad-option", "the probability of a profile interval is " + number(probability, 6) +
                                       "; pass one between 0 and 1, such as 0.95");
  }
  const std::vector<int> components = problem().componentsAt(variable, path);
  const VariableRecord& record = problem().variables()[static_cast<std::size_t>(variable)];
  const int c = components.front();
  const std::string name = problem().componentNames(variable)[static_cast<std::size_t>(c)];
  Eigen::VectorXd x(record.dof);
  record.store->coordinates(record.store->valueAt(record.slot), x.data());
  if (components.size() > 1 || std::isnan(x[c])) {
    throw Error("slom.no-component",
                path + " of variable " + problem().variableName(variable) +
                    " is not one coordinate; profile takes one component of a vector at a time");
  }
  const double factor = state_->varianceFactor();
  state_->run([&] { return state_->system.linearize(); });
  const bool is_there = state_->system.orthogonality() < kAtMinimum || state_->run([&] {
    const System::Promise promise =
        state_->system.promise();  // residuals that are rounding errors have any direction
    return promise.is_known && promise.decrease <= kAtMinimum * kAtMinimum * factor;
  });
  if (!is_there) {
    throw Error("slom.not-a-minimum",
                "the profile of " + name + " starts at a fit, and the values are not at one; optimize first");
  }
  ProfileInterval result{x[c], x[c], x[c]};
  const ActiveSet& active = problem().activeSet();
  if (!active.isOptimized(variable) || active.isFixed(variable, c)) return result;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const ComponentBound* const found = active.boundOf(variable, c);
  const ComponentBound bound = found == nullptr ? ComponentBound{c, -infinity, infinity} : *found;
  const double best = getRSS(), rise = factor * chiSquareCritical(1 - probability, 1);
  ValueSnapshot start(problem());
  const auto restore = [&] {
    problem().setFixed(variable, components, false);
    start.restore();
    problem().setBound(variable, components, bound.lower, bound.upper);
  };
  try {
    if (found != nullptr)
      problem().setBound(variable, components, -infinity,
                         infinity);  // its own covariance, though it is at the bound
    Eigen::MatrixXd C(record.dof, record.dof);
    writeCovariance(variable, variable, C.data());
    problem().setFixed(variable, components, true);
    const auto ascend = [&](double sign, double most) {
      if (!(most > 0)) return 0.0;
      start.restore();
      double at = 0;
      return profileRoot(
          [&](double t) {
            Eigen::VectorXd d = Eigen::VectorXd::Zero(record.dof);
            d[c] = sign * (t - at);
            record.store->boxplus(record.store->valueAt(record.slot), d.data());
            problem().overwrite(variable, record.store->valueAt(record.slot));
            at = t;
            return (optimize().final_rss - best) / rise - 1;
          },
          std::sqrt(rise / factor * C(c, c)), most);
    };
    const double above = ascend(1, bound.upper - x[c]), below = ascend(-1, x[c] - bound.lower);
    result.upper = above < bound.upper - x[c] ? x[c] + above : std::max(bound.upper, x[c]);
    result.lower = below < x[c] - bound.lower ? x[c] - below : std::min(bound.lower, x[c]);
  } catch (...) {
    restore();
    throw;
  }
  restore();
  return result;
}

void Estimator::bound(int variable, const std::string& path, double lower, double upper) {
  problem().setBound(variable, problem().componentsAt(variable, path), lower, upper);
}

void Estimator::raiseNoMember(int variable) const {
  throw Error("slom.no-component", "the member passed with variable " + problem().variableName(variable) +
                                       " is not one of its manifold's parts; pass one that [+] moves");
}

DerivativeCheck Estimator::checkDerivatives() const { return compareDerivatives(problem()); }

std::vector<std::string> Estimator::warnings() const { return unmeasuredVariables(problem()); }

}  // namespace slom
