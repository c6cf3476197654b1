/// Evaluator: the problem for an algorithm. It holds a point and its linearisation, and tries and undoes steps.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "slom/base/collective.hpp"
#include "slom/linearize/linearize.hpp"
#include "slom/optimize/summary.hpp"
#include "slom/solve/linear_solver.hpp"

namespace slom {

class Evaluator {
 public:
  /// Evaluates a problem, which must outlive the evaluator.
  Evaluator(Problem& problem, Linearizer& linearizer) : problem_(problem), linearizer_(linearizer) {}
  ~Evaluator();

  /// Sets the solver, which is not owned.
  void setSolver(LinearSolver& solver);

  /// Returns the processes that evaluate parts of the problem together (LinearSolver::collective).
  const Collective& collective() const { return *collective_; }
  /// Returns the number of unknowns of all processes.
  int unknowns();
  /// Returns the number of scalar residuals of all processes.
  int residuals();
  /// Returns the number of components of all processes that are fixed or at an active bound.
  int fixedOrActiveCount();
  /// Returns whether any derivatives of any process are differences.
  bool hasNumericDerivatives() const { return collective_->any(problem_.hasNumericDerivatives()); }

  /// Returns whether measurements of any process are linearised at first estimates.
  bool hasFirstEstimates() const { return collective_->any(!problem_.firstEstimates().isEmpty()); }
  /// Returns a^T b for vectors with an entry for each unknown.
  double dot(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const { return collective_->dot(a, b); }
  /// Returns |a|^2 of such a vector.
  double squaredNorm(const Eigen::VectorXd& a) const {
    return collective_->isAlone() ? a.squaredNorm() : dot(a, a);
  }
  /// Returns |a| of such a vector.
  double norm(const Eigen::VectorXd& a) const { return std::sqrt(squaredNorm(a)); }

  /// Returns the present structure of the problem.
  const ProblemStructure& structure();
  /// Returns the solver, analysed for the structure, for others to fill. Its content is lost.
  LinearSolver& lendSolver();
  /// Returns whether the solver, analysed for the structure, is exact (LinearSolver::isExact). Its content stays.
  bool isSolverExact();
  /// Returns a number that changes whenever the solver gets other numbers.
  std::uint64_t contentOfSolver() const { return content_of_solver_; }
  /// Linearises at the current values unless that has been done, and returns the RSS.
  double linearize();
  /// Returns the solver that was set. If it found no full rank and its careful solver did, returns the careful solver
  /// until the structure changes.
  LinearSolver& solver() { return *solver_; }
  const LinearSolver& solver() const { return *solver_; }

  /// Moves all values by `d` and returns the RSS there; NaN if a residual is not finite. If a user's function throws,
  /// the values stay unchanged.
  double tryStep(const Eigen::VectorXd& d);
  /// Does the same for a step that will probably be accepted: linearises there at once if derivatives cost little.
  double tryLikelyStep(const Eigen::VectorXd& d);
  /// Returns whether the last step led closer to the solution, judged without the RSS. Linearises there and compares
  /// the decrease predicted for the solver's step with this damping to `promised`, the predictedDecrease before the
  /// step. Returns false if the predicted decrease is not smaller, or if a derivative is not finite.
  bool cameCloser(const Eigen::VectorXd& damping, double promised);
  /// Linearises at the values after the last tried step. Returns false if a derivative or the RSS is not finite there.
  /// An algorithm may accept a step only if this returns true.
  bool hasFiniteDerivatives();
  /// Returns `d`, shortened in each component that would go beyond a bound.
  Eigen::VectorXd withinBounds(const Eigen::VectorXd& d) const;
  /// Undoes the last tried step; the linearisation before it is valid again.
  void undo();

  /// Returns the RSS at the current values, without derivatives; NaN if a residual is not finite.
  double rss();

  /// Scales the parameter c of every loss by sqrt(mu), for graduated non-convexity. mu = 1 restores the given losses.
  void setLossGraduation(double mu);
  /// Returns the graduation parameter mu of the losses; 1: the given losses.
  double lossGraduation() const { return linearizer_.lossGraduation(); }
  /// Returns max |W r|^2 / c^2 over the measurements with a loss of scale c, at the current values; -1 if there are
  /// none.
  double largestLossArgument();

  /// Returns max_i |g_i| / (|J_i| |r|) of the linearisation, with r and J reweighted by losses; 0 for a perfect fit.
  double orthogonality() const;
  /// Returns the orthogonality for g = J^T r, the diagonal of J^T J and |r|^2.
  static double orthogonality(const Eigen::VectorXd& gradient, const Eigen::VectorXd& diagonal,
                              double squared_norm);
  /// Returns max_i g_i^2 / H_ii: the predicted decrease for the best step of a single unknown. It is a lower bound of
  /// the predicted decrease for all unknowns.
  double promiseOfOneUnknown() const;
  /// Returns max_i |d_i| |J_i|.
  double stepInDeviations(const Eigen::VectorXd& d) const;
  /// Returns whether |d_i| <= tolerance (|x_i| + 1 / |J_i|) for all i, at the current values.
  bool isNegligible(const Eigen::VectorXd& d, double tolerance);
  /// The step and the decrease that the linear model predicts without damping. If the solver finds no unique solution,
  /// the least damping that makes the solution unique is added. A direction in which no residual changes then
  /// contributes nothing.
  struct Promise {
    bool is_known = false;
    bool has_full_rank = false;
    double decrease = 0;  ///< predicted decrease of the RSS: g^T H^-1 g
    Eigen::VectorXd step;
  };
  /// Returns the promise at the current values. With `carefully`, the careful solver is tried too if the other finds no
  /// full rank. It factorises J itself, which may take longer than the fit, to find decreases that J^T J does not show.
  /// It is tried only if the decrease from J^T J is at most `most`.
  Promise promise(bool carefully = true, double most = std::numeric_limits<double>::infinity());
  /// Takes the step of a promise if the RSS falls by at least a quarter of the predicted decrease. Returns whether it
  /// did.
  bool advance(const Promise& promise);
  /// Returns the unknowns on which no residual depends at the current values. Their columns of J are so short that
  /// moving an unknown by its own size changes no residual beyond rounding. Moves by 1 / |J_i| do not change the
  /// residuals as the column predicts, either. Linearise first.
  std::vector<int> unseenAtRest();
  /// Returns |x_i| of every unknown (1 for angles).
  Eigen::VectorXd typicalSizes();
  /// Returns a fraction of the length of a column of J. Parts above it are more than errors of the derivatives and
  /// rounding in long chains of unknowns.
  static double digitsOfDerivatives(const Problem& problem);
  static constexpr double kExactDigits = 1e-10, kNumericDigits = 1e-8;
  /// Returns the squared change of the residuals by rounding of the values. A smaller predicted decrease cannot be
  /// achieved.
  double roundingOfPromises();

  /// Returns whether the last undamped solution was unique, for the present structure. False if there was none or if
  /// the solver is not exact.
  bool hadFullRank() const { return full_rank_at_ == structured_at_ && solver_->isExact(); }

  /// Sets the function that mustStop() calls; none: never stop.
  void setInterruption(std::function<bool()> must_stop) { must_stop_ = std::move(must_stop); }
  /// Returns whether the fit must end. An algorithm that tries several steps asks before each. With several
  /// processes, the function itself makes them agree.
  bool mustStop() const { return must_stop_ && must_stop_(); }

  /// Computes the Gauss-Newton step. Also fails at a hidden unknown, whose column of J is only rounding error, so that
  /// no residual depends on it. The step would move a hidden unknown by more than its typical size, but this move
  /// changes the residuals by less than rounding. Also, its moves do not change the residuals as the column predicts.
  SolveStatus solveUndamped(Eigen::VectorXd& step);
  /// Returns whether the last solveUndamped failed at a hidden unknown, and not because of the rank of J.
  bool wasHidden() const { return was_hidden_; }
  /// Computes the step with this damping, in which hidden unknowns stay unchanged.
  SolveStatus solveDamped(const Eigen::VectorXd& damping, Eigen::VectorXd& step);
  /// Returns the decrease of the RSS that the linear model predicts for the step d: -(2 g d + |J d|^2).
  double predictedDecrease(const Eigen::VectorXd& d) const;
  /// Returns the predicted decrease for a d that the solver found with this damping (one for each unknown, or empty):
  /// -g d + sum damping d^2.
  double predictedDecrease(const Eigen::VectorXd& d, const Eigen::VectorXd& damping) const;

  /// Returns whether a change of the RSS may be rounding error. The rounding error of the residuals is often many times
  /// larger than that of their sum of squares.
  bool mayBeRounding(double change) const;
  static constexpr double kRounding = 1e-14;  ///< relative rounding error of a sum of squares
  static constexpr double kNoise = 1e-13;  ///< rounding error of a difference of two sums, relative to them
  /// Least predicted decrease, relative to the RSS, for which a step is tried.
  static constexpr double kNothing = 1e-30;
  /// Returns whether the predicted decrease of a nearly undamped step is so small that Convergence decides, instead of
  /// shorter steps.
  bool isNearlyNothing(double promised, const Options& options) const {
    return promised <= std::min(std::max(options.decrease_tolerance, kRounding) * rss_,
                                options.deviation_tolerance * options.deviation_tolerance);
  }

  /// Returns the time spent in each phase since construction.
  PhaseSeconds seconds() const;

  /// Returns the evaluated problem.
  Problem& problem() { return problem_; }

 private:
  void move(const Eigen::VectorXd& d);
  SolveStatus solve(const Eigen::VectorXd& damping, Eigen::VectorXd& step);
  std::vector<int> unseenUnknowns(const Eigen::VectorXd& d);
  bool isTrueColumn(int unknown, double step);
  bool hasRunAway(int unknown);
  void lookDeeper(const std::vector<int>& out_of_sight, Promise& promise);
  void clearConstrained(Eigen::VectorXd& d) const;
  bool isNegligibleHere(const Eigen::VectorXd& d, double tolerance);
  void analyze();
  void requireRange();
  SolveStatus lookAgain(SolveStatus status, bool& has_changed);

  Problem& problem_;
  Linearizer& linearizer_;
  const Collective* collective_ = &singleProcess();
  LinearSolver* given_ = nullptr;
  std::unique_ptr<LinearSolver> careful_;
  std::uint64_t careful_failed_at_ = ~std::uint64_t{0};  // revision of the structure
  LinearSolver* solver_ = nullptr;                       // one of the two
  ProblemStructure structure_;
  StructureChanges changes_ = StructureChanges::all();  // since the solver was analysed
  std::uint64_t structured_at_ = ~std::uint64_t{0};
  std::uint64_t full_rank_at_ = ~std::uint64_t{0} - 1;  // structured_at_ of hadFullRank()
  std::uint64_t analyzed_at_ = ~std::uint64_t{0};
  std::uint64_t linearized_at_ = ~std::uint64_t{0};
  std::uint64_t content_of_solver_ = 0;
  double rss_ = 0;
  double squared_norm_ = 0;  // of r as passed to the solver
  std::function<bool()> must_stop_;
  bool was_hidden_ = false;
  // The linearisation is that of the values before the last tried step.
  bool saved_is_linearized_ = false;
  double setup_seconds_ = 0, linearize_seconds_ = 0;
};

}  // namespace slom
