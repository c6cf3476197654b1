/// Messages of values of one type to each process.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "distributed/bytes.hpp"
#include "slom/distributed/processes.hpp"

namespace slom::distributed {

/// Sends a list of values to each process and returns the lists from each. Pass lists that are not needed any more by
/// std::move, so that they are freed on the way.
/// If the counts of values from each are known, pass them by `counts_from`, which saves the messages with the counts.
template <class T>
std::vector<std::vector<T>> exchanged(const Processes& processes, std::vector<std::vector<T>> to_each,
                                      std::vector<std::size_t> counts_from = {}) {
  std::vector<std::string> bytes;
  for (std::vector<T>& values : to_each) {
    bytes.emplace_back(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    values = {};
  }
  for (std::size_t& count : counts_from) count *= sizeof(T);
  std::vector<std::vector<T>> from_each;
  std::vector<std::string> received = counts_from.empty() ? processes.exchange(std::move(bytes))
                                                          : processes.exchange(std::move(bytes), counts_from);
  for (std::string& text : received) {
    from_each.push_back(valuesOf<T>(text));
    text = {};
  }
  return from_each;
}

/// Returns the lists of all processes, one after another.
template <class T>
std::vector<T> gathered(const Processes& processes, const std::vector<T>& own) {
  const std::string bytes(reinterpret_cast<const char*>(own.data()), own.size() * sizeof(T));
  std::vector<T> all;
  for (const std::string& text : processes.gather(bytes)) {
    const std::vector<T> values = valuesOf<T>(text);
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

}  // namespace slom::distributed
