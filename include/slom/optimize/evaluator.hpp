/// The problem as an algorithm sees it: a point, its linearisation, and steps that can be taken back.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "slom/linearize/linearize.hpp"
#include "slom/optimize/summary.hpp"
#include "slom/solve/linear_solver.hpp"

namespace slom {

class Evaluator {
 public:
  /// Of a problem, which must outlive it.
  Evaluator(Problem& problem, Linearizer& linearizer) : problem_(problem), linearizer_(linearizer) {}
  ~Evaluator();

  /// Uses this solver from now on. Not owned.
  void setSolver(LinearSolver& solver);

  /// The structure of the problem as it is now.
  const ProblemStructure& structure();
  /// The solver, analysed for the structure, for others to fill: its content is lost.
  LinearSolver& lendSolver();
  /// Whether the solver, analysed for the structure, is exact (LinearSolver::isExact). Its content stays.
  bool isSolverExact();
  /// Changes whenever the solver gets other numbers.
  std::uint64_t contentOfSolver() const { return content_of_solver_; }
  /// Linearises at the current values unless that has been done; returns the RSS.
  double linearize();
  /// The solver set, or its careful one where it has found no rank and that does: from then on until the structure changes.
  LinearSolver& solver() { return *solver_; }
  const LinearSolver& solver() const { return *solver_; }

  /// Moves all values by `d` and returns the RSS there, NaN when a residual is not finite. A user's function that
  /// throws leaves the values where they were.
  double tryStep(const Eigen::VectorXd& d);
  /// The same for a step that is likely to stay: linearises there at once where derivatives cost little.
  double tryLikelyStep(const Eigen::VectorXd& d);
  /// Whether the last step led closer to the solution, judged without the RSS: linearises there, and checks whether the decrease
  /// predicted for the solver's step with this damping is below `promised`, the predictedDecrease from before. Returns false where a
  /// derivative is not finite.
  bool cameCloser(const Eigen::VectorXd& damping, double promised);
  /// Linearises where the last tried step has led to. Returns false where a derivative or the RSS is not finite there. An algorithm accepts
  /// a step only if it returns true.
  bool hasFiniteDerivatives();
  /// `d`, shortened in each component that it would take beyond a bound.
  Eigen::VectorXd withinBounds(const Eigen::VectorXd& d) const;
  /// Takes the last tried step back; the linearisation is valid again.
  void undo();

  /// The RSS at the current values, without derivatives; NaN when a residual is not finite.
  double rss() { return linearizer_.rss(problem_); }

  /// Scales the parameter c of every loss by sqrt(mu), for graduated non-convexity. mu = 1 restores the losses as given.
  void setLossGraduation(double mu);
  /// The graduation parameter mu of the losses; 1: the losses as given.
  double lossGraduation() const { return linearizer_.lossGraduation(); }
  /// max |W r|^2 / c^2 over the measurements with a loss of scale c at the current values; -1 when there are none.
  double largestLossArgument() { return linearizer_.largestLossArgument(problem_); }

  /// max_i |g_i| / (|J_i| |r|) of the linearisation, where losses have reweighted r and J; 0 for a perfect fit.
  double orthogonality() const;
  /// The same of g = J^T r, the diagonal of J^T J and |r|^2.
  static double orthogonality(const Eigen::VectorXd& gradient, const Eigen::VectorXd& diagonal,
                              double squared_norm);
  /// max_i g_i^2 / H_ii: the predicted decrease for the best step of a single unknown, a lower bound of that for all.
  double promiseOfOneUnknown() const;
  /// max_i |d_i| |J_i|
  double stepInDeviations(const Eigen::VectorXd& d) const;
  /// Whether |d_i| <= tolerance (|x_i| + 1 / |J_i|) for all i, at the current values.
  bool isNegligible(const Eigen::VectorXd& d, double tolerance);
  /// The step and the decrease that the linear model predicts without damping. Where the solver finds no unique solution, with the least
  /// damping that makes it unique: a direction in which no residual changes contributes nothing.
  struct Promise {
    bool is_known = false;
    bool has_full_rank = false;
    double decrease = 0;  ///< predicted decrease of the RSS: g^T H^-1 g
    Eigen::VectorXd step;
  };
  /// `carefully`: also tries the careful solver where the other finds no full rank. J itself is factorised, which may take longer than the
  /// fit, to look for decreases that J^T J does not show, but only where the one that it shows is at most `most`.
  Promise promise(bool carefully = true, double most = std::numeric_limits<double>::infinity());
  /// Takes the step of a promise if the RSS falls by at least a quarter of the predicted decrease. Returns whether it has.
  bool advance(const Promise& promise);
  /// Unknowns whose columns of J are so short that moving them by their own size changes no residual beyond rounding, and whose moves by
  /// 1 / |J_i| do not change the residuals as the column says: a fit has led to where nothing depends on them. Linearise first.
  std::vector<int> unseenAtRest();
  /// |x_i| of every unknown (1 for angles).
  Eigen::VectorXd typicalSizes();
  /// The share of the length of a column of J above which it is more than errors of the derivatives and rounding in long chains of unknowns.
  static double digitsOfDerivatives(const Problem& problem);
  static constexpr double kExactDigits = 1e-10, kNumericDigits = 1e-8;
  /// The squared change of the residuals by rounding of the values: a predicted decrease below it cannot be achieved.
  double roundingOfPromises();

