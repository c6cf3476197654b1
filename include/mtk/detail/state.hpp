/// Optional knowledge about a basic manifold besides [+] and [-]: a member MtkState of its class with
///   of(x)               the numbers that store x, an Eigen vector or one number
///   adds                true if [+] adds to these numbers; then there are as many as degrees of freedom
///   seed(y, x, column)  y := x, moved by the unknown column(i) in degree of freedom i; if this is faster than [+]
///   difference(x, z)    x [-] z, a number or a vector; if x and z may have different number types
/// Each of these is optional. A type without MtkState is moved and compared by its [+] and [-].
#pragma once

#include <Eigen/Core>

#include "mtk/scalar.hpp"

namespace mtk::detail {

struct NoState {};
struct NumberState {
  static constexpr bool adds = true;
  template <class S>
  static S& of(S& x) {
    return x;
  }
};
struct VectorState {
  static constexpr bool adds = true;
  template <class D>
  static D& of(Eigen::PlainObjectBase<D>& x) {
    return x.derived();
  }
};

template <class T>
struct StateOf {
  using type = NoState;
};
template <class T>
  requires is_scalar_v<T>
struct StateOf<T> {
  using type = NumberState;
};
template <class D>
void requireStored(const Eigen::PlainObjectBase<D>&);
template <class T>
  requires requires(T& x) { requireStored(x); }
struct StateOf<T> {
  using type = VectorState;
};
template <class T>
  requires requires { typename T::MtkState; }
struct StateOf<T> {
  using type = typename T::MtkState;
};
template <class T>
using state_t = typename StateOf<T>::type;

template <class T>
concept HasState = requires(T& x) { state_t<T>::of(x); };
/// A type whose [+] adds to its numbers.
template <class T>
concept AddsToState = HasState<T> && bool(state_t<T>::adds);
/// A type stored as an Eigen vector.
template <class T>
concept EigenState = requires(T& x) { state_t<T>::of(x).size(); };

template <class T>
decltype(auto) stateOf(T& x) {
  return state_t<T>::of(x);
}
template <class T>
const auto& stateOf(const T& x) {
  return state_t<T>::of(const_cast<T&>(x));
}

}  // namespace mtk::detail
