/// Groups of measurements whose errors may be dependent, as those of one image: an option of insertMeasurement.
///
///     est.insertMeasurement(f, pose, lens, slom::measured(z), slom::group("image", 17), slom::group("corner", 3));
///     const slom::Clustered c = est.clustered({.by = {"image"}});
///
/// A fit does not depend on them; uncertainty can (slom/analyze/clustered.hpp).
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// The key of a group, in a dimension: the name of one way of grouping. Empty is the name of the usual one.
struct Group {
  std::string dimension;
  std::string text;         ///< the key, where it is a text
  std::int64_t number = 0;  ///< the key, where it is a number
  bool is_text = false;
};

/// Puts a measurement into the group with this key. Measurements without one have errors that are independent, as stated.
inline Group group(std::integral auto key) { return {{}, {}, static_cast<std::int64_t>(key), false}; }
inline Group group(std::string_view key) { return {{}, std::string(key), 0, true}; }
/// The same in a dimension of this name; a measurement may be in a group of each dimension.
inline Group group(std::string_view dimension, std::integral auto key) {
  return {std::string(dimension), {}, static_cast<std::int64_t>(key), false};
}
inline Group group(std::string_view dimension, std::string_view key) {
  return {std::string(dimension), std::string(key), 0, true};
}

namespace detail {

template <class T>
inline constexpr bool is_group = std::is_same_v<T, Group>;
template <class... T>
inline constexpr int group_count = (0 + ... + (is_group<T> ? 1 : 0));

/// Throws [slom.bad-group] where two are of one dimension.
void requireDistinctDimensions(const Group* groups, int count);

/// Several groups of one measurement.
template <int Count>
struct Groups {
  std::array<Group, static_cast<std::size_t>(Count)> all;
  int count = 0;

  void add(const Group& group) { all[static_cast<std::size_t>(count++)] = group; }
  template <class T>
  void add(const T&) {}
};

}  // namespace detail
}  // namespace slom
