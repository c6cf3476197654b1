/// Inner part of splines: which control points exist, and the measurements whose times are estimated.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "slom/estimator.hpp"
#include "slom/trajectory/knots.hpp"

namespace slom::trajectory::detail {

/// A time as it is now: a constant, or a function of variables.
using Clock = std::function<double()>;

/// A measurement on splines that is inserted again when its time has moved to another segment.
class MovingMeasurement {
 public:
  virtual ~MovingMeasurement();
  /// Returns whether the measurement is in the estimator, and its splines exist.
  virtual bool exists() const = 0;
  /// Returns whether a time is outside the segment that the measurement was inserted with.
  virtual bool isAway() const = 0;
  /// Inserts the measurement on the segments of its times, extends the splines for it, and removes the old one.
  virtual void place(Estimator& est) = 0;

  AnyMeasID id;  ///< the measurement in the estimator
};

/// Which control points get a measurement that ties them to their neighbours.
enum class Ties {
  ends,  ///< those that data determine little: a weak one, to the two neighbours on the side of the other end
  all,   ///< each one: the prior of a Gaussian process, to the neighbour that was there before
};

/// The control points first, ..., first + count - 1 of a spline, without their type.
class SplineState {
 public:
  /// Starts with no control points.
  SplineState(Knots knots, std::string name, int order, Ties ties);
  virtual ~SplineState();
  SplineState(const SplineState&) = delete;
  SplineState& operator=(const SplineState&) = delete;

  const Knots knots;
  const std::string name;
  const int order;
  std::vector<std::shared_ptr<MovingMeasurement>> moving;  ///< those that depend on this spline
  bool has_changed = false;                                ///< one of them has moved since the last follow()

  /// Returns the segments that have all their control points: first to last, none if last < first.
  std::int64_t firstSegment() const { return first_; }
  std::int64_t lastSegment() const { return first_ + count() - order; }
  /// Returns the number of control points.
  virtual std::int64_t count() const = 0;
  /// Returns the segment of a covered time; the end of the last segment is covered, too. Throws [slom.bad-time] or
  /// [slom.uncovered-time].
  std::int64_t coveredSegment(double t) const;
  /// Returns the segment that a measurement moves to from `present` for this time: at most kMostAtOnce segments away.
  std::int64_t nextSegment(double t, std::int64_t present) const;
  /// Returns whether a time is outside a segment by more than rounding errors. If a measurement has returned to its
  /// segment a number of times, the minimum is where segments meet; the margin is then 4 times as wide for each return,
  /// up to a quarter of the segment.
  bool isOutside(double t, std::int64_t segment, int returns) const;
  /// Adds the control points that these segments lack. If `tied`, or for Ties::all, each gets a measurement that the
  /// motion continues, because the measurement that needs it may not determine it.
  void cover(Estimator& est, std::int64_t first_segment, std::int64_t last_segment, bool tied);
  /// Adds the control points that the times between `from` and `to` lack. Throws [slom.bad-time].
  void cover(Estimator& est, double from, double to);
  /// Removes the control points at both ends on which no measurement of the user depends. Keeps those of one segment.
  void trim(Estimator& est);
  /// Gives the order - 1 outermost control points at each end such a weak measurement if they have none. A segment with
  /// few measurements near its inner knot hardly determines its outermost control point. `renew`: replaces old ones.
  /// Does nothing for Ties::all.
  void tieEnds(Estimator& est, bool renew);

  /// A spline grows by at most this number of segments at a time, so a fit that diverges does not fill the memory.
  static constexpr std::int64_t kMostAtOnce = 256;

 protected:
  /// Adds control point i at the front or at the back.
  virtual void add(Estimator& est, std::int64_t i, bool at_front) = 0;
  /// Inserts the measurement that the motion continues to control point i from i + step, and from i + 2 step for
  /// Ties::ends. There its standard deviations follow from the changes of the motion between all control points.
  virtual AnyMeasID tie(Estimator& est, std::int64_t i, std::int64_t step) const = 0;
  /// Removes the first or last control point.
  virtual void remove(Estimator& est, bool at_front) = 0;
  /// Returns the first or last control point, which must exist.
  virtual AnyVarID end(bool at_front) const = 0;

  std::int64_t first_ = 0;

 private:
  /// The measurement that the motion continues to a control point from the others up to `other_end`.
  struct Tie {
    AnyMeasID id;
    std::int64_t other_end = 0;
  };
  void grow(Estimator& est, bool at_front, bool tied);
  void tieTo(Estimator& est, std::int64_t i, std::int64_t step);
  /// Returns the keys of the ties that depend on control point i.
  std::vector<std::int64_t> tiesOf(std::int64_t i) const;

  Ties kind_;
  std::map<std::int64_t, Tie> ties_;  ///< by the control points that they were made for
};

}  // namespace slom::trajectory::detail
