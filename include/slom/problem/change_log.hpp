/// What has happened to a problem, in order, so that code that keeps something derived from it can follow in time proportional to what has changed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// An event that changes the structure of a problem.
struct Change {
  enum class Kind : std::uint8_t {
    variable_inserted,
    variable_removed,  ///< a variable inserted later may get its index
    variable_fixed,
    variable_freed,
    constraint,            ///< its fixed components or bounds
    measurement_inserted,  ///< the last one of its pool
    measurement_removed,   ///< the last one of its pool has taken its index
  };
  Kind kind;
  int index;      ///< index of the variable in the table, or of the measurement in its pool
  int pool = -1;  ///< pool of the measurement

  bool operator==(const Change&) const = default;
};

/// The latest events. There is a revision before the first event and one after each. A log forgets old events once it is longer than
/// what it says about is worth: then it is cheaper to look at everything.
template <class Event>
class ChangeLog {
 public:
  /// Grows by one with each event.
  std::uint64_t revision() const { return first_ + events_.size(); }

  /// The events after a revision, in order; none when they are forgotten: then anything may have changed. Valid until the next event.
  std::optional<std::span<const Event>> since(std::uint64_t revision) const;

  /// `size`: of all that the log is about. Without memory for the event all are forgotten.
  void add(const Event& event, std::size_t size) noexcept;

  /// A change that no event describes: there is no answer since any revision before it.
  void forgetAll() noexcept;

 private:
  void forget(std::size_t count) noexcept;

  std::vector<Event> events_;
  std::uint64_t first_ = 0;  // revision before the first of them
};

extern template class ChangeLog<Change>;
extern template class ChangeLog<int>;

}  // namespace slom
