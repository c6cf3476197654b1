/// How a step is found: Gauss-Newton, Levenberg-Marquardt or Powell's dog leg.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "slom/optimize/summary.hpp"
#include "slom/solve/linear_solver.hpp"

namespace slom {

class Evaluator;

/// What became of one step of an algorithm.
struct StepOutcome {
  enum class Kind {
    taken,       ///< the values have moved
    singular,    ///< the linear system has no unique solution; nothing moved
    not_finite,  ///< the step led to where a residual is not finite, and was taken back
    stuck,       ///< no step that was tried made the RSS smaller; nothing moved
    stopped      ///< Evaluator::mustStop(), between two trials; nothing moved
  };
  Kind kind = Kind::taken;
  double rss_before = 0;
  double rss_after = 0;
  double predicted_decrease = 0;  ///< decrease of the RSS that the linear model predicts
  bool is_undamped =
      false;  ///< the step solves the linear system as it is, so that model promises no more than this
  double damping = 0;
  int trials = 0;
  Eigen::VectorXd step;
  SolveStatus status;  ///< status of the linear solver when singular
  std::string event;   ///< what the user should know: "the Gauss-Newton step made the RSS grow; ..."
};

/// One of your own implements this, with the Evaluator of slom/optimize/evaluator.hpp.
class Algorithm {
 public:
  virtual ~Algorithm() = default;
  /// `Gauss-Newton`
  virtual std::string name() const = 0;
  /// A copy, with what earlier steps taught.
  virtual std::unique_ptr<Algorithm> clone() const = 0;
  /// Forgets what earlier steps taught (damping, radius).
  virtual void reset() {}
  /// Linearises at the current values and moves them by one step.
  virtual StepOutcome step(Evaluator& evaluator, const Options& options) = 0;
  /// The fit ends here: goes back to better values, where it knows some.
  virtual void finish(Evaluator&) {}
  /// Whether a step may make the RSS grow. Then a fit that does not converge goes back to the best values that it has seen.
  virtual bool mayGoUphill() const { return true; }
  /// What Options::fall_back takes in its place; null: itself.
  virtual std::unique_ptr<Algorithm> safeguarded() const;
};

/// d = -(J^T J)^-1 J^T r, taken whatever it does to the RSS. Options::fall_back adds Levenberg-Marquardt where that leads uphill.
class GaussNewton final : public Algorithm {
 public:
  std::string name() const override;
  std::unique_ptr<Algorithm> clone() const override;
  StepOutcome step(Evaluator& evaluator, const Options& options) override;
  std::unique_ptr<Algorithm> safeguarded() const override;
};

/// The scale of each unknown: the largest diagonal entry of J^T J that it has had in this fit (1 while that is 0), so
/// that no unit counts for more than another and the scale does not swing with the linearisation. With a `memory` below 1
/// each earlier linearisation counts by that factor less.
///   source   More, "The Levenberg-Marquardt algorithm: implementation and theory", 1978, section 6
class ColumnScaling {
 public:
  /// Takes the linearisation of `system` into account. Valid until the next call.
  Eigen::Map<const Eigen::VectorXd> update(Evaluator& evaluator, double memory = 1);
  /// Forgets all linearisations.
  void reset() { largest_.clear(); }

 private:
  std::uint64_t structure_revision_ = 0;
  std::vector<double> largest_, scale_;
};

/// d = -(J^T J + mu D)^-1 J^T r with D the ColumnScaling, mu raised until the RSS falls. Close to the solution, where the change
/// of the RSS is rounding error, a step counts as good when g^T (J^T J + mu D)^-1 g is smaller after it: that is accurate to the
/// last digits of the unknowns, the RSS to half of them. The dog leg does likewise.
///   damping     Marquardt 1963, with the scale of More 1978
///   gain ratio and update of mu   Nielsen 1999, as in Madsen, Nielsen and Tingleff, "Methods for non-linear least
///               squares problems", 2004, algorithm 3.16: rho = actual / predicted decrease; for rho > 0
///               mu *= max(1/3, 1 - (2 rho - 1)^3), nu = 2; otherwise mu *= nu, nu *= 2.
///   last digits Conn, Gould and Toint, "Trust-region methods", 2000, section 17.4.2 (rho = 1 among rounding errors);
///               Hager and Zhang, "A new conjugate gradient method", SIAM J. Optim. 16, 2005, section 4 (the gradient decides)
class LevenbergMarquardt final : public Algorithm {
 public:
  /// `initial_damping` is the first mu. `memory` of the scales, from 0 to 1: the largest so far is the safest, but it holds
  /// back unknowns whose influence falls along the way, as that of points that recede from cameras; a bundle
  /// adjustment goes faster with 0.1. Throws [slom.bad-option].
  explicit LevenbergMarquardt(double initial_damping = 1e-4, double memory = 1);

  std::string name() const override;
  std::unique_ptr<Algorithm> clone() const override;
  void reset() override;
  StepOutcome step(Evaluator& evaluator, const Options& options) override;
  bool mayGoUphill() const override { return false; }

 private:
  double initial_damping_, memory_;
  double mu_;
  double nu_ = 2;
  ColumnScaling scales_;
};

/// The Gauss-Newton step where it fits into the trust region |D^1/2 d| <= radius, D the ColumnScaling; otherwise the point where the path from the best steepest-descent step to it leaves the region.
///   source   Powell 1970, as in Madsen, Nielsen and Tingleff 2004, algorithm 3.21, in scaled unknowns; the radius
///            becomes max(radius, 3 |d|) for rho > 3/4 and half of it for rho < 1/4. The first radius is the length of
///            the first Gauss-Newton step.
class DogLeg final : public Algorithm {
 public:
  /// `initial_radius` 0: the length of the first Gauss-Newton step.
  explicit DogLeg(double initial_radius = 0);

  std::string name() const override;
  std::unique_ptr<Algorithm> clone() const override;
  void reset() override;
  StepOutcome step(Evaluator& evaluator, const Options& options) override;
  bool mayGoUphill() const override { return false; }

 private:
  double initial_radius_;
  double radius_;
  ColumnScaling scales_;
};

}  // namespace slom
