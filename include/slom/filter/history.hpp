/// FilterHistory: a filter that takes measurements late and in any order.
///
///     slom::FilterHistory<decltype(filter), 64> history(filter, start);
///     history.predict(t, [=](auto& f, double dt) { return f.predict(motion, slom::SpectralDensity(q), imu, slom::Duration(dt)); });
///     history.update(stamp, [=](auto& f) { return f.update(h, z, slom::StandardDeviation(0.1)); });   // stamp <= t
///     history.filter();                                                                              // at the newest time
///
/// The last steps are kept with the filter after each. A late measurement is inserted at its time: the prediction over
/// that time is divided in two, and the steps behind it are repeated. So the result is the same as with all
/// measurements in the order of their times, under these conditions:
///   noise     grows with the duration, as slom::SpectralDensity, slom::filter::strapdownNoise and slom::grownCovariance do;
///             slom::Covariance(Q) would count Q for each part, and does not compile
///   motion    right for any part of the duration: x + v t + a t^2 / 2 with a constant a, not x + v t with a new v
///   captures  by value, because a function is called again later, when the variables around it are gone
/// A measurement that its gate rejects is kept too. It is tried again when steps are repeated, because a late
/// measurement may make it acceptable, or another one unacceptable. All memory is in the object: Capacity times a
/// filter and Bytes. Each prediction and each update takes a place, a late update two: for 100 predictions and 5
/// updates per second and delays up to 0.5 s, 60 are enough.
///   source  the exact solution of Bar-Shalom, "Update with out-of-sequence measurements in tracking", 2002, section I
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "slom/filter/inline_function.hpp"
#include "slom/filter/options.hpp"
#include "slom/filter/status.hpp"

namespace slom {

namespace detail {

/// A filter whose predictions may be divided.
template <class Filter>
struct DivisibleFilter : Filter {
  explicit DivisibleFilter(const Filter& filter) : Filter(filter) {}

  template <class F, class... Args>
  PredictionResult predict(const F& f, const Args&... args) {
    constexpr bool grows = ((!is_motion_noise<Args> || grows_with_duration<Args>)&&...);
    static_assert(
        grows,
        "slom: a history divides predictions, so their noise must grow with the duration: pass slom::SpectralDensity(q), "
        "slom::noiseArgument<n>(slom::SpectralDensity(q)), slom::filter::strapdownNoise(imu, dt), or "
        "slom::grownCovariance(dt, q)");
    if constexpr (grows) {
      return Filter::predict(f, args...);
    } else {
      return {FilterStatus::bad_noise};  // does not compile
    }
  }
};

}  // namespace detail

/// Capacity: steps that are kept, with measurements that their gates rejected. Bytes: for what the function of a step captures.
template <class Filter, int Capacity = 64, std::size_t Bytes = 256>
class FilterHistory {
 public:
  /// Begins with a filter at a time [s].
  FilterHistory(const Filter& filter, double time) : start_(filter), start_time_(time) {}

  /// Returns the filter at the newest time.
  const Filter& filter() const { return newest(); }
  /// Returns the newest time [s].
  double time() const { return size_ == 0 ? start_time_ : entries_[std::size_t(size_ - 1)].time; }
  /// Returns the time from which on measurements are taken [s].
  double begin() const { return start_time_; }

  /// Predicts from the newest time to `time`: propagate(filter, duration), which must be right for any part of the
  /// duration, too. Returns its status; bad_duration if the time is not later.
  template <class P>
  FilterStatus predict(double time, const P& propagate) {
    if (!(time > this->time()) || !(time - time == 0)) return FilterStatus::bad_duration;
    return append({time, true,
                   Step([propagate](Divisible& f, double dt) { return statusOf(propagate(f, dt)); }),
                   newest()});
  }
  /// Updates at `time`, from begin() to time(): update(filter). Returns its status; too_old for other times.
  template <class U>
  FilterStatus update(double time, const U& update) {
    if (!(time >= start_time_ && time <= this->time())) return FilterStatus::too_old;
    const Step step([update](Divisible& f, double) { return statusOf(update(f)); });
    if (time == this->time()) return append({time, false, step, newest()});
    return insert(time, step);
  }

