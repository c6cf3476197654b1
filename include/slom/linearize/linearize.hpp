/// Residuals and derivatives of the whole problem, in batches, on several threads, in an order that does not depend
/// on their number. Here losses enter: the RSS is the sum of rho(|W r|^2), and the r and J that a sink receives are
/// scaled such that J^T r is half its gradient (src/linearize/reweight.hpp). Measurements without one pass as they are.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "slom/linearize/jacobian_sink.hpp"
#include "slom/linearize/structure.hpp"

namespace slom {

/// Runs the user's functions, on the threads of the arena that it is called in; keeps buffers between calls.
class Linearizer {
 public:
  /// Scales the parameter c of every loss by sqrt(mu), for graduated non-convexity. mu = 1 restores the losses as given.
  void setLossGraduation(double mu) { graduation_ = mu; }
  /// The graduation parameter mu of the losses; 1: the losses as given.
  double lossGraduation() const { return graduation_; }

  /// Beyond it products of what is linearised may overflow.
  static constexpr double kLargestRss = 1e200;

  /// The RSS at the current values; NaN when a residual is not finite or the sum beyond kLargestRss.
  double rss(const Problem& problem);
  /// The same for each pool.
  std::vector<double> rssPerPool(const Problem& problem);
  /// max |W r|^2 / c^2 over the measurements with a loss of scale c, as given (mu = 1); -1 when there are none.
  double largestLossArgument(const Problem& problem);
  /// Writes all whitened residuals, pool after pool, without losses.
  void residuals(const Problem& problem, double* r);

  /// Sends all linearised measurements to `sink`; returns the RSS. What is fixed or at an active bound in `active` does not move, whatever the
  /// problem's own active set says. Throws [slom.not-finite] or [slom.measurement-threw], naming the measurement, its variables and their values.
  double linearize(const Problem& problem, const ActiveSet& active, JacobianSink& sink);
  /// One measurement of a pool, as linearize() sends it; the batch is valid until the next call of anything here. Throws as linearize()
  /// does. `cost`: what the measurements add to the RSS.
  JacobianBatch linearizeOne(const Problem& problem, const ActiveSet& active, int pool, int i) {
    return linearizeSome(problem, active, pool, i, i + 1);
  }
  /// The same of [first, last) of a pool, all in one batch.
  JacobianBatch linearizeSome(const Problem& problem, const ActiveSet& active, int pool, int first, int last,
                              double* cost = nullptr);
  /// Throws [slom.overflow], naming the measurement with the largest residual.
  [[noreturn]] void raiseOverflow(const Problem& problem);
  /// (J^T r)_c, of the last linearize, for a component that is fixed or at an active bound; 0 for others.
  double gradientOfConstrained(int variable, int component) const;
  /// |r|^2 of what the last linearize sent; the RSS when there are no losses.
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
    const MeasurementType* type = nullptr;  ///< that the arrays have room for
    std::vector<int> rows, dof;
    std::vector<double> r, J;
    std::vector<double> plain_r, plain_J;  ///< before losses reweighted them, where the sink wants them
    double rss = 0;
    double squared_norm = 0;  ///< |r|^2, as the sink gets r
    std::vector<ConstrainedColumn> constrained;

    /// What went wrong.
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

  /// Ranges that cover all measurements; none crosses the beginning of a partition.
  static std::vector<Range> ranges(const Problem& problem, std::span<const MeasurementPlace> partitions = {});
  static void prepare(const Problem& problem, const Range& range, bool with_jacobian, Chunk& chunk);
  void addLosses(const Problem& problem, bool with_jacobian, Chunk& chunk) const;
  void linearizeChunk(const Problem& problem, const ActiveSet& active, const Range& range, bool wants_plain,
                      Chunk& chunk) const;
  /// Throws what went wrong in it.
  static void requireGood(const Problem& problem, const Chunk& chunk);
  /// Makes the columns of components that are fixed or at an active bound 0, in r and J of the chunk; appends what they were to `constrained`, where given.
  static void clearConstrained(const Problem& problem, const ActiveSet& active, const Chunk& chunk,
                               const double* r, double* J, std::vector<ConstrainedColumn>* constrained);
  /// Sends the group of equations by which components that are fixed or at an active bound do not move.
  void sendConstrained(const Problem& problem, const ActiveSet& active, JacobianSink& sink) const;
  [[noreturn]] static void raiseNotFinite(const Problem& problem, int group, int measurement);

  double graduation_ = 1;
  double squared_norm_sent_ = 0;
  std::map<std::pair<int, int>, ConstrainedColumn> constrained_;  // by variable and component
  std::vector<Chunk> chunks_;
};

}  // namespace slom
