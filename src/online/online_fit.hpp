/// A fit that follows the problem: work in proportion to what has changed.
///
/// Every measurement has its residual and Jacobian at the current values, for the gradient, and the Jacobian that is in the factor, which
/// may be that of earlier values. A step d = -H^-1 g is thus a quasi-Newton step towards the optimum of the problem itself, and its
/// predicted decrease, g^T H^-1 g, does not suffer from old linearisation points. The factor gets a new Jacobian where the old one differs so much
/// that steps converge slowly.
///   source   Nocedal and Wright, "Numerical optimization", 2006, section 11.1 (chord method); for what iSAM2 does instead, Kaess et
///            al., "iSAM2", IJRR 2012 (fluid relinearisation, by thresholds of coordinates)
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

  /// Steps until the tolerance is met or the budget used up. False, with the values as good as they came to be, where a step went uphill
  /// although the factor is up to date, or met values without residuals: a damped fit of everything is to go on.
  bool run(const UpdateOptions& options, UpdateSummary& summary);
  /// Writes the block of H^-1 of two variables, dof_a x dof_b, column-major, 0 where one of them is fixed: by the Jacobians that are in the
  /// factor. Throws [slom.not-updated] where something has changed since run(), and [slom.rank-deficient].
  void writeCovariance(int a, int b, double* out) const;
  /// Brings the covariances of all variables up to date, as IncrementalCholesky::updateInverse() does. Throws as writeCovariance() does.
  void updateMarginals(double most_change);
  bool hasBlock(int variable) const { return known_[static_cast<std::size_t>(variable)] != kUnknown; }
  /// That of a variable with a block, as updateMarginals() left it.
  void writeMarginal(int variable, double* out) const;

 private:
  /// A measurement, at its place in its pool.
  struct Record {
    int element = kPending;
    bool is_plain = false;  // the element's Jacobian is that of the measurement
    double cost = 0;        // rho(|W r|^2)
    double graduation = 1;  // of its loss
    double rounding = 0;    // the squared residual that rounding errors of the values make
    std::uint64_t visited = 0;
    bool is_new = false;  // its loss has not been looked at
  };
  /// A measurement that was refused or was not looked at yet. A trial that a call has ended goes on at its values in a later one or, where
  /// these no longer hold, begins again in one that has more left for it.
  struct Trial {
    int pool;
    SlotRef ref;
    std::unique_ptr<ValueSnapshot> values = nullptr;  // where it goes on
    bool is_graduated = true;                         // its loss, there
    double operations = 0;                            // what the call that ended it had left
    int steps = 0;
    bool is_done = false;
  };
  static constexpr long kUnknown = -1;
  static constexpr int kPending = -1, kNone = -2;  // elements: to be made; without free variables
  using Place = std::pair<int, int>;               // pool, index

  /// Why steps ended: the tolerance is met, the budget used up, there were as many as may be, or they lead uphill.
  enum class End { near, put_off, max_steps, stuck };

  /// What a trial has shown: the map is better with the measurement, worse, or the call ended before it was known.
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
  bool is_done_everywhere_ = true;  // nothing was left by the last call
  std::vector<std::vector<Record>> records_;
  std::vector<long> known_;  // serials of the variables that have blocks; kUnknown: has none
  std::vector<int> touched_variables_;
  std::vector<Place> pending_, touched_;
  std::vector<int> moved_variables_;  // variables of the last step, whose entries are step_
  std::vector<double> step_;
  std::uint64_t visit_ = 0;
  double rss_ = 0, rss_rest_ = 0, peak_ = 0;  // peak_: the largest sum since all was added up
  double rounding_ = 0;                       // rounding error of the RSS
  std::vector<Trial> waiting_;                // for later calls, the oldest first
  std::unique_ptr<ValueSnapshot> trial_;      // what steps move, while they may have to be taken back
  int linearized_ = 0, moved_ = 0, steps_ = 0;
  double flops_ = 0;  // of gradients of measurements
  std::vector<double> A_, g_;
};

}  // namespace slom
