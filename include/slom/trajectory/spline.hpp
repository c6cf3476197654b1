/// Spline: control points as variables of an estimator, and the times that they cover.
///
///     slom::trajectory::PoseSpline<4> pose(slom::trajectory::Knots(0, 0.1), "pose");
///     pose.extend(est, 0, 60);                                   // the times of the data
///     ...                                                        // insertMeasurement of measurement.hpp
///     const auto where = pose.segmentAt(12.5).poseAt(12.5);      // after the fit
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <tuple>
#include <utility>

#include "slom/trajectory/pose_segment.hpp"
#include "slom/trajectory/screw_segment.hpp"
#include "slom/trajectory/spline_state.hpp"

namespace slom::trajectory {

namespace detail {

/// The measurement that the motion continues from two control points to the next, at a ratio of time steps.
struct Continues {
  double ratio;

  template <class C>
  auto operator()(const C& next, const C& near, const C& far) const {
    return mtk::difference(next, continued(near, far));
  }
  /// Returns the control point at which the motion continues.
  template <class C>
  C continued(const C& near, const C& far) const {
    return mtk::moved(near, mtk::difference(near, far), mtk::scalar_t<C>(ratio));
  }
};

/// Whether the control points are the states of a Gaussian process, with a prior between neighbours.
template <class Segment>
inline constexpr bool is_process = requires { typename Segment::Prior; };
/// The power spectral density of a process; nothing for splines.
template <class Segment>
struct DensityOf {
  struct Density {};
};
template <class Segment>
  requires is_process<Segment>
struct DensityOf<Segment> {
  using Density = typename Segment::Prior::Density;
};

/// The control points of a spline with segments of this kind.
template <class Segment>
class ControlPoints final : public SplineState {
 public:
  using Control = typename Segment::Control;
  /// Start values of control points by their times.
  using Start = std::function<Control(double)>;
  using Density = typename DensityOf<Segment>::Density;

  explicit ControlPoints(Knots all_knots, std::string its_name, const Density& its_density = Density())
      : SplineState(std::move(all_knots), std::move(its_name), Segment::order,
                    is_process<Segment> ? Ties::all : Ties::ends),
        density(its_density) {}

  std::int64_t count() const override { return static_cast<std::int64_t>(ids.size()); }
  /// Returns the control points of a segment as a tuple.
  auto of(std::int64_t segment) const {
    return [&]<std::size_t... J>(std::index_sequence<J...>) {
      return std::tuple{ids[static_cast<std::size_t>(segment - first_) + J]...};
    }(std::make_index_sequence<std::size_t{Segment::order}>());
  }
  /// Returns a segment at the present values.
  Segment segment(std::int64_t i) const {
    return std::apply(
        [&](const auto&... id) {
          return Segment(Blending<Segment::order>(knots, i), typename Segment::Controls{*id...});
        },
        of(i));
  }

  std::deque<VarID<Control>> ids;
  const Density density;
  Start start;  // empty: continues the motion

 private:
  void add(Estimator& est, std::int64_t i, bool at_front) override {
    const Control value = start ? start(knots.timeOfControl(i, order)) : continued(i, at_front);
    const auto id = est.insertRV(value, name + "[" + std::to_string(i) + "]");
    at_front ? ids.push_front(id) : ids.push_back(id);
  }
  void remove(Estimator& est, bool at_front) override {
    est.removeRV(at_front ? ids.front() : ids.back());
    at_front ? ids.pop_front() : ids.pop_back();
  }
  AnyVarID end(bool at_front) const override { return at_front ? ids.front() : ids.back(); }

  AnyMeasID tie(Estimator& est, std::int64_t i, std::int64_t step) const override {
    if constexpr (is_process<Segment>) {
      const std::int64_t first = std::min(i, i + step);
      const typename Segment::Prior prior(knots[first + 1] - knots[first], density);
      return est.insertMeasurement(prior, at(first), at(first + 1), Covariance(prior.covariance()),
                                   named(name + " prior"));
    } else {
      return tieEnd(est, i, step);
    }
  }
  AnyMeasID tieEnd(Estimator& est, std::int64_t i, std::int64_t step) const {
    return est.insertMeasurement(continuation(i, step), at(i), at(i + step), at(i + 2 * step),
                                 StandardDeviation(changes()), named(name + " continues"));
  }