  /// Whether the last solution without damping was unique, for the structure as it is now; false where none was asked for, or
  /// the solver is not exact.
  bool hadFullRank() const { return full_rank_at_ == structured_at_ && solver_->isExact(); }

  /// Asked by mustStop(); none: never.
  void setInterruption(std::function<bool()> must_stop) { must_stop_ = std::move(must_stop); }
  /// Whether the fit is to end: an algorithm that tries several steps asks before each.
  bool mustStop() const { return must_stop_ && must_stop_(); }

  /// The Gauss-Newton step. Fails also at an unknown whose column of J is rounding error, so that no residual depends on it: one that
  /// the step would move by more than its typical size, though such a move changes the residuals by less than rounding does, and
  /// whose moves do not change the residuals as the column says.
  SolveStatus solveUndamped(Eigen::VectorXd& step);
  /// Whether the last solveUndamped has failed at such an unknown, and not for the rank of J.
  bool wasHidden() const { return was_hidden_; }
  /// The step with this damping, in which such unknowns stay where they are.
  SolveStatus solveDamped(const Eigen::VectorXd& damping, Eigen::VectorXd& step);
  /// The decrease of the RSS that the linear model predicts for the step d: -(2 g d + |J d|^2).
  double predictedDecrease(const Eigen::VectorXd& d) const;
  /// The same for a d that the solver found with this damping (by unknown, or empty): -g d + sum damping d^2.
  double predictedDecrease(const Eigen::VectorXd& d, const Eigen::VectorXd& damping) const;

  /// Whether a change of the RSS may be rounding error, and that of the residuals is often many times larger than that of
  /// their sum of squares.
  bool mayBeRounding(double change) const;
  static constexpr double kRounding = 1e-14;  ///< relative rounding error of a sum of squares
  static constexpr double kNoise = 1e-13;  ///< rounding error of a difference of two sums, relative to them
  static constexpr double kNothing =
      1e-30;  ///< least predicted decrease, relative to the RSS, of a step worth a trial
  /// Whether the predicted decrease for a step nearly without damping is so small that Convergence decides, not shorter steps.
  bool isNearlyNothing(double promised, const Options& options) const {
    return promised <= std::min(std::max(options.decrease_tolerance, kRounding) * rss_,
                                options.deviation_tolerance * options.deviation_tolerance);
  }

  /// Where time went since construction.
  PhaseSeconds seconds() const;

  /// The problem that is evaluated.
  Problem& problem() { return problem_; }

 private:
  void move(const Eigen::VectorXd& d);
  SolveStatus solve(const Eigen::VectorXd& damping, Eigen::VectorXd& step);
  std::vector<int> unseenUnknowns(const Eigen::VectorXd& d);
  bool isTrueColumn(int unknown, double step);
  bool hasRunAway(int unknown);
  void lookDeeper(const std::vector<int>& out_of_sight, Promise& promise);
  void clearConstrained(Eigen::VectorXd& d) const;
  void analyze();
  void requireRange();
  SolveStatus lookAgain(SolveStatus status, bool& has_changed);

  Problem& problem_;
  Linearizer& linearizer_;
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
  double squared_norm_ = 0;  // of r as the solver got it
  std::function<bool()> must_stop_;
  bool was_hidden_ = false;
  bool saved_is_linearized_ =
      false;  // the linearisation is that of the values before the step that was tried last
  double setup_seconds_ = 0, linearize_seconds_ = 0;
};

}  // namespace slom
