/// Measurements on splines. The function gets a segment for each spline, then the other arguments:
///
///     const auto gyro = [](const auto& pose, const auto& offset, double stamp) {
///       return pose.angularVelocityAt(stamp + offset);
///     };
///     slom::trajectory::insertMeasurement(est, gyro, pose.around(stamp, offset), offset, stamp,
///                                         slom::measured(reading), slom::StandardDeviation(0.01));
///     slom::trajectory::optimize(est, {pose});
///
/// The segment's polynomials continue beyond its knots, so the function is smooth while the time moves. Between
/// iterations, `optimize` inserts measurements again whose times have moved to another segment.
#pragma once

#include <array>
#include <initializer_list>
#include <memory>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "slom/trajectory/spline.hpp"

namespace slom::trajectory {

/// A measurement on splines. Its handle changes whenever it moves to another segment.
class Placed {
 public:
  /// Refers to a measurement. Used by the library.
  explicit Placed(std::shared_ptr<const detail::MovingMeasurement> measurement)
      : measurement_(std::move(measurement)) {}
  /// Returns the present handle, for residuals and removal: `est.removeMeasurement(placed.id())`.
  const AnyMeasID& id() const { return measurement_->id; }

 private:
  std::shared_ptr<const detail::MovingMeasurement> measurement_;
};

namespace detail {

/// A function of segments as a function of control points. Segments: those of the leading arguments, over double.
template <class F, class... Segments>
struct OnSegments {
  F f;
  std::tuple<Blending<Segments::order>...> blendings;

  /// Position of the control points of segment k among the arguments.
  static constexpr std::size_t firstControl(std::size_t k) {
    const std::array<std::size_t, sizeof...(Segments)> orders{std::size_t{Segments::order}...};
    std::size_t sum = 0;
    for (std::size_t i = 0; i < k; ++i) sum += orders[i];
    return sum;
  }
  static constexpr std::size_t controls = (std::size_t{Segments::order} + ...);
  template <std::size_t K>
  using SegmentOf = std::tuple_element_t<K, std::tuple<Segments...>>;
  template <std::size_t K, class Arguments>
  using SegmentFor = typename SegmentOf<K>::template Over<
      mtk::scalar_t<std::remove_cvref_t<std::tuple_element_t<firstControl(K), Arguments>>>>;

  template <class Arguments, class K = std::index_sequence_for<Segments...>,
            class R = std::make_index_sequence<std::tuple_size_v<Arguments> - controls>>
  struct Passed;
  template <class Arguments, std::size_t... K, std::size_t... R>
  struct Passed<Arguments, std::index_sequence<K...>, std::index_sequence<R...>> {
    using type =
        std::tuple<const SegmentFor<K, Arguments>&..., std::tuple_element_t<controls + R, Arguments>...>;
    static auto call(const OnSegments& self, const Arguments& all) {
      return self.f(self.template segment<K>(all)..., std::get<controls + R>(all)...);
    }
  };
  template <std::size_t K, class Arguments>
  auto segment(const Arguments& all) const {
    using Result = SegmentFor<K, Arguments>;
    return [&]<std::size_t... J>(std::index_sequence<J...>) {
      return Result(std::get<K>(blendings), typename Result::Controls{std::get<firstControl(K) + J>(all)...});
    }(std::make_index_sequence<std::size_t{SegmentOf<K>::order}>());
  }

