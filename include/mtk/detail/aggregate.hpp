/// Members of a plain aggregate: their number, references to them and, if the compiler reports them, their names.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "mtk/detail/cpp20.hpp"

namespace mtk::detail {

inline constexpr std::size_t kMaxAggregateMembers = 20;

/// A type that converts to anything except T and its bases, so that `T{AnyMember<T>{}, ...}` counts members.
template <class T>
struct AnyMember {
  template <class U>
    requires(!std::is_base_of_v<U, T>)
  constexpr operator U() const noexcept;  // NOLINT(google-explicit-constructor): that is its purpose
};

template <class T, std::size_t... I>
constexpr bool bracesAccept(std::index_sequence<I...>) {
  return requires { T{(static_cast<void>(I), AnyMember<T>{})...}; };
}

/// Returns the number of members of the aggregate T; 0 if T is empty or cannot be decomposed.
template <class T, std::size_t N = kMaxAggregateMembers>
constexpr std::size_t memberCount() {
  if constexpr (N == 0) {
    return 0;
  } else if constexpr (bracesAccept<T>(std::make_index_sequence<N>{})) {
    return N;
  } else {
    return memberCount<T, N - 1>();
  }
}

/// Returns whether T{Before members, {}, Behind members} compiles.
template <class T, std::size_t... Before, std::size_t... Behind>
constexpr bool emptyBracesFit(std::index_sequence<Before...>, std::index_sequence<Behind...>) {
  return requires {
    T{(static_cast<void>(Before), AnyMember<T>{})..., {}, (static_cast<void>(Behind), AnyMember<T>{})...};
  };
}
/// Returns whether the aggregate has an array member T[N], N > 1. The entries of such an array count as members, and
/// one pair of empty braces initialises all of them.
template <class T>
constexpr bool hasArrayMember() {
  constexpr std::size_t n = memberCount<T>();
  return []<std::size_t... I>(std::index_sequence<I...>) {
    return ((emptyBracesFit<T>(std::make_index_sequence<I>{}, std::index_sequence<>{}) &&
             !emptyBracesFit<T>(std::make_index_sequence<I>{}, std::make_index_sequence<n - 1 - I>{})) ||
            ...);
  }(std::make_index_sequence<n>{});
}

/// Returns references to the members of `x`, in order of declaration. T may be const.
template <class T>
constexpr auto tieMembers(T& x) {
  constexpr std::size_t n = memberCount<std::remove_const_t<T>>();
  static_assert(n >= 1 && n <= kMaxAggregateMembers);
#define MTK_TIE(count, ...)       \
  if constexpr (n == (count)) {   \
    auto& [__VA_ARGS__] = x;      \
    return std::tie(__VA_ARGS__); \
  } else  // NOLINT(readability-else-after-return)
  MTK_TIE(1, a)
  MTK_TIE(2, a, b)
  MTK_TIE(3, a, b, c)
  MTK_TIE(4, a, b, c, d)
  MTK_TIE(5, a, b, c, d, e)
  MTK_TIE(6, a, b, c, d, e, f)
  MTK_TIE(7, a, b, c, d, e, f, g)
  MTK_TIE(8, a, b, c, d, e, f, g, h)
  MTK_TIE(9, a, b, c, d, e, f, g, h, i)
  MTK_TIE(10, a, b, c, d, e, f, g, h, i, j)
  MTK_TIE(11, a, b, c, d, e, f, g, h, i, j, k)
  MTK_TIE(12, a, b, c, d, e, f, g, h, i, j, k, l)
  MTK_TIE(13, a, b, c, d, e, f, g, h, i, j, k, l, m)
  MTK_TIE(14, a, b, c, d, e, f, g, h, i, j, k, l, m, o)
  MTK_TIE(15, a, b, c, d, e, f, g, h, i, j, k, l, m, o, p)
  MTK_TIE(16, a, b, c, d, e, f, g, h, i, j, k, l, m, o, p, q)
  MTK_TIE(17, a, b, c, d, e, f, g, h, i, j, k, l, m, o, p, q, r)
  MTK_TIE(18, a, b, c, d, e, f, g, h, i, j, k, l, m, o, p, q, r, s)
  MTK_TIE(19, a, b, c, d, e, f, g, h, i, j, k, l, m, o, p, q, r, s, t)
  MTK_TIE(20, a, b, c, d, e, f, g, h, i, j, k, l, m, o, p, q, r, s, t, u)
  static_assert(n <= kMaxAggregateMembers);
#undef MTK_TIE
}

template <class T>
using MemberTuple = decltype(tieMembers(std::declval<T&>()));

// Names of members. Some compilers print the address of a subobject of an external object with the member's name.
#if defined(__GNUC__) && !defined(__clang__)
#define MTK_HAS_MEMBER_NAMES 1
#else
#define MTK_HAS_MEMBER_NAMES 0
#endif

#if MTK_HAS_MEMBER_NAMES
template <class T>
struct NameHolder {
  T value;
};
template <class T>
extern const NameHolder<T> name_holder;  // declared only: addresses are taken, nothing is read

template <class T, std::size_t I>
constexpr auto memberAddress() {
  return &std::get<I>(tieMembers(name_holder<T>.value));
}
template <auto Address>
constexpr std::string_view addressName() {
  std::string_view text =
      __PRETTY_FUNCTION__;  // "... [with auto Address = (& ...::member); std::string_view = ...]"
  text = text.substr(0, text.rfind("; std::string_view"));
  text = text.substr(0, text.rfind(')'));
  text = text.substr(text.rfind(':') + 1);
  return text;
}
#endif

/// Returns the names of the members of the aggregate T; "0", "1", ... with compilers that do not report them.
template <class T>
constexpr auto memberNames() {
  return []<std::size_t... I>(std::index_sequence<I...>) {
#if MTK_HAS_MEMBER_NAMES
    return std::array<std::string_view, sizeof...(I)>{addressName<memberAddress<T, I>()>()...};
#else
    constexpr std::string_view numbers[] = {"0",  "1",  "2",  "3",  "4",  "5",  "6",  "7",  "8",  "9",
                                            "10", "11", "12", "13", "14", "15", "16", "17", "18", "19"};
    return std::array<std::string_view, sizeof...(I)>{numbers[I]...};
#endif
  }(std::make_index_sequence<memberCount<T>()>{});
}

}  // namespace mtk::detail
