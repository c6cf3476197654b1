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
#include "linearize/marginal_information.hpp"
#include "slom/analyze/losses.hpp"
#include "slom/measurements/gaussian_prior.hpp"
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
  bool isAtMinimum(double variance_factor);
  // What a summary says besides what the fit itself knows.
  void fillSizes(Summary& summary);
  void countFreeDirections(Summary& summary, const Options& options);
  void fillTables(Summary& summary, const Options& options);
  void addWarnings(Summary& summary, const Options& options);
  std::string messageFor(const Summary& summary, const SolveStatus& status, double max_seconds);
};

namespace {
/// What is wrong, but for what other warnings say.
std::vector<std::string> faultsOf(const Diagnosis& diagnosis) {
  std::vector<std::string> texts;
  for (const Finding& finding : diagnosis.findings) {
    if (finding.is_fault && finding.kind != Finding::Kind::unmeasured_variable) texts.push_back(finding.text);
  }
  return texts;
}

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
                      "nearer to the solution, or use LevenbergMarquardt",
                  state_->algorithm->name());
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
  summary.groups = std::move(before.groups);
  state_->fillSizes(summary);
  summary.message = state_->messageFor(summary, singular_at, options.max_seconds);
  state_->countFreeDirections(summary, options);
  state_->fillTables(summary, options);
  state_->addWarnings(summary, options);
  return summary;
}

void Estimator::State::fillSizes(Summary& summary) {
  run([&] { fillGroups(problem, linearizer, summary, false); });
  const ProblemStructure& structure = system.structure();
  summary.solver = system.solver().description();
  summary.variables = structure.system.filledCount();
  summary.measurements = structure.residuals;
  summary.unknowns = structure.system.unknowns() - problem.activeSet().heldCount();
  summary.redundancy = summary.measurements - summary.unknowns;
  summary.sigma_is_estimated = sigma == Sigma::estimated;
}

/// Whether a fit may take more time for what is said of it.
static bool hasTime(const Summary& summary, const Options& options) {
  return summary.seconds < options.max_seconds / 2 && !(options.should_stop && options.should_stop());
}

void Estimator::State::countFreeDirections(Summary& summary, const Options& options) {
  if (summary.unknowns == 0 || summary.unknowns > Summary::kMostCounted || system.hadFullRank() ||
      !hasTime(summary, options))
    return;
  try {
    summary.free_directions =
        analyze([](const LinearizedProblem& linearized) { return linearized.freeDirections(); });
    summary.redundancy += summary.free_directions;
  } catch (const Error&) {  // there are no derivatives
  }
}

void Estimator::State::fillTables(Summary& summary, const Options& options) {
  summary.active_bounds = activeBounds(problem);
  if (summary.unknowns == 0 || summary.unknowns > options.most_parameters ||
      summary.stop_reason == StopReason::rank_deficient)
    return;
  try {
    const double factor = varianceFactor();
    analyze([&](const LinearizedProblem& linearized) { fillParameters(linearized, gauge, factor, summary); });
  } catch (const Error&) {  // there are no covariances
  }
}

