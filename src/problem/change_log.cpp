#include "slom/problem/change_log.hpp"

#include <algorithm>
#include <new>

namespace slom {

template <class Event>
std::optional<std::span<const Event>> ChangeLog<Event>::since(std::uint64_t revision) const {
  if (revision < first_ || revision > this->revision()) return std::nullopt;
  return std::span<const Event>(events_).subspan(static_cast<std::size_t>(revision - first_));
}

template <class Event>
void ChangeLog<Event>::add(const Event& event, std::size_t size) noexcept {
  constexpr std::size_t fewest = 1024, share = 8;
  if (events_.size() >= std::max(fewest, size / share)) forget(events_.size() / 2);
  try {
    events_.push_back(event);
  } catch (const std::bad_alloc&) {
    forget(events_.size());
    ++first_;
  }
}

template <class Event>
void ChangeLog<Event>::forgetAll() noexcept {
  forget(events_.size());
  ++first_;
}

template <class Event>
void ChangeLog<Event>::forget(std::size_t count) noexcept {
  events_.erase(events_.begin(), events_.begin() + static_cast<std::ptrdiff_t>(count));
  first_ += count;
}

template class ChangeLog<Change>;
template class ChangeLog<int>;

}  // namespace slom
