/// Variables over another number type, made part by part. Values are lifted to that type, seeded with derivatives by
/// their degrees of freedom, or gathered from several measurements into packs.
#pragma once

#include <array>
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include <Eigen/Core>

#include "mtk/detail/lanes.hpp"
#include "mtk/detail/state.hpp"
#include "mtk/detail/transpose.hpp"
#include "mtk/manifold.hpp"
#include "mtk/pack.hpp"
#include "mtk/types/seed.hpp"
#include "mtk/types/trafo.hpp"
#include "mtk/types/vect.hpp"

namespace mtk::detail {

template <class M>
concept Compound = NamedCompound<M> || AggregateOfManifolds<M>;
template <class T>
concept StdArray = is_std_array<T>;

/// Returns references to the members of a compound.
template <class M>
auto membersOf(M& x) {
  if constexpr (NamedCompound<std::remove_const_t<M>>) {
    return std::remove_const_t<M>::mtkMembers(x);
  } else {
    return tieMembers(x);
  }
}

/// Calls f(y_part, x_part, offset) for each basic part; offsets count degrees of freedom.
template <class Y, class X, class F>
void forEachBasicPart(Y& y, const X& x, int offset, const F& f) {
  if constexpr (Compound<X>) {
    auto to = membersOf(y);
    auto from = membersOf(x);
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      const auto one = [&](auto& part_y, const auto& part_x) {
        forEachBasicPart(part_y, part_x, offset, f);
        offset += dof(part_x);
      };
      (one(std::get<I>(to), std::get<I>(from)), ...);
    }(std::make_index_sequence<std::tuple_size_v<decltype(from)>>{});
  } else if constexpr (StdArray<X>) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      forEachBasicPart(y[i], x[i], offset, f);
      offset += dof(x[i]);
    }
  } else {
    f(y, x, offset);
  }
}

/// Sets y := x for a basic part whose type holds x without loss.
template <class Y, class X>
void liftPart(Y& y, const X& x) {
  if constexpr (requires { y = Y(x); }) {
    y = Y(x);
  } else {
    auto& to = stateOf(y);
    const auto& from = stateOf(x);
    if constexpr (EigenState<X>) {
      using D = std::remove_cvref_t<decltype(to[0])>;
      to.resize(from.rows(), from.cols());
      for (Eigen::Index i = 0; i < from.size(); ++i) to.data()[i] = D(from.data()[i]);
    } else {
      to = from;
    }
  }
}

/// Sets y := x, moved by the unknowns `offset` ... of a window of `width` columns. Degrees of freedom outside the
/// window stay fixed.
template <class Y, class X>
void seedPart(Y& y, const X& x, int offset, int width) {
  const auto column = [&](int i) { return offset + i < width ? offset + i : -1; };
  if constexpr (requires { state_t<Y>::seed(y, x, column); }) {
    state_t<Y>::seed(y, x, column);
  } else if constexpr (AddsToState<X>) {
    auto& state = stateOf(y);
    const auto& value = stateOf(x);
    if constexpr (EigenState<X>) {
      if constexpr (DOF_v<X> == Dynamic) state.resize(value.size());
      if constexpr (DOF_v<X> != Dynamic && DOF_v<X> <= 32) {
        [&]<int... I>(std::integer_sequence<int, I...>) {
          (state[I].seed(value[I], column(I)), ...);
        }(std::make_integer_sequence<int, DOF_v<X>>{});
      } else {
        for (int i = 0; i < static_cast<int>(value.size()); ++i) state[i].seed(value[i], column(i));
      }
    } else {
      state.seed(value, column(0));
    }
  } else {  // any other type, such as the user's own: by its [+]
    liftPart(y, x);
    PlainVector<scalar_t<Y>, DOF_v<X>> d(dof(x));
    for (int i = 0; i < dof(x); ++i) d[i].seed(0.0, column(i));
    boxplus<Y>(y, d);
  }
}

