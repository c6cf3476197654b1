/// Options after a measurement's variables and data at its insertion, in any order: noise, a robust loss, a name for
/// its group, groups of measurements that share errors.
#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "slom/model/group.hpp"
#include "slom/model/indices.hpp"
#include "slom/model/loss.hpp"
#include "slom/model/noise.hpp"
#include "slom/model/values.hpp"

namespace slom {

/// The label of a group of measurements; see `named`.
struct Named {
  std::string_view label;
};

/// Puts a measurement into the group with this name, for messages, reports and the summary. Without a label, the group
/// has the name of the measurement's type.
inline Named named(std::string_view label) { return {label}; }

namespace detail {

template <class T>
inline constexpr bool is_named = std::is_same_v<T, Named>;
template <class T>
inline constexpr bool is_option = IsNoise<T> || IsLoss<T> || is_named<T> || is_group<T>;

/// Returns the position of the only true entry; -1 if there is none, -2 if there are several.
template <class... T>
constexpr int findOnly(const std::array<bool, sizeof...(T)>& is) {
  int found = -1;
  for (int i = 0; i < static_cast<int>(is.size()); ++i) {
    if (is[static_cast<std::size_t>(i)]) found = found == -1 ? i : -2;
  }
  return found;
}

// g++ 12 cannot name the type of `all`, Values<const T&...>, in a signature.

/// Returns the noise among the arguments; unit covariance if there is none.
template <class... T, class All>
NoiseView noiseAmong(const All& all) {
  constexpr int found = findOnly<T...>({IsNoise<T>...});
  static_assert(found != -2,
                "slom: a measurement has one uncertainty: pass one of Covariance, StandardDeviation, "
                "InvCovariance and InvStandardDeviation");
  if constexpr (found >= 0) {
    return viewNoise(valueAt<static_cast<std::size_t>(found)>(all));
  } else {
    return {};
  }
}
/// Returns the loss among the arguments; no loss if there is none.
template <class... T, class All>
Loss lossAmong(const All& all) {
  constexpr int found = findOnly<T...>({IsLoss<T>...});
  static_assert(found != -2,
                "slom: a measurement has one loss: pass one of Huber, PseudoHuber, Cauchy, Tukey, "
                "GemanMcClure and Barron");
  if constexpr (found >= 0) {
    return valueAt<static_cast<std::size_t>(found)>(all);
  } else {
    return {};
  }
}
/// Returns the label among the arguments; empty if there is none.
template <class... T, class All>
std::string_view labelAmong(const All& all) {
  constexpr int found = findOnly<T...>({is_named<T>...});
  static_assert(found != -2, "slom: a measurement belongs to one group: pass slom::named once");
  if constexpr (found >= 0) {
    return valueAt<static_cast<std::size_t>(found)>(all).label;
  } else {
    return {};
  }
}

/// Returns the groups among the arguments. Throws [slom.bad-group].
template <class... T, class All>
auto groupsAmong(const All& all) {
  Groups<group_count<T...>> groups;
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (groups.add(valueAt<I>(all)), ...);
  }(std::index_sequence_for<T...>{});
  requireDistinctDimensions(groups.all.data(), groups.count);
  return groups;
}

/// Positions of the arguments that are not options.
template <class... Args>
using DataIndices = decltype(indicesWhere<!is_option<Args>...>());

}  // namespace detail
}  // namespace slom
