/// Linearizer: residuals and derivatives of the whole problem, in batches, on several threads, in an order that does
/// not depend on the number of threads. Losses enter here. The RSS is the sum of rho(|W r|^2). The r and J for a sink
/// are scaled such that J^T r is half the gradient of the RSS (src/linearize/reweight.hpp). Measurements without a loss
/// are not changed.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "slom/linearize/jacobian_sink.hpp"
#include "slom/linearize/structure.hpp"

namespace slom {

/// Runs the user's functions on the threads of the arena that it is called in. Keeps buffers between calls.
class Linearizer {
 public:
  /// Scales the parameter c of every loss by sqrt(mu), for graduated non-convexity. mu = 1 restores the given losses.
  void setLossGraduation(double mu) { graduation_ = mu; }
  /// Returns the graduation parameter mu of the losses; 1: the given losses.
  double lossGraduation() const { return graduation_; }

  /// Limit of the RSS; beyond it products of linearised numbers may overflow.
  static constexpr double kLargestRss = 1e200;

  /// Returns the RSS at the current values; NaN if a residual is not finite or the sum exceeds kLargestRss.
  double rss(const Problem& problem);
  /// Returns the RSS of each pool.
  std::vector<double> rssPerPool(const Problem& problem);
  /// Returns max |W r|^2 / c^2 over the measurements with a loss of scale c, as given (mu = 1); -1 if there are none.
  double largestLossArgument(const Problem& problem);
  /// Writes all whitened residuals, pool by pool, without losses.
  void residuals(const Problem& problem, double* r);

  /// Sends all linearised measurements to `sink` and returns the RSS. What is fixed or at an active bound in `active`
  /// does not move; the problem's own active set is ignored. Throws [slom.not-finite] or [slom.measurement-threw], with
  /// the names of the measurement and its variables and their values.
  double linearize(const Problem& problem, const ActiveSet& active, JacobianSink& sink);
  /// Returns one measurement of a pool in the form of linearize(). The batch is valid until the next call of any
  /// function of this class. Throws as linearize() does.
  JacobianBatch linearizeOne(const Problem& problem, const ActiveSet& active, int pool, int i) {
    return linearizeSome(problem, active, pool, i, i + 1);
  }
  /// Returns the measurements [first, last) of a pool in one batch. `cost`: contribution of the measurements to the
  /// RSS.
  JacobianBatch linearizeSome(const Problem& problem, const ActiveSet& active, int pool, int first, int last,
                              double* cost = nullptr);
  /// Throws [slom.overflow] with the name of the measurement with the largest residual.
  [[noreturn]] void raiseOverflow(const Problem& problem);
  /// Returns (J^T r)_c of the last linearize for a component that is fixed or at an active bound; 0 for other
  /// components.
  double gradientOfConstrained(int variable, int component) const;
  /// Returns |r|^2 as sent by the last linearize, which is the RSS if there are no losses.
  double squaredNormSent() const { return squared_norm_sent_; }

 private:
  struct ConstrainedColumn {
    int variable, component;
    double gradient, squared_norm;
  };
  struct Chunk {
    int group = 0, first = 0, last = 0;
    int bad = -1;
    std::optional<MeasurementThrew> threw;
    const MeasurementType* type = nullptr;  ///< type that the arrays have room for
    std::vector<int> rows, dof;
    std::vector<double> r, J;
    std::vector<double> plain_r, plain_J;  ///< residuals and Jacobians without losses, if the sink needs them
    double rss = 0;
    double squared_norm = 0;  ///< |r|^2, with r as sent to the sink
    std::vector<ConstrainedColumn> constrained;

    /// Clears the faults.
    void forget() { bad = -1, threw.reset(); }
    bool isGood() const { return !threw && bad < 0; }
    JacobianBatch batch() const {
      return {group, first, last - first, rows.data(), dof.data(), r.data(), J.data()};
    }
    JacobianBatch plainBatch() const {
      return {group, first, last - first, rows.data(), dof.data(), plain_r.data(), plain_J.data()};
    }
  };
  struct Range {
    int group, first, last;
  };

  /// Returns ranges that cover all measurements. None crosses the beginning of a partition.
  static std::vector<Range> ranges(const Problem& problem, std::span<const MeasurementPlace> partitions = {});
  static void prepare(const Problem& problem, const Range& range, bool with_jacobian, Chunk& chunk);
  void addLosses(const Problem& problem, bool with_jacobian, Chunk& chunk) const;
  void linearizeChunk(const Problem& problem, const ActiveSet& active, const Range& range, bool wants_plain,
                      Chunk& chunk) const;
  /// Throws the fault of the chunk, if any.
  static void requireGood(const Problem& problem, const Chunk& chunk);
  /// Sets the columns of components that are fixed or at an active bound to 0 in the chunk. If `constrained` is given,
  /// appends the previous columns to it.
  static void clearConstrained(const Problem& problem, const ActiveSet& active, const Chunk& chunk,
                               const double* r, double* J, std::vector<ConstrainedColumn>* constrained);
  /// Sends the group of equations that keep components in place that are fixed or at an active bound.
  void sendConstrained(const Problem& problem, const ActiveSet& active, JacobianSink& sink) const;
  [[noreturn]] static void raiseNotFinite(const Problem& problem, int group, int measurement);

  double graduation_ = 1;
  double squared_norm_sent_ = 0;
  std::map<std::pair<int, int>, ConstrainedColumn> constrained_;  // by variable and component
  std::vector<Chunk> chunks_;
};

}  // namespace slom
