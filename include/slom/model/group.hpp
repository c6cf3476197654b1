/// Groups of measurements whose errors may be dependent, such as those of one image. A group is an option of
/// insertMeasurement.
///
///     est.insertMeasurement(f, pose, lens, slom::measured(z), slom::group("image", 17), slom::group("corner", 3));
///     const slom::Clustered c = slom::clustered(est, {.by = {"image"}});
///
/// Groups do not affect a fit, only its uncertainty if requested (slom/analyze/clustered.hpp).
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

/// The key of a group in a dimension. A dimension is the name of one way of grouping; the usual one has an empty name.
struct Group {
  std::string dimension;
  std::string text;         ///< the key, if it is a text
  std::int64_t number = 0;  ///< the key, if it is a number
  bool is_text = false;
};

/// Puts a measurement into the group with this key. Measurements in no group have independent errors, as stated.
inline Group group(std::integral auto key) { return {{}, {}, static_cast<std::int64_t>(key), false}; }
inline Group group(std::string_view key) { return {{}, std::string(key), 0, true}; }
/// Puts a measurement into a group of this dimension. A measurement may be in one group of each dimension.
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

/// Throws [slom.bad-group] if two groups have the same dimension.
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
