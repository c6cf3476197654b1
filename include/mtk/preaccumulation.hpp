/// preaccumulate: evaluates f(p) when p has few entries and many derivatives.
///
/// The derivatives with respect to the unknowns pass through the entries of p. For a long formula, such as a camera
/// model, it is cheaper to take the derivatives with respect to these entries first and to multiply them at the end by
/// the derivatives of p:
///     return mtk::preaccumulate(camera.pose * point, [&](const auto& p) { ...the camera model... });
/// The result is the same as that of calling the function with the point. There is a difference in time only for dual
/// numbers over packs.
#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include "mtk/dual.hpp"
#include "mtk/pack.hpp"
#include "mtk/types/seed.hpp"
#include "mtk/types/vect.hpp"

namespace mtk {

namespace detail {

/// The columns of the entries of p; unknowns never have such high numbers.
inline constexpr int kFirstLocalColumn = 61;
inline constexpr std::uint64_t kLocalColumns = lowColumns(3) << kFirstLocalColumn;

/// Returns y as a function of unknowns alone. y is a function of p's entries (the local columns) and of unknowns.
template <class S, std::uint64_t C, std::uint64_t P, int N>
auto withoutLocal(const SparseDual<S, C>& y, const vect<N, SparseDual<S, P>>& p) {
  if constexpr ((C & kLocalColumns) == 0) {
    return y;
  } else {
    constexpr std::uint64_t own = C & ~kLocalColumns, all = own | P;
    S by[std::size_t{N}];
    unrolled<N>([&](int j) { by[j] = y.partial(kFirstLocalColumn + j); });
    SparseDual<S, all> result;
    result.value() = y.value();
    [&]<int... I>(std::integer_sequence<int, I...>) {
      const auto one = [&](auto index) {
        constexpr int column = columnAt(all, index);
        S sum(0);
        if constexpr (isIn(P, column)) {
          sum = by[0] * p[0].partials().get(placeOf(P, column));
          for (int j = 1; j < N; ++j) sum += by[j] * p[j].partials().get(placeOf(P, column));
          if constexpr (isIn(own, column)) sum += y.partials().get(placeOf(C, column));
        } else {
          sum = y.partials().get(placeOf(C, column));
        }
        result.partials().set(index, sum);
      };
      (one(std::integral_constant<int, I>{}), ...);
    }(std::make_integer_sequence<int, countColumns(all)>{});
    return result;
  }
}

/// The values of p as separate unknowns.
template <int N, class S>
using LocalVector = SeedVector<N, S, kFirstLocalColumn>;

}  // namespace detail

/// Returns f(p), a vector or a number. p has up to 3 entries.
template <int N, class S, class F>
auto preaccumulate(const vect<N, S>& p, const F& f) {
  return f(p);
}
template <class D, class F>
auto preaccumulate(const Eigen::MatrixBase<D>& p, const F& f) {
  return f(p.derived());
}
template <int N, int W, std::uint64_t C, class F>
  requires(N <= 3 && detail::countColumns(C) > N)
auto preaccumulate(const vect<N, SparseDual<Pack<W>, C>>& p, const F& f) {
  vect<N, Pack<W>> values{Uninitialized()};
  detail::unrolled<N>([&](int i) { values[i] = p[i].value(); });
  const auto y = f(detail::LocalVector<N, Pack<W>>(values));
  if constexpr (requires { y.partials(); }) {
    return detail::withoutLocal(y, p);
  } else {
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      return vector(detail::withoutLocal(y.template get<I>(), p)...);
    }(std::make_index_sequence<static_cast<std::size_t>(
               std::remove_cvref_t<decltype(y)>::SizeAtCompileTime)>{});
  }
}

}  // namespace mtk
