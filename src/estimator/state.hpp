/// What an estimator owns: the problem, its linearisation, the solver, the algorithm and the choices of the user.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <Eigen/Core>

#include "analyze/clustered/group_refits.hpp"
#include "analyze/free_network.hpp"
#include "analyze/given_derivatives.hpp"
#include "analyze/linearized_problem.hpp"
#include "base/threads.hpp"
#include "online/online_fit.hpp"
#include "slom/estimator.hpp"
#include "slom/optimize/optimizer.hpp"
#include "slom/solve/block_solver.hpp"

namespace slom {

struct [[gnu::visibility("hidden")]] Estimator::State {  // declared in a public header, not exported
  Problem problem;
  Linearizer linearizer;
  Evaluator evaluator{problem, linearizer};
  std::unique_ptr<LinearSolver> solver = std::make_unique<BlockSolver>();
  std::unique_ptr<Algorithm> algorithm = std::make_unique<GaussNewton>();
  detail::ThreadArena arena;
  int threads = 0;                             ///< as setThreads got them
  std::shared_ptr<LinearizedProblem> current;  ///< null: none, or out of date
  std::unique_ptr<OnlineFit> online;           ///< null: update() was never called
  Sigma sigma = Sigma::known;
  FreeGauge gauge = FreeGauge::error;
  std::string unconverged;  ///< why the last fit has not converged; empty: it has
  std::uint64_t unconverged_values = 0, unconverged_structure = 0;  ///< revisions where it ended
  GivenDerivatives given_derivatives;

  State() { evaluator.setSolver(*solver); }

  /// Makes `copy`, which is new, a copy of this one, as Estimator::clone() says.
  void copyTo(State& copy) const;
  /// f(), on as many threads as setThreads said.
  template <class F>
  auto run(const F& f) {
    return arena.run(f);
  }

  /// The problem linearised at the current values, for all analyses there together.
  const LinearizedProblem& linearized() {
    if (current == nullptr || !current->isCurrent())
      current = std::make_shared<LinearizedProblem>(problem, evaluator);
    return *current;
  }
  /// f(linearized()), on as many threads as setThreads said.
  template <class F>
  auto analyze(const F& f) {
    return run([&] { return f(linearized()); });
  }

  /// A fit by this algorithm from the current values.
  Summary optimize(Algorithm& by, const Options& options);
  using Fit = std::function<Summary()>;
  /// The free network at the current values; null: no direction is free, or more than the gauge.
  std::unique_ptr<FreeNetwork> freeNetwork();
  /// Returns whether the measurements leave directions free and FreeGauge::inner_constraints chooses the values there.
  bool isFreeNetwork();
  /// Takes over the end of a later fit, which went on where the one of `summary` has ended.
  static void goOn(Summary& summary, Summary later);
  /// Fits it by `fit` to the values with the smallest distance from the start.
  Summary fitFreeNetwork(const Fit& fit, std::unique_ptr<FreeNetwork> network);
  /// Whether the fit ended at its start because that leaves directions free that are no gauge, and that are fewer after a step along one.
  bool isSingularStart(const Summary& summary);
  /// After a fit that ended where an unknown has no effect: leaves that place by Levenberg-Marquardt and fits again. Values and `summary`
  /// stay if that does not converge. `why`: what is wrong with the start, for a warning.
  void fitFromNearer(const Fit& fit, const Fit& by_damping, const char* why, Summary& summary);
  /// Why the fit that has led to the current values has not converged; empty: it has, or there was none.
  std::string whyUnconverged() const {
    const bool is_there =
        problem.valueRevision() == unconverged_values && problem.structureRevision() == unconverged_structure;
    return is_there ? unconverged : "";
  }
  double rss() {
    return run([&] { return linearizer.rss(problem); });
  }
  /// Residuals less what the unknowns take of them, for the variance factor.
  int redundancy();
  /// Which standard deviations tests of residuals use, in a sentence; empty: those that are stated.
  std::string noiseOfTests(double variance_factor) const;
  /// The variance factor that covariances are multiplied by: 1, or estimated from the residuals. Throws [slom.no-redundancy].
  double varianceFactor();
  /// That of two variables, as Estimator::covariance.
  Eigen::MatrixXd covariance(int variable_a, int variable_b);
  /// Whether the current values count as a minimum, for statements that hold at one alone.
  bool isAtMinimum(double variance_factor);
  /// How far values move without each group of the first way; they come back.
  GroupRefits refitGroups(const ClusterOptions& options);
  /// StepRecord::free_directions.
  int freeDirectionsAfterStep(const StepOutcome& outcome);
  /// Completes what the optimisation has filled.
  void complete(Summary& summary, const Options& options, const RankAtEnd& rank);

 private:
  void fillSizes(Summary& summary);
  void countFreeDirections(Summary& summary, const Options& options);
  void fillTables(Summary& summary, const Options& options);
  void addWarnings(Summary& summary, const Options& options);
  void explainRankDeficiency(Summary& summary, const Options& options);
  std::string messageFor(const Summary& summary, const Options& options, const RankAtEnd& rank);
};

}  // namespace slom
