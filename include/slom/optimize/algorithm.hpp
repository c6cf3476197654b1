/// Algorithms that find a step: Gauss-Newton, Levenberg-Marquardt and Powell's dog leg.
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

/// Outcome of one step of an algorithm.
struct StepOutcome {
  enum class Kind {
    taken,       ///< the values have moved
    singular,    ///< the linear system has no unique solution; nothing moved
    not_finite,  ///< a residual is not finite after the step, which was undone
    stuck,       ///< no tried step reduced the RSS; nothing moved
    stopped      ///< Evaluator::mustStop() said so between two trials; nothing moved
  };
  Kind kind = Kind::taken;
  double rss_before = 0;
  double rss_after = 0;
  double predicted_decrease = 0;  ///< decrease of the RSS that the linear model predicts
  /// The step solves the undamped linear system, so the model promises no larger decrease.
  bool is_undamped = false;
  double damping = 0;
  int trials = 0;
  Eigen::VectorXd step;
  SolveStatus status;  ///< status of the linear solver if it is singular
  std::string event;   ///< message for the user: "the Gauss-Newton step made the RSS grow; ..."
};

/// Interface of algorithms. To write your own, use the Evaluator of slom/optimize/evaluator.hpp.
class Algorithm {
 public:
  virtual ~Algorithm() = default;
  /// Returns the name, such as `Gauss-Newton`.
  virtual std::string name() const = 0;
  /// Returns a copy, including the state from earlier steps.
  virtual std::unique_ptr<Algorithm> clone() const = 0;
  /// Discards the state from earlier steps (damping, radius).
  virtual void reset() {}
  /// Linearises at the current values and moves them by one step.
  virtual StepOutcome step(Evaluator& evaluator, const Options& options) = 0;
  /// Ends the fit: restores better values if the algorithm has kept any.
  virtual void finish(Evaluator&) {}
  /// Returns whether a step may increase the RSS. If so, a fit that does not converge restores the best values found.
  virtual bool mayGoUphill() const { return true; }
  /// Returns the algorithm that replaces this one with Options::fall_back; null: this one stays.
  virtual std::unique_ptr<Algorithm> safeguarded() const;
};

/// d = -(J^T J)^-1 J^T r, taken whether or not the RSS falls. If a step leads uphill, Options::fall_back switches to
/// Levenberg-Marquardt.
class GaussNewton final : public Algorithm {
 public:
  std::string name() const override;
  std::unique_ptr<Algorithm> clone() const override;
  StepOutcome step(Evaluator& evaluator, const Options& options) override;
  std::unique_ptr<Algorithm> safeguarded() const override;
};

/// The scale of each unknown: the largest diagonal entry of J^T J in this fit so far (1 while that is 0). So no unit
/// counts for more than another, and the scale does not swing with the linearisation. With a `memory` below 1, the
/// weight of an earlier linearisation falls by that factor with each later one.
///   source   More, "The Levenberg-Marquardt algorithm: implementation and theory", 1978, section 6
class ColumnScaling {
 public:
  /// Includes the linearisation of `system` and returns the scales, which are valid until the next call.
  Eigen::Map<const Eigen::VectorXd> update(Evaluator& evaluator, double memory = 1);
  /// Discards all linearisations.
  void reset() { largest_.clear(); }

 private:
  std::uint64_t structure_revision_ = 0;
  std::vector<double> largest_, scale_;
};

/// d = -(J^T J + mu D)^-1 J^T r with D the ColumnScaling. mu is raised until the RSS falls. Close to the solution, the
/// change of the RSS is rounding error. Then a step is accepted if g^T (J^T J + mu D)^-1 g is smaller after it. This
/// number is accurate to the last digits of the unknowns, the RSS only to half of them. DogLeg does the same.
///   damping     Marquardt 1963, with the scale of More 1978
///   gain ratio and update of mu   Nielsen 1999, as in Madsen, Nielsen and Tingleff, "Methods for non-linear least
///               squares problems", 2004, algorithm 3.16: rho = actual / predicted decrease; for rho > 0
///               mu *= max(1/3, 1 - (2 rho - 1)^3), nu = 2; otherwise mu *= nu, nu *= 2.
///   last digits Conn, Gould and Toint, "Trust-region methods", 2000, section 17.4.2 (rho = 1 among rounding errors);
///               Hager and Zhang, "A new conjugate gradient method", SIAM J. Optim. 16, 2005, section 4 (the gradient
///               decides)
class LevenbergMarquardt final : public Algorithm {
 public:
  /// Sets the first mu, `initial_damping`, and the `memory` of the scales, from 0 to 1. With 1, each scale is the
  /// largest so far, which is the safest. But this slows unknowns whose influence falls during the fit, such as points
  /// that recede from cameras. A bundle adjustment is faster with 0.1. Throws [slom.bad-option].
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

/// Takes the Gauss-Newton step if it fits into the trust region |D^1/2 d| <= radius, D the ColumnScaling. Otherwise
/// takes the point where the path from the best steepest-descent step to the Gauss-Newton step leaves the region.
///   source   Powell 1970, as in Madsen, Nielsen and Tingleff 2004, algorithm 3.21, in scaled unknowns; the radius
///            becomes max(radius, 3 |d|) for rho > 3/4 and half of it for rho < 1/4. The first radius is the length of
///            the first Gauss-Newton step.
class DogLeg final : public Algorithm {
 public:
  /// Sets the first radius; 0: the length of the first Gauss-Newton step.
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