  template <class... A>
    requires(sizeof...(A) >= controls &&
             slom::detail::Call<F, typename Passed<std::tuple<const A&...>>::type>::is_possible)
  auto operator()(const A&... a) const {
    return Passed<std::tuple<const A&...>>::call(*this, std::tuple<const A&...>(a...));
  }
  template <class Y, class Z>
    requires requires(const Y& y, const Z& z) { F::residualFromDatum(y, z); }
  static auto residualFromDatum(const Y& y, const Z& z) {
    return F::residualFromDatum(y, z);
  }
};

/// Puts the function on segments and keeps slom::numeric around it.
template <class... Segments, class F>
auto onSegments(const F& f, const std::tuple<Blending<Segments::order>...>& blendings) {
  using On = OnSegments<typename slom::detail::Unwrapped<F>::type, Segments...>;
  if constexpr (slom::detail::is_numeric<F>) {
    return slom::detail::NumericFunction<On, decltype(f.how)>{On{f.f, blendings}, f.how};
  } else if constexpr (slom::detail::is_vectorized<F>) {  // segments do not exist in packs
    return On{f.f, blendings};
  } else {
    return On{f, blendings};
  }
}

template <class T>
inline constexpr bool is_place = false;
template <class Segment>
inline constexpr bool is_place<Place<Segment>> = true;

/// A label whose text is kept for later insertions.
struct KeptLabel {
  std::string label;
};
template <class T>
auto kept(const T& argument) {
  if constexpr (std::is_same_v<T, Named>) {
    return KeptLabel{std::string(argument.label)};
  } else {
    return slom::detail::plainValue(argument);
  }
}
template <class T>
const T& lent(const T& argument) {
  return argument;
}
inline Named lent(const KeptLabel& kept) { return {kept.label}; }

/// Returns the arguments with the name of the user's function as label, unless there is one.
template <class F, class... Kept>
auto withLabel(std::tuple<Kept...> arguments) {
  if constexpr ((std::is_same_v<Kept, KeptLabel> || ...)) {
    return arguments;
  } else {
    using Function = typename slom::detail::Unwrapped<F>::type;
    const std::string name = std::is_class_v<Function> ? typeName<Function>() : "function";
    return std::tuple_cat(std::move(arguments), std::tuple{KeptLabel{name}});
  }
}

/// A spline at a time. It does not keep the spline, whose list of measurements it is in.
template <class Segment>
struct WatchedPlace {
  std::weak_ptr<ControlPoints<Segment>> spline;
  Clock clock;

  explicit WatchedPlace(const Place<Segment>& place) : spline(place.spline), clock(place.clock) {}
};

/// A measurement with all that its insertion needs.
template <class F, class Arguments, class... Segments>
class MeasurementOnSegments final : public MovingMeasurement {
  using Numbers = std::array<std::int64_t, sizeof...(Segments)>;
  static constexpr auto indices = std::index_sequence_for<Segments...>{};

 public:
  /// Inserts the measurement. Throws [slom.uncovered-time], [slom.bad-time] or as Estimator::insertMeasurement does.
  MeasurementOnSegments(Estimator& est, F f, const std::tuple<Place<Segments>...>& places,
                        Arguments arguments)
      : f_(std::move(f)),
        places_(std::apply([](const auto&... place) { return std::tuple{WatchedPlace(place)...}; }, places)),
        arguments_(std::move(arguments)) {
    before_ = segments_ =
        eachPlace([](auto& spline, double t, std::int64_t) { return spline.coveredSegment(t); });
    id = insert(est, segments_);
  }

  bool exists() const override {
    return id.isValid() &&
           std::apply([](const auto&... place) { return (!place.spline.expired() && ...); }, places_);
  }
  bool isAway() const override {
    const Numbers is_outside = eachPlace([&](auto& spline, double t, std::int64_t present) {
      return spline.isOutside(t, present, returns_) ? 1 : 0;
    });
    return is_outside != Numbers{};
  }
  void place(Estimator& est) override {
    const Numbers next = eachPlace([&](auto& spline, double t, std::int64_t present) {
      const std::int64_t segment = spline.nextSegment(t, present);
      spline.cover(est, segment, segment, true);
      spline.has_changed = true;
      return segment;
    });
    const AnyMeasID inserted = insert(est, next);
    est.removeMeasurement(id);
    id = inserted;
    if (next == before_) ++returns_;
    before_ = segments_;
    segments_ = next;
  }

