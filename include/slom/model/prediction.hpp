/// Interpretation of a measurement function's result, row by row. The result is the residual itself, or the prediction
/// of a datum on any manifold. The residual is then f(Y) [-] z, unless f itself defines the comparison.
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "mtk/rebind.hpp"

namespace slom::detail {

/// Returns the number itself if x derives from one, as mtk::Scalar of dual numbers does.
template <class X>
const X& plainNumber(const X& x) {
  return x;
}
template <class S, std::uint64_t C>
const mtk::SparseDual<S, C>& plainNumber(const mtk::Scalar<mtk::SparseDual<S, C>>& x) {
  return x;
}

/// Returns the number of entries if the type states it, otherwise -1.
template <class V>
constexpr int sizeOf() {
  if constexpr (requires { V::SizeAtCompileTime; }) {
    return V::SizeAtCompileTime;
  } else {
    return -1;
  }
}
/// Calls f(i) for each entry i of v.
template <class V, class F>
void eachIndex(const V& v, const F& f) {
  mtk::detail::forEachEntry<sizeOf<V>()>(static_cast<Eigen::Index>(v.size()), f);
}

/// Calls sink(row, number) for each entry of a residual: a number, an Eigen vector or a std::array.
template <class R, class Sink>
void eachRow(const R& value, const Sink& sink) {
  if constexpr (requires { value.template get<0>(); }) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (sink(static_cast<int>(I), plainNumber(value.template get<I>())), ...);
    }(std::make_index_sequence<std::tuple_size_v<R>>{});
  } else if constexpr (requires {
                         value.size();
                         value[0];
                       }) {
    eachIndex(value, [&](int i) { sink(i, plainNumber(value[static_cast<decltype(value.size())>(i)])); });
  } else if constexpr (requires { value.partials(); } || mtk::is_scalar_v<R>) {
    sink(0, plainNumber(value));
  } else {
    sink(0, static_cast<double>(value));
  }
}

/// Calls sink(row, number) for each entry of x [-] z, counted from `row`. x is over dual numbers or packs, and its
/// parts may be over different ones. z is over plain numbers.
template <class X, class Z, class Sink>
void eachDifference(const X& x, const Z& z, int row, const Sink& sink) {
  const auto entries = [&](const auto& v) { eachIndex(v, [&](int i) { sink(row + i, v[i]); }); };
  if constexpr (mtk::detail::Compound<Z>) {
    const auto part_x = mtk::detail::membersOf(x);
    const auto part_z = mtk::detail::membersOf(z);
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      const auto one = [&](const auto& a, const auto& b) {
        eachDifference(a, b, row, sink);
        row += mtk::dof(b);
      };
      (one(std::get<I>(part_x), std::get<I>(part_z)), ...);
    }(std::make_index_sequence<std::tuple_size_v<decltype(part_z)>>{});
  } else if constexpr (mtk::detail::StdArray<Z>) {
    for (std::size_t i = 0; i < z.size(); ++i) {
      eachDifference(x[i], z[i], row, sink);
      row += mtk::dof(z[i]);
    }
  } else if constexpr (requires { mtk::detail::state_t<Z>::difference(x, z); }) {
    const auto difference = mtk::detail::state_t<Z>::difference(x, z);
    if constexpr (mtk::is_scalar_v<std::remove_cvref_t<decltype(difference)>>) {
      sink(row, difference);
    } else {
      entries(difference);
    }
  } else if constexpr (mtk::detail::EigenState<Z> && mtk::detail::AddsToState<Z>) {
    mtk::detail::requireSameSize(x, z, "x [-] y");
    eachIndex(x, [&](int i) { sink(row + i, x[i] - z[i]); });
  } else if constexpr (mtk::detail::AddsToState<Z>) {
    using N = std::remove_cvref_t<decltype(mtk::detail::stateOf(z))>;
    sink(row, x - static_cast<const N&>(mtk::detail::stateOf(z)));
  } else {  // the difference y [-] z
    using D = mtk::scalar_t<X>;
    mtk::PlainVector<D, mtk::DOF_v<X>> out(mtk::dof(x));
    mtk::boxminus<X>(out, x, mtk::lifted<D>(z));
    entries(out);
  }
}

/// Calls sink(row, number) for each entry of the residual of function F for the prediction y of the datum z. The
/// residual is y [-] z or, if F has the static member `residualFromDatum(y, z)`, the vector that it returns, of the
/// same length.
template <class F, class Y, class Z, class Sink>
void eachResidual(const Y& y, const Z& z, const Sink& sink) {
  if constexpr (requires { F::residualFromDatum(y, z); }) {
    eachRow(F::residualFromDatum(y, z), sink);
  } else {
    eachDifference(y, z, 0, sink);
  }
}

}  // namespace slom::detail