/// Returns x as a Y whose degrees of freedom are the unknowns offset, offset + 1, ... of a window of `width` columns.
/// Constructs the result in place, so nothing is set twice.
template <class Y, class X>
Y seededAs(const X& x, int offset, int width) {
  if constexpr (is_seed_rotation<Y> || requires { Y(x).values(); }) {
    return Y(x);
  } else if constexpr (is_trafo<Y> && !std::is_aggregate_v<Y>) {
    return Y(seededAs<decltype(Y::orient)>(x.orient, offset + X::DIM, width),
             seededAs<decltype(Y::pos)>(x.pos, offset, width));
  } else if constexpr (Compound<X> && std::is_aggregate_v<Y>) {
    const auto from = membersOf(x);
    using To = decltype(membersOf(std::declval<Y&>()));
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      int next = offset;
      const auto begin = [&](int dofs) { return std::exchange(next, next + dofs); };
      return Y{seededAs<std::remove_cvref_t<std::tuple_element_t<I, To>>>(
          std::get<I>(from), begin(dof(std::get<I>(from))), width)...};
    }(std::make_index_sequence<std::tuple_size_v<To>>{});
  } else if constexpr (std::is_constructible_v<Y, Uninitialized> && EigenState<X>) {
    Y y{Uninitialized()};
    seedPart(y, x, offset, width);
    return y;
  } else {
    Y y{};
    forEachBasicPart(y, x, offset, [width](auto& part_y, const auto& part_x, int at) {
      seedPart(part_y, part_x, at, width);
    });
    return y;
  }
}

// Code written out for each lane.
template <class X, std::size_t W, std::size_t... Lane>
std::array<const double*, W> dataOf(const std::array<const X*, W>& x, std::index_sequence<Lane...>) {
  return {stateOf(*x[Lane]).data()...};
}
template <std::size_t Member, class P, class X, std::size_t W, std::size_t... Lane>
std::array<const P*, W> membersAt(const std::array<const X*, W>& x, std::index_sequence<Lane...>) {
  return {&std::get<Member>(membersOf(*x[Lane]))...};
}

/// Fills the basic part y over packs; lane k comes from x[k], one measurement for each lane.
template <class Y, class X, std::size_t W>
void gatherPart(Y& y, const std::array<const X*, W>& x) {
  auto& to = stateOf(y);
  constexpr int width = static_cast<int>(W);
  using Number = Pack<width>;
  const auto from = [&](int lane) -> const auto& { return stateOf(*x[static_cast<std::size_t>(lane)]); };
  if constexpr (EigenState<X>) {
    constexpr int size = std::remove_cvref_t<decltype(from(0))>::SizeAtCompileTime;
    interleave<size>(dataOf(x, std::make_index_sequence<W>{}), &to.data()->lanes);
  } else {
    to = Number(Number::Numbers::generate(from));
  }
}
template <class Y, class X, std::size_t W>
void gatherParts(Y& y, const std::array<const X*, W>& x) {
  if constexpr (Compound<X>) {
    auto to = membersOf(y);
    using Members = decltype(membersOf(*x[0]));
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      const auto one = [&]<std::size_t J>(std::integral_constant<std::size_t, J>) {
        using P = std::remove_cvref_t<std::tuple_element_t<J, Members>>;
        gatherParts(std::get<J>(to), membersAt<J, P>(x, std::make_index_sequence<W>{}));
      };
      (one(std::integral_constant<std::size_t, I>{}), ...);
    }(std::make_index_sequence<std::tuple_size_v<Members>>{});
  } else if constexpr (StdArray<X>) {
    for (std::size_t i = 0; i < y.size(); ++i) {
      std::array<const typename X::value_type*, W> parts;
      for (std::size_t lane = 0; lane < W; ++lane) parts[lane] = &(*x[lane])[i];
      gatherParts(y[i], parts);
    }
  } else {
    gatherPart(y, x);
  }
}

}  // namespace mtk::detail