void Estimator::State::addWarnings(Summary& summary, const Options& options) {
  const auto append = [&](std::vector<std::string> texts) {
    for (std::string& text : texts) summary.warnings.push_back(std::move(text));
  };
  if (summary.stop_reason == StopReason::rank_deficient) {
    std::vector<std::string> weightless = weightlessMeasurements(summary.groups);
    const bool is_explained = !weightless.empty();
    append(std::move(weightless));
    if (!is_explained && hasTime(summary, options))
      append(analyze([](const LinearizedProblem& linearized) { return faultsOf(linearized.diagnosis()); }));
  }
  append(unmeasuredVariables(problem));
  append(misfits(problem, summary));
  given_derivatives.check(problem, summary.warnings);
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

std::vector<MeasID<GaussianPrior>> Estimator::marginalize(const std::vector<AnyVarID>& ids) {
  Problem& all = problem();
  std::vector<int> variables;
  for (const AnyVarID& id : ids) variables.push_back(all.indexOf(static_cast<const VariableHandle&>(id)));
  std::sort(variables.begin(), variables.end());
  variables.erase(std::unique(variables.begin(), variables.end()), variables.end());
  const std::vector<MeasurementIndex> measurements = measurementsOf(all, variables);
  const std::vector<InformationFactor> factors =
      state_->run([&] { return marginalInformation(all, state_->linearizer, measurements, variables); });

  std::vector<MeasID<GaussianPrior>> priors;
  priors.reserve(factors.size());
  try {
    for (const InformationFactor& factor : factors) {
      std::vector<AnyVarID> left;
      for (const int v : factor.variables) left.emplace_back(all.handleOf(v));
      priors.push_back(insertMeasurement(GaussianPrior(std::move(left), factor.R, factor.b)));
    }
  } catch (...) {  // memory is short
    for (const MeasID<GaussianPrior>& id : priors) removeMeasurement(id);
    throw;
  }
  // From the last one on, as the last one of a pool takes the place of one that is removed.
  for (auto m = measurements.rbegin(); m != measurements.rend(); ++m) {
    all.removeMeasurement(*all.pools()[static_cast<std::size_t>(m->first)], m->second);
  }
  for (const int v : variables) all.removeVariable(v);
  return priors;
}

void Estimator::changeAlgorithm(Algorithm* algorithm) {
  if (algorithm == nullptr) {
    throw Error("slom.no-algorithm",
                "changeAlgorithm got a null pointer; pass a new GaussNewton, LevenbergMarquardt or "
                "DogLeg",
                "changeAlgorithm");
  }
  std::unique_ptr<Algorithm> owned(algorithm);  // also where there is no state
  state_->algorithm = std::move(owned);
}

void Estimator::changeSolver(std::unique_ptr<LinearSolver> solver) {
  if (!solver)
    throw Error("slom.no-solver", "changeSolver got a null pointer; pass a BlockSolver, BlockQR or DenseQR",
                "changeSolver");
  state_->current.reset();
  state_->system.setSolver(*solver);
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

void Estimator::writeJointCovariance(const int* variables, int count, double* out) const {
  const double factor = state_->varianceFactor();
  const Eigen::MatrixXd result = factor * state_->analyze([&](const LinearizedProblem& linearized) {
    return slom::jointCovariance(linearized, state_->gauge, {variables, variables + count});
  });
  std::copy(result.data(), result.data() + result.size(), out);
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
  // With FreeGauge::error there are no covariances where directions are free.
  const bool may_be_free = gauge == FreeGauge::inner_constraints;
  const int unknowns = analyze([](const LinearizedProblem& linearized) { return linearized.freeUnknowns(); });
  const int free =
      may_be_free ? analyze([](const LinearizedProblem& linearized) { return linearized.freeDirections(); })
                  : 0;
  const int residuals = system.structure().residuals, redundancy = residuals - unknowns + free;
  if (redundancy > 0) return linearized().rss() / redundancy;
  throw Error("slom.no-redundancy",
              "uncertainties can be estimated from residuals only when there are more of them than "
              "unknowns; here are " +
                  std::to_string(residuals) + " residuals and " + std::to_string(unknowns) + " unknowns" +
                  (free > 0 ? ", " + counted(free, "direction") + " of them free" : "") +
                  "; add measurements or use Sigma::known");
}

bool Estimator::State::isAtMinimum(double variance_factor) {
  return run([&] {
    system.linearize();
    if (system.orthogonality() < kAtMinimum) return true;
    const System::Promise promise =
        system.promise();  // residuals that are rounding errors have any direction
    return promise.is_known && promise.decrease <= kAtMinimum * kAtMinimum * variance_factor;
  });
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
  ProfiledFit fit;
  fit.variance_factor = [this] { return state_->varianceFactor(); };
  fit.is_at_minimum = [this](double variance_factor) { return state_->isAtMinimum(variance_factor); };
  fit.rss = [this] { return getRSS(); };
  fit.covariance = [this, variable](double* C) { writeCovariance(variable, variable, C); };
  fit.refit = [this] { return optimize().final_rss; };
  return profileLikelihood(problem(), fit, variable, path, probability);
}

void Estimator::bound(int variable, const std::string& path, double lower, double upper) {
  problem().setBound(variable, problem().componentsAt(variable, path), lower, upper);
}

void Estimator::raiseNoMember(int variable) const {
  throw Error("slom.no-component",
              "the member passed with variable " + problem().variableName(variable) +
                  " is not one of its manifold's parts; pass one that [+] moves",
              problem().variableName(variable));
}

DerivativeCheck Estimator::checkDerivatives() const { return compareDerivatives(problem()); }

std::vector<std::string> Estimator::warnings() const { return unmeasuredVariables(problem()); }

}  // namespace slom