 private:
  /// Returns f(spline, time, segment) for each place.
  template <class G>
  Numbers eachPlace(const G& f) const {
    return [&]<std::size_t... K>(std::index_sequence<K...>) {
      return Numbers{f(*std::get<K>(places_).spline.lock(), std::get<K>(places_).clock(), segments_[K])...};
    }(indices);
  }
  AnyMeasID insert(Estimator& est, const Numbers& at) const {
    return [&]<std::size_t... K>(std::index_sequence<K...>) {
      const std::tuple splines{std::get<K>(places_).spline.lock()...};
      const auto function =
          onSegments<Segments...>(f_, {Blending<Segments::order>(std::get<K>(splines)->knots, at[K])...});
      return std::apply(
          [&](const auto&... argument) {
            return std::apply(
                [&](const auto&... control) {
                  return AnyMeasID(est.insertMeasurement(function, control..., lent(argument)...));
                },
                std::tuple_cat(std::get<K>(splines)->of(at[K])...));
          },
          arguments_);
    }(indices);
  }

  F f_;
  std::tuple<WatchedPlace<Segments>...> places_;
  Arguments arguments_;
  Numbers segments_{}, before_{};
  int returns_ = 0;  ///< how often it has moved back to where it came from
};

template <class F, class... Segments, class... Rest>
std::shared_ptr<MovingMeasurement> makeMeasurement(Estimator& est, F f,
                                                   const std::tuple<Place<Segments>...>& places,
                                                   const std::tuple<const Rest&...>& rest) {
  auto arguments =
      withLabel<F>(std::apply([](const auto&... argument) { return std::tuple{kept(argument)...}; }, rest));
  using Arguments = decltype(arguments);
  auto result = std::make_shared<MeasurementOnSegments<F, Arguments, Segments...>>(est, std::move(f), places,
                                                                                   std::move(arguments));
  std::apply(
      [&](const auto&... place) {
        if (!(place.is_constant && ...)) (place.spline->moving.push_back(result), ...);
      },
      places);
  return result;
}

}  // namespace detail

/// Adds a measurement f(segments..., others...). Arguments: first `spline.around(time)` for each spline, then
/// variables, data, slom::measured and options, as in Estimator::insertMeasurement. f gets a segment for each spline,
/// of the number type of the variables, so its parameters are `const auto&`; derivatives by control points and by times
/// are then exact. The measurement moves as long as handles of all its splines exist. Throws [slom.uncovered-time] if a
/// spline does not cover the present time, and as Estimator::insertMeasurement does.
template <class F, class... Args>
Placed insertMeasurement(Estimator& est, F f, const Args&... args) {
  constexpr std::size_t places = (std::size_t{detail::is_place<Args>} + ... + 0);
  constexpr std::array<bool, sizeof...(Args)> is_place{detail::is_place<Args>...};
  constexpr bool are_first = [&] {
    for (std::size_t i = 0; i < places; ++i) {
      if (!is_place[i]) return false;
    }
    return places > 0;
  }();
  static_assert(
      are_first,
      "slom: a measurement on splines starts with its splines: pass `spline.around(time)` for each right after "
      "the function");
  if constexpr (are_first) {
    const std::tuple<const Args&...> all(args...);
    return [&]<std::size_t... P, std::size_t... R>(std::index_sequence<P...>, std::index_sequence<R...>) {
      return Placed(
          detail::makeMeasurement(est, std::move(f), std::tuple{std::get<P>(all)...},
                                  std::tuple<const std::tuple_element_t<places + R, std::tuple<Args...>>&...>(
                                      std::get<places + R>(all)...)));
    }(std::make_index_sequence<places>(), std::make_index_sequence<sizeof...(Args) - places>());
  }
}

/// Fits, and inserts measurements again between iterations when their times have moved to another segment, until none
/// moves. `splines`: those of measurements with estimated times. Splines grow where times leave them. Control points at
/// their ends are removed if no measurement depends on them any more. The summary is that of the last fit, with the
/// iterations and seconds of all and the RSS at the start. Iterations in the trace and for the observer begin anew with
/// each fit. Throws as Estimator::optimize does.
Summary optimize(Estimator& est, std::initializer_list<SplineBase> splines, const Options& options = {});
Summary optimize(Estimator& est, const std::vector<SplineBase>& splines, const Options& options = {});

}  // namespace slom::trajectory