 private:
  using Divisible = detail::DivisibleFilter<Filter>;
  using Step = detail::InlineFunction<FilterStatus(Divisible&, double), Bytes + 2 * sizeof(void*)>;
  struct Entry {
    double time;
    bool is_prediction;
    Step step;
    Divisible after;
  };

  const Divisible& newest() const { return size_ == 0 ? start_ : entries_[std::size_t(size_ - 1)].after; }
  static FilterStatus statusOf(FilterStatus status) { return status; }
  template <class Result>
  static FilterStatus statusOf(const Result& result) {
    static_assert(
        requires { result.status; },
        "slom: a step of a history must return what predict or update of the filter returns: write `return "
        "f.update(...);`");
    return result.status;
  }

  /// A step that is refused is not kept, unless it is by its gate.
  static bool isKept(FilterStatus status) {
    return status == FilterStatus::done || status == FilterStatus::gated;
  }
  /// Takes a step at the newest time.
  FilterStatus append(Entry entry) {
    const FilterStatus status = entry.step(entry.after, entry.time - time());
    if (!isKept(status)) return status;
    if (size_ == Capacity) forget(1);
    place(size_++, entry);
    return status;
  }
  /// Inserts an update before the newest time and repeats the steps behind it. If it is refused, the filters stay.
  FilterStatus insert(double time, const Step& step) {
    int at = size_;
    while (at > 0 && entry(at - 1).time > time) --at;
    const double before = at == 0 ? start_time_ : entry(at - 1).time;
    Divisible there = at == 0 ? start_ : entry(at - 1).after;
    const bool divides = time > before;  // then the prediction at `at` passes this time
    const Step motion = divides ? entry(at).step : Step();
    if (divides) {
      const FilterStatus moved = motion(there, time - before);
      if (moved != FilterStatus::done) return moved;
    }
    Divisible updated = there;
    const FilterStatus status = step(updated, 0);
    if (!isKept(status)) return status;
    const int added = divides ? 2 : 1, surplus = size_ + added - Capacity;
    if (surplus > at) return FilterStatus::too_old;  // it would be forgotten at once
    if (surplus > 0) {
      forget(surplus);
      at -= surplus;
    }
    for (int i = size_ - 1; i >= at; --i) place(i + added, entry(i));
    size_ += added;
    if (divides) place(at++, {time, true, motion, there});
    place(at, {time, false, step, updated});
    if (status == FilterStatus::done) repeatFrom(at + 1);  // otherwise later filters stay to the last bit
    return status;
  }
  /// Repeats steps. An update that is refused now has no effect.
  void repeatFrom(int first) {
    for (int i = first; i < size_; ++i) {
      Entry& e = entry(i);
      e.after = entry(i - 1).after;
      static_cast<void>(e.step(e.after, e.time - entry(i - 1).time));
    }
  }
  void forget(int count) {
    start_ = entry(count - 1).after;
    start_time_ = entry(count - 1).time;
    for (int i = count; i < size_; ++i) place(i - count, entry(i));
    size_ -= count;
  }

  Entry& entry(int i) { return entries_[std::size_t(i)]; }
  void place(int i, const Entry& e) { entries_[std::size_t(i)] = e; }

  Divisible start_;
  double start_time_;
  std::array<Entry, std::size_t{Capacity}> entries_ =
      filled(std::make_index_sequence<std::size_t{Capacity}>());
  int size_ = 0;

  template <std::size_t... I>
  std::array<Entry, std::size_t{Capacity}> filled(std::index_sequence<I...>) const {
    return {((void)I, Entry{0, false, Step(), start_})...};
  }
};

}  // namespace slom
