/// The chain rule through few numbers: f(p) where p has many derivatives and few entries.
///
/// The derivatives of p by its unknowns pass through its entries. For long formulas (a camera model, say) it is cheaper to
/// take the derivatives by these entries first and to multiply them by those of p at the end:
///     return mtk::preaccumulate(camera.pose * point, [&](const auto& p) { ...the camera model... });
/// gives the same as calling the function with the point. It makes a difference for dual numbers over packs alone.
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

/// The columns that stand for the entries of p; unknowns never have such high numbers.
inline constexpr int kFirstLocalColumn = 61;
inline constexpr std::uint64_t kLocalColumns = lowColumns(3) << kFirstLocalColumn;

/// y, a function of p's entries (the local columns) and of unknowns, as a function of unknowns alone.
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

/// p's values as unknowns of their own.
template <int N, class S>
using LocalVector = SeedVector<N, S, kFirstLocalColumn>;

}  // namespace detail

/// f(p), a vector or a number. p: up to 3 entries.
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
