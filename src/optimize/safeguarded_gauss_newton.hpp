/// Gauss-Newton with a fallback: full steps as long as they lead downhill, otherwise Levenberg-Marquardt.
#pragma once

#include <memory>

#include "problem/value_snapshot.hpp"
#include "slom/optimize/algorithm.hpp"

namespace slom {

/// Large problems far from their solution, such as pose graphs started from odometry, need full steps that lead uphill
/// for a moment. The RSS must then fall below that of the last good values within a few steps. Otherwise those values
/// return and Levenberg-Marquardt continues. After steps of Levenberg-Marquardt that achieve the predicted decrease, a
/// full step is tried again. Each refused full step doubles the number of such steps required before the next.
///   source   Chamberlain, Powell, Lemarechal and Pedersen, "The watchdog technique for forcing convergence in
///            algorithms for constrained optimization", Mathematical Programming Study 16, 1982
class SafeguardedGaussNewton final : public Algorithm {
 public:
  std::string name() const override;
  std::unique_ptr<Algorithm> clone() const override { return std::make_unique<SafeguardedGaussNewton>(); }
  void reset() override;
  StepOutcome step(Evaluator& evaluator, const Options& options) override;
  void finish(Evaluator& evaluator) override;
  bool mayGoUphill() const override { return false; }  // finish() undoes steps that stay uphill

 private:
  bool isAcceptable(Evaluator& evaluator, const StepOutcome& outcome);
  void takeBack(Evaluator& evaluator);

  GaussNewton newton_;
  LevenbergMarquardt damped_;
  bool is_newton_ = true, was_newton_ = true;
  bool has_fallen_back_ = false;
  int good_steps_ = 0, patience_ = 1;
  std::unique_ptr<ValueSnapshot> best_;  // before the first uphill step
  double best_rss_ = 0;
  int uphill_ = 0;
};

}  // namespace slom