  const VarID<Control>& at(std::int64_t i) const { return ids[static_cast<std::size_t>(i - first_)]; }
  /// Returns how the motion continues to control point i from i + step and i + 2 step.
  Continues continuation(std::int64_t i, std::int64_t step) const {
    const double t = knots.timeOfControl(i, order), near = knots.timeOfControl(i + step, order),
                 far = knots.timeOfControl(i + 2 * step, order);
    return {(t - near) / (near - far)};
  }
  /// Returns the value of a new control point beyond an end.
  Control continued(std::int64_t i, bool at_front) const {
    if (ids.empty()) return Control();
    const std::int64_t step = at_front ? 1 : -1;
    if constexpr (is_process<Segment>) {
      return predicted(*at(i + step), knots[i] - knots[i + step]);
    } else {
      if (ids.size() == 1) return *ids.front();
      return continuation(i, step).continued(*at(i + step), *at(i + 2 * step));
    }
  }
  /// Returns 3 times the RMS change of the motion between the control points, in each component.
  mtk::tangent_t<Control> changes() const {
    constexpr double kFactor = 3;
    using Tangent = mtk::tangent_t<Control>;
    Tangent squares = Tangent::Zero(), steps = Tangent::Zero();
    for (std::int64_t i = first_; i < first_ + count(); ++i) {
      if (i > first_) steps += mtk::difference(*at(i), *at(i - 1)).cwiseAbs2();
      if (i > first_ + 1) squares += continuation(i, -1)(*at(i), *at(i - 1), *at(i - 2)).cwiseAbs2();
    }
    const double all = steps.maxCoeff();
    for (Eigen::Index k = 0; k < squares.size(); ++k) {
      // A component that has hardly changed so far may begin to.
      const double least = std::max(1e-6 * steps[k], 1e-12 * all);
      const double square = std::max(squares[k], least) / static_cast<double>(count());
      squares[k] = square > 0 ? kFactor * std::sqrt(square) : 1;
    }
    return squares;
  }
};

}  // namespace detail

/// A spline at a time that may depend on variables: an argument of slom::trajectory::insertMeasurement.
template <class Segment>
struct Place {
  std::shared_ptr<detail::ControlPoints<Segment>> spline;
  detail::Clock clock;
  bool is_constant;  ///< the time depends on no variable
};

/// What all splines have. A cheap handle: copies are handles of the same spline.
class SplineBase {
 public:
  /// Returns the knots.
  const Knots& knots() const { return state_->knots; }
  /// Returns the first time that is covered. It is later than lastTime() if there are no control points.
  double firstTime() const { return knots()[state_->firstSegment()]; }
  /// Returns the last time that is covered.
  double lastTime() const { return knots()[state_->lastSegment() + 1]; }
  /// Removes the control points at both ends on which no measurement depends. Keeps those of at least one segment.
  void trim(Estimator& est) { state_->trim(est); }
  /// Gives the N - 1 outermost control points at each end a weak measurement that the motion continues: the change of
  /// the motion is 0 with 3 times the RMS change between all control points as standard deviation. Data determine these
  /// control points less than the others, for N = 6 by a factor of up to 120. A second call renews the measurements
  /// with the present values. Does nothing for less than 4
  /// control points, and for a GaussianProcess, whose prior determines them.
  void tieEnds(Estimator& est) { state_->tieEnds(est, true); }
  /// Returns whether a measurement of this spline has a time outside its segment, on this or another spline.
  bool isLeft() const;
  /// Inserts such measurements again, on the segments of their times, and extends splines where needed. A measurement
  /// moves by at most 256 segments. If any has moved, also by the `follow` of another spline, trims this spline and
  /// ties its ends. Returns the number of measurements that moved now.
  int follow(Estimator& est);

 protected:
  explicit SplineBase(std::shared_ptr<detail::SplineState> state) : state_(std::move(state)) {}

  std::shared_ptr<detail::SplineState> state_;
};

/// A spline with segments of this kind: VectorSegment, RotationSegment, PoseSegment or ScrewSegment.
template <class Segment>
class Spline : public SplineBase {
 protected:
  using State = detail::ControlPoints<Segment>;

  explicit Spline(std::shared_ptr<State> state) : SplineBase(std::move(state)) {}

 public:
  using Control = typename Segment::Control;

  /// Creates a spline without control points. `name` is for messages: the control points are `name[i]`.
  Spline(Knots knots, std::string name)
    requires(!detail::is_process<Segment>)
      : SplineBase(std::make_shared<State>(std::move(knots), std::move(name))) {}

  /// Adds the control points that the times between `from` and `to` lack, as variables. Their start values continue the
  /// motion of the nearest control points; the first are Control(). Throws [slom.bad-time], also if `to` is before
  /// `from`.
  void extend(Estimator& est, double from, double to) { extend(est, from, to, {}); }
  /// Adds control points with the start values start(t), a function of their times that returns a Control.
  void extend(Estimator& est, double from, double to, const std::function<Control(double)>& start) {
    struct Forget {
      State& state;
      ~Forget() { state.start = nullptr; }
    } const forget{state()};
    state().start = start;
    state().cover(est, from, to);
  }

  /// Returns the segment that contains a covered time, at the present values: `spline.segmentAt(t).poseAt(t)`. Throws
  /// [slom.bad-time] or [slom.uncovered-time].
  Segment segmentAt(double t) const { return state().segment(state().coveredSegment(t)); }
  /// Returns the control points in the order of their times.
  const std::deque<VarID<Control>>& controls() const { return state().ids; }

  /// Returns the spline around a constant time, for insertMeasurement.
  Place<Segment> around(double t) const {
    return {shared(), [t] { return t; }, true};
  }
  /// Returns the spline around the time t + offset, a variable.
  template <class Offset>
  Place<Segment> around(double t, const VarID<Offset>& offset) const {
    return {shared(), [t, offset] { return t + static_cast<double>(*offset); }, false};
  }
  /// Returns the spline around a time that is any function of variables, evaluated at their present values:
  /// `spline.around([=] { return stamp + row * *line_delay; })`.
  Place<Segment> around(std::function<double()> time) const { return {shared(), std::move(time), false}; }

 private:
  State& state() const { return static_cast<State&>(*state_); }
  std::shared_ptr<State> shared() const { return std::static_pointer_cast<State>(state_); }
};

/// A spline in R^D.
template <int D, int N>
using VectorSpline = Spline<VectorSegment<D, N>>;
/// A spline on SO(3).
template <int N>
using RotationSpline = Spline<RotationSegment<N>>;
/// A spline of positions and one of orientations with common knots: the usual trajectory.
template <int N>
using PoseSpline = Spline<PoseSegment<N>>;
/// A spline on SE(3).
template <int N>
using ScrewSpline = Spline<ScrewSegment<N>>;

}  // namespace slom::trajectory
