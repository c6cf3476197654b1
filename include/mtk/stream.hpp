/// Streaming of manifolds: numbers separated by spaces, in the order of the members.
///   vect, Scalar   the coordinates (a dynamic vector: its size first)
///   SO2            the angle [rad]          SO3   x y z w of the unit quaternion
///   S2             the three coordinates    trafo pos, then orient
///   compounds      their members
/// With 17 digits (9 for float), reading returns the written value except for rounding. Reading sets failbit and leaves
/// the value unchanged if the text is not such a value, such as a quaternion or direction without unit length.
#pragma once

#include <array>
#include <istream>
#include <ostream>
#include <tuple>

#include "mtk/types/s2.hpp"
#include "mtk/types/scalar.hpp"
#include "mtk/types/so2.hpp"
#include "mtk/types/so3.hpp"
#include "mtk/types/trafo.hpp"
#include "mtk/types/vect.hpp"

namespace mtk {

template <Manifold M>
std::ostream& write(std::ostream& os, const M& x);
template <Manifold M>
std::istream& read(std::istream& is, M& x);

namespace detail {

template <class V>
std::ostream& writeCoordinates(std::ostream& os, const V& v) {
  for (Eigen::Index i = 0; i < v.size(); ++i) os << (i == 0 ? "" : " ") << v[i];
  return os;
}

template <class V>
bool readCoordinates(std::istream& is, V& v) {
  for (Eigen::Index i = 0; i < v.size(); ++i) is >> v[i];
  return bool(is);
}

/// Returns whether v has unit length, with tolerance for the rounding of a short decimal notation.
template <class V>
bool isNearlyUnit(std::istream& is, const V& v) {
  if (v.norm() > 0.999 && v.norm() < 1.001) return true;
  is.setstate(std::ios::failbit);
  return false;
}

template <class Tuple>
std::ostream& writeMembers(std::ostream& os, const Tuple& members) {
  std::apply(
      [&](const auto& first, const auto&... rest) {
        write(os, first);
        ((os << " ", write(os, rest)), ...);
      },
      members);
  return os;
}

template <class Tuple>
bool readMembers(std::istream& is, Tuple&& members) {
  std::apply([&](auto&... part) { (read(is, part), ...); }, members);
  return bool(is);
}

template <class M>
auto tieAny(M& x) {
  using Plain = std::remove_const_t<M>;
  if constexpr (NamedCompound<Plain>) {
    return Plain::mtkMembers(x);
  } else {
    return std::apply([](auto&... part) { return std::tie(part...); }, tieMembers(x));
  }
}

}  // namespace detail

template <int N, class S>
std::ostream& operator<<(std::ostream& os, const vect<N, S>& v) {
  if constexpr (N == Dynamic) os << v.size() << (v.size() > 0 ? " " : "");
  return detail::writeCoordinates(os, v);
}
template <int N, class S>
std::istream& operator>>(std::istream& is, vect<N, S>& v) {
  vect<N, S> read_in;
  if constexpr (N == Dynamic) {
    Eigen::Index size = 0;
    if (!(is >> size)) return is;
    if (size < 0 || size > 100'000'000) return is.setstate(std::ios::failbit), is;
    read_in = vect<N, S>(size);
  }
  if (detail::readCoordinates(is, read_in)) v = read_in;
  return is;
}

template <class S>
std::ostream& operator<<(std::ostream& os, const Scalar<S>& x) {
  return os << x.value();
}
template <class S>
std::istream& operator>>(std::istream& is, Scalar<S>& x) {
  S value;
  if (is >> value) x = Scalar<S>(value);
  return is;
}

template <class S>
std::ostream& operator<<(std::ostream& os, const SO2<S>& R) {
  return os << R.angle();
}
template <class S>
std::istream& operator>>(std::istream& is, SO2<S>& R) {
  S angle;
  if (is >> angle) R = SO2<S>(angle);
  return is;
}

template <class S>
std::ostream& operator<<(std::ostream& os, const SO3<S>& R) {
  return detail::writeCoordinates(os, R.coeffs());
}
template <class S>
std::istream& operator>>(std::istream& is, SO3<S>& R) {
  PlainVector<S, 4> q;
  if (detail::readCoordinates(is, q) && detail::isNearlyUnit(is, q)) R = SO3<S>(q[3], q[0], q[1], q[2]);
  return is;
}

template <class S>
std::ostream& operator<<(std::ostream& os, const S2<S>& v) {
  return detail::writeCoordinates(os, v.vector());
}
template <class S>
std::istream& operator>>(std::istream& is, S2<S>& v) {
  vect<3, S> read_in;
  if (detail::readCoordinates(is, read_in) && detail::isNearlyUnit(is, read_in)) v = S2<S>(read_in);
  return is;
}

template <class R>
std::ostream& operator<<(std::ostream& os, const trafo<R>& T) {
  return detail::writeMembers(os, std::tie(T.pos, T.orient));
}
template <class R>
std::istream& operator>>(std::istream& is, trafo<R>& T) {
  trafo<R> read_in;
  if (detail::readMembers(is, std::tie(read_in.pos, read_in.orient))) T = read_in;
  return is;
}

/// Returns whether M and all its parts have operator<<.
template <class M>
constexpr bool isWritable() {
  if constexpr (NamedCompound<M> || AggregateOfManifolds<M>) {
    return []<class... P>(std::type_identity<std::tuple<P...>>) {
      return (isWritable<std::remove_cvref_t<P>>() && ...);
    }(std::type_identity<decltype(detail::tieAny(std::declval<M&>()))>{});
  } else if constexpr (detail::is_std_array<M>) {
    return isWritable<typename M::value_type>();
  } else {
    return requires(std::ostream& os, const M& x) { os << x; };
  }
}

/// Writes any manifold, including plain aggregates, for which name look-up does not find `<<`.
template <Manifold M>
std::ostream& write(std::ostream& os, const M& x) {
  static_assert(isWritable<M>(), "mtk: to be written, this type or one of its parts needs an operator<<");
  if constexpr (NamedCompound<M> || AggregateOfManifolds<M>) {
    return detail::writeMembers(os, detail::tieAny(x));
  } else if constexpr (detail::is_std_array<M>) {
    return detail::writeMembers(os, std::apply([](const auto&... part) { return std::tie(part...); }, x));
  } else if constexpr (detail::IsEigenColumn<M> && !ManifoldByMembers<M>) {
    return os << vect<DOF_v<M>, scalar_t<M>>(x);
  } else {
    return os << x;
  }
}

/// Reads a value written by `write`; on failure `x` keeps its value.
template <Manifold M>
std::istream& read(std::istream& is, M& x) {
  if constexpr (NamedCompound<M> || AggregateOfManifolds<M>) {
    M read_in = x;
    if (detail::readMembers(is, detail::tieAny(read_in))) x = read_in;
  } else if constexpr (detail::is_std_array<M>) {
    M read_in = x;
    if (detail::readMembers(is, std::apply([](auto&... part) { return std::tie(part...); }, read_in)))
      x = read_in;
  } else if constexpr (detail::IsEigenColumn<M> && !ManifoldByMembers<M>) {
    vect<DOF_v<M>, scalar_t<M>> read_in;
    if (is >> read_in) x = read_in;
  } else {
    is >> x;
  }
  return is;
}

/// A wrapper for any manifold: `os << mtk::streamed(x)` and `is >> mtk::streamed(x)`.
template <class M>
struct Streamed {
  M& value;
  friend std::ostream& operator<<(std::ostream& os, const Streamed& s) { return write(os, s.value); }
  friend std::istream& operator>>(std::istream& is, const Streamed& s)
    requires(!std::is_const_v<M>)
  {
    return read(is, s.value);
  }
};
/// Returns a wrapper that stream operators can write and read: `os << mtk::streamed(x)`.
template <class M>
Streamed<M> streamed(M& x) {
  return {x};
}

}  // namespace mtk
