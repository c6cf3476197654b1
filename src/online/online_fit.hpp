/// A fit that follows the problem: its work is proportional to what has changed.
///
/// Every measurement has a residual and a Jacobian at the current values, for the gradient. The factor holds another
/// Jacobian of it, which may be that of earlier values. So a step d = -H^-1 g is a quasi-Newton step towards the
/// optimum of the problem itself. Its predicted decrease, g^T H^-1 g, does not suffer from old linearisation points. If
/// the two Jacobians differ so much that steps converge slowly, the factor gets the new one.
///   source   Nocedal and Wright, "Numerical optimization", 2006, section 11.1 (chord method); for the method of iSAM2,
///            Kaess et al., "iSAM2", IJRR 2012 (fluid relinearisation, by thresholds of coordinates)
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "online/incremental_cholesky.hpp"
#include "problem/value_snapshot.hpp"
#include "slom/linearize/linearize.hpp"
#include "slom/online/update.hpp"

namespace slom {

class OnlineFit {
 public:
  OnlineFit(Problem& problem, Linearizer& linearizer) : problem_(problem), linearizer_(linearizer) {}

  /// Steps until the tolerance is met or the budget is used up. Returns false if a step went uphill although the factor
  /// is up to date, or reached values without residuals. Then a damped fit of everything is to continue from the values
  /// reached.
  bool run(const UpdateOptions& options, UpdateSummary& summary);
  /// Writes the block of H^-1 of two variables, dof_a x dof_b, column-major, from the Jacobians in the factor; 0 if one
  /// of them is fixed. Throws [slom.not-updated] if something has changed since run(), and [slom.rank-deficient].
  void writeCovariance(int a, int b, double* out) const;
  /// Updates the covariances of all variables, see IncrementalCholesky::updateInverse(). Throws as writeCovariance()
  /// does.
  void updateMarginals(double most_change);
  bool hasBlock(int variable) const { return known_[static_cast<std::size_t>(variable)] != kUnknown; }
  /// Writes the covariance of a variable with a block, as updateMarginals() left it.
  void writeMarginal(int variable, double* out) const;

 private:
  /// The state of a measurement; records lie at the measurements' places in their pools.
  struct Record {
    int element = kPending;
    bool is_plain = false;  // the element's Jacobian is that of the measurement
    double cost = 0;        // rho(|W r|^2)
    double graduation = 1;  // of its loss
    double rounding = 0;    // squared residual due to rounding errors of the values
    std::uint64_t visited = 0;
    bool is_new = false;  // its loss has not been evaluated yet
  };
  /// A measurement that its loss refused, or that has not been examined yet. If a call ended the trial, a later call
  /// continues it at its values. If these are outdated, a call with more left for it begins it again.
  struct Trial {
    int pool;
    SlotRef ref;
    std::unique_ptr<ValueSnapshot> values = nullptr;  // values at which the trial continues
    bool is_graduated = true;                         // its loss, at these values
    double operations = 0;                            // operations left in the call that ended it
    int steps = 0;
    bool is_done = false;
  };
  static constexpr long kUnknown = -1;
  static constexpr int kPending = -1, kNone = -2;  // no element yet; an element without free variables
  using Place = std::pair<int, int>;               // pool, index

  /// Reason why steps ended: the tolerance is met, the budget is used up, the number of steps is reached, or steps lead
  /// uphill.
  enum class End { near, put_off, max_steps, stuck };

  /// Result of a trial: the map is better with the measurement, or worse, or the call ended before this was known.
  enum class Verdict { better, worse, unknown };

  bool stepToTolerance(const UpdateOptions& options, UpdateSummary& summary);
  End descend(const UpdateOptions& options);
  End reconsiderAll(const UpdateOptions& options, UpdateSummary& summary);
  End reconsider(Trial& trial, Place place, const UpdateOptions& options, UpdateSummary& summary);
  Verdict tryIt(Trial& trial, Place place, const UpdateOptions& options);
  bool mayBegin(const Trial& trial, double operations, int steps) const;
  void forgetTrialValues(bool all);
  bool isRefused(Place place) const;
  bool isExhausted(const UpdateOptions& options) const;
  void setGraduation(Place place, double graduation);
  double squaredResidual(Place place) const;
  void follow(bool remembers_new);
  void startAgain();
  void followVariables();
  void followMoves();
  void makeElement(Place place, bool remembers_new);
  void dropElement(Record& record);
  std::vector<Place> usesOf(int variable) const;
  void touchUsesOf(int variable);
  void linearize(Place first, int count, double most_difference);
  void take(Place place, const double* r, const double* J, const int* dof, double cost,
            double most_difference);
  void merge(Place place, const double* J, const int* dof);
  void roundAgain(Record& record);
  void linearizeTouched(double most_difference);
  void addToRss(double change);
  void sumAgain();
  void prepare(const std::vector<IncrementalCholesky::Move>& moves);
  void moveBy(double factor);
  bool isBelow(double most);
  bool go(double promised);
  void stretch(double before, double promised);
  double rss() const { return rss_ + rss_rest_; }
  void fill(UpdateSummary& summary, bool converged) const;
  void requireCurrent(int variable) const;
  void requireDetermined(int variable, const std::vector<std::pair<int, int>>& undetermined) const;
  double flops() const { return factor_.work().flops + flops_; }
  Record& recordOf(Place place) {
    return records_[static_cast<std::size_t>(place.first)][static_cast<std::size_t>(place.second)];
  }

  Problem& problem_;
  Linearizer& linearizer_;
  IncrementalCholesky factor_;
  std::uint64_t structure_revision_ = 0, value_revision_ = 0;
  bool has_started_ = false, is_at_end_ = false;
  bool is_done_everywhere_ = true;  // the last call left no part of a step
  std::vector<std::vector<Record>> records_;
  std::vector<long> known_;  // serials of the variables with blocks; kUnknown: no block
  std::vector<int> touched_variables_;
  std::vector<Place> pending_, touched_;
  std::vector<int> moved_variables_;  // variables of the last step, whose entries are step_
  std::vector<double> step_;
  std::uint64_t visit_ = 0;
  double rss_ = 0, rss_rest_ = 0, peak_ = 0;  // peak_: largest sum since the last full summation
  double rounding_ = 0;                       // rounding error of the RSS
  std::vector<Trial> waiting_;                // for later calls, oldest first
  std::unique_ptr<ValueSnapshot> trial_;      // values before a trial, which may be undone
  int linearized_ = 0, moved_ = 0, steps_ = 0;
  double flops_ = 0;  // work of the gradients of measurements
  std::vector<double> A_, g_;
};

}  // namespace slom
