/// State of an estimator: the problem, its linearisation, the solver, the algorithm and the user's settings.
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
  int threads = 0;                             ///< as passed to setThreads
  std::shared_ptr<LinearizedProblem> current;  ///< null: none, or outdated
  std::unique_ptr<OnlineFit> online;           ///< null: update() was never called
  Sigma sigma = Sigma::known;
  FreeGauge gauge = FreeGauge::error;
  std::string unconverged;  ///< reason why the last fit did not converge; empty: it converged
  std::uint64_t unconverged_values = 0, unconverged_structure = 0;  ///< revisions where it ended
  GivenDerivatives given_derivatives;

  State() { evaluator.setSolver(*solver); }

  /// Turns `copy`, which is new, into a copy of this state, see Estimator::clone().
  void copyTo(State& copy) const;
  /// Returns f(), run on the number of threads given to setThreads.
  template <class F>
  auto run(const F& f) {
    return arena.run(f);
  }

  /// Returns the problem linearised at the current values, shared by all analyses at these values.
  const LinearizedProblem& linearized() {
    if (!evaluator.collective().isAlone()) raiseNeedsAll();
    if (current == nullptr || !current->isCurrent())
      current = std::make_shared<LinearizedProblem>(problem, evaluator);
    return *current;
  }
  /// Throws [slom.needs-all]: the processes of a fit have a part of the problem each.
  [[noreturn]] static void raiseNeedsAll();
  /// Returns f(linearized()), run on the number of threads given to setThreads.
  template <class F>
  auto analyze(const F& f) {
    return run([&] { return f(linearized()); });
  }

  /// Fits by this algorithm from the current values.
  Summary optimize(Algorithm& by, const Options& options);
  using Fit = std::function<Summary()>;
  /// Returns the free network at the current values; null if no direction is free, or more than the gauge.
  std::unique_ptr<FreeNetwork> freeNetwork();
  /// Returns whether the measurements leave directions free and FreeGauge::inner_constraints chooses the values there.
  bool isFreeNetwork();
  /// Updates `summary` with a later fit that continued from the end of the fit of `summary`.
  static void goOn(Summary& summary, Summary later);
  /// Fits the network by `fit` to the values with the smallest distance from the start.
  Summary fitFreeNetwork(const Fit& fit, std::unique_ptr<FreeNetwork> network);
  /// If the fit ended at its start because directions other than the gauge are free there, returns a step after which
  /// fewer are: along one of them, or downhill. Returns an empty vector if there is none.
  Eigen::VectorXd stepFromSingularStart(const Summary& summary);
  /// Leaves, by Levenberg-Marquardt, a place where an unknown has no effect, and fits again. If that does not converge,
  /// values and `summary` stay. `why` says in the warning what is wrong with the start.
  void fitFromNearer(const Fit& fit, const Fit& by_damping, const char* why, Summary& summary);
  /// Returns why the fit to the current values did not converge; empty if it did, or if there was no fit.
  std::string whyUnconverged() const {
    const bool is_there =
        problem.valueRevision() == unconverged_values && problem.structureRevision() == unconverged_structure;
    return is_there ? unconverged : "";
  }
  /// Returns the RSS at the current values.
  double rss() {
    return run([&] { return linearizer.rss(problem); });
  }
  /// Returns the redundancy for the variance factor: residuals minus the unknowns that they determine.
  int redundancy();
  /// Returns a sentence about the standard deviations in tests of residuals; empty if the stated ones are used.
  std::string noiseOfTests(double variance_factor) const;
  /// Returns the variance factor of covariances: 1, or estimated from the residuals. Throws [slom.no-redundancy].
  double varianceFactor();
  /// Returns the covariance of two variables, as Estimator::covariance.
  Eigen::MatrixXd covariance(int variable_a, int variable_b);
  /// Returns whether the current values count as a minimum, for statements that hold only there.
  bool isAtMinimum(double variance_factor);
  /// Returns the movement of the values in fits without each group of the first way. Restores the values.
  GroupRefits refitGroups(const ClusterOptions& options);
  /// Returns StepRecord::free_directions.
  int freeDirectionsAfterStep(const StepOutcome& outcome);
  /// Completes the summary that the optimisation filled in.
  void complete(Summary& summary, const Options& options, const RankAtEnd& rank);

 private:
  /// Completes the summary of a fit by several processes.
  void completeTogether(Summary& summary, const Options& options, const RankAtEnd& rank);
  void fillSizes(Summary& summary);
  void countFreeDirections(Summary& summary, const Options& options);
  void fillTables(Summary& summary, const Options& options);
  void addWarnings(Summary& summary, const Options& options);
  void explainRankDeficiency(Summary& summary, const Options& options);
  std::string messageFor(const Summary& summary, const Options& options, const RankAtEnd& rank);
};

}  // namespace slom
