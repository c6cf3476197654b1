/// ChangeLog: the changes of a problem in order. Code that keeps results derived from the problem can update them in
/// time proportional to the changes.
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
    constraint,            ///< fixed components or bounds of a variable
    measurement_inserted,  ///< the new measurement is the last one of its pool
    measurement_removed,   ///< the last measurement of the pool has taken the index of the removed one
  };
  Kind kind;
  int index;      ///< index of the variable in the table, or of the measurement in its pool
  int pool = -1;  ///< pool of the measurement

  bool operator==(const Change&) const = default;
};

/// The latest events. There is a revision before the first event and one after each event. The log forgets old events
/// once following them would cost more than looking at everything.
template <class Event>
class ChangeLog {
 public:
  /// Returns the revision, which grows by one with each event.
  std::uint64_t revision() const { return first_ + events_.size(); }

  /// Returns the events after a revision, in order. Returns none if they are forgotten: then anything may have changed.
  /// Valid until the next event.
  std::optional<std::span<const Event>> since(std::uint64_t revision) const;

  /// Adds an event. `size`: the size of all that the log describes. If there is no memory for the event, all events are
  /// forgotten.
  void add(const Event& event, std::size_t size) noexcept;

  /// Records a change that no event describes. since() then has no answer for any earlier revision.
  void forgetAll() noexcept;

 private:
  void forget(std::size_t count) noexcept;

  std::vector<Event> events_;
  std::uint64_t first_ = 0;  // revision before the first event
};

extern template class ChangeLog<Change>;
extern template class ChangeLog<int>;

}  // namespace slom
