/// Evaluation of a measurement function on several measurements at once. Their variables and data are gathered into
/// packs of numbers (mtk::Pack), the function runs once, and residuals and derivatives are scattered to their places.
/// Derivatives are dual numbers over packs (mtk::SparseDual). Their type says which unknowns a number depends on, so
/// the zeros of the chain rule cost nothing.
#pragma once

#include <algorithm>
#include <array>
#include <tuple>
#include <type_traits>
#include <utility>

#include "mtk/preaccumulation.hpp"
#include "mtk/rebind.hpp"
#include "slom/model/function.hpp"
#include "slom/model/indices.hpp"
#include "slom/model/measured.hpp"
#include "slom/model/prediction.hpp"
#include "slom/model/values.hpp"
#include "slom/model/var_id.hpp"

namespace slom {

namespace detail {

/// Returns the content of a stored argument, as the function gets it or the library subtracts it.
template <class A>
const A& contentOf(const A& datum) {
  return datum;
}
template <class T>
const T& contentOf(const VarArg<T>& variable) {
  return *variable;
}
template <class Z>
const Z& contentOf(const Measured<Z>& datum) {
  return datum.value;
}
template <class Stored>
using ContentOf = std::remove_cvref_t<decltype(contentOf(std::declval<const Stored&>()))>;

/// The number of unknowns that columns of packs can distinguish, without the columns that mtk::preaccumulate uses.
inline constexpr int kMostPackedColumns = mtk::detail::kFirstLocalColumn - 1;

/// Returns how many measurements are evaluated at once: the number of lanes of a register. If the derivatives
/// (`entries` of a Jacobian) do not fit into the registers, at most 4, which is faster.
constexpr int packWidth(int entries) {
  return entries <= 80 ? mtk::kPackWidth : std::min(mtk::kPackWidth, 4);
}

/// An argument as packs.
template <class Stored, int Width>
struct PackedArgument {
  using Numbers = mtk::Pack<Width>;
  static constexpr bool possible = !std::is_void_v<mtk::rebind_t<ContentOf<Stored>, Numbers>>;
  using Packed = std::conditional_t<possible, mtk::rebind_t<ContentOf<Stored>, Numbers>, std::tuple<>>;
  Packed value{};

  explicit PackedArgument(const std::array<const ContentOf<Stored>*, std::size_t{Width}>& x) {
    mtk::detail::gatherParts(value, x);
  }
  PackedArgument(const PackedArgument&) = delete;
};
/// An argument as packs with derivatives.
template <class Stored, int Width, int Offset>
struct SeededArgument {
  const typename PackedArgument<Stored, Width>::Packed& value;
  explicit SeededArgument(const PackedArgument<Stored, Width>& packed) : value(packed.value) {}
};
template <class T, int Width, int Offset>
struct SeededArgument<VarArg<T>, Width, Offset> {
  using Seeded = mtk::detail::sparse_rebind_t<T, mtk::Pack<Width>, Offset>;
  Seeded value;
  explicit SeededArgument(const PackedArgument<VarArg<T>, Width>& packed)
      : value(mtk::detail::seededAs<Seeded>(packed.value, Offset, 64)) {}
  SeededArgument(const SeededArgument&) = delete;
};

template <class... M>
constexpr bool arePackable(std::type_identity<std::tuple<M&...>>);
/// Returns whether values of T fill packs: T has a fixed size and consists of the library's types.
template <class T>
constexpr bool isPackable() {
  if constexpr (!mtk::Manifold<T> || std::is_void_v<mtk::rebind_t<T, mtk::Pack<mtk::kPackWidth>>>) {
    return false;
  } else if constexpr (mtk::detail::Compound<T>) {
    return arePackable(std::type_identity<decltype(mtk::detail::membersOf(std::declval<T&>()))>{});
  } else if constexpr (mtk::detail::StdArray<T>) {
    return isPackable<typename T::value_type>();
  } else {
    return mtk::DOF_v<T> != mtk::Dynamic && mtk::detail::HasState<T>;
  }
}
template <class... M>
constexpr bool arePackable(std::type_identity<std::tuple<M&...>>) {
  return (isPackable<M>() && ...);
}
/// Evaluates f for `width` sets of arguments. Rows and Columns: length of the residual, number of unknowns. The results
/// of one set are contiguous in r and J.
template <class F, int Rows, int Columns, class Offsets, class... Stored>
class PackEvaluation;

template <class F, int Rows, int Columns, int... Offset, class... Stored>
class PackEvaluation<F, Rows, Columns, std::integer_sequence<int, Offset...>, Stored...> {
  using Tuple = Values<Stored...>;

 public:
  static constexpr int width = packWidth(Rows * Columns);
  using Source = std::array<const Tuple*, std::size_t{width}>;

  SLOM_FLATTEN static void evaluate(const F& f, const Source& source, double* r) {
    const auto arguments = gather(source, std::index_sequence_for<Stored...>{});
    Lanes rows[std::size_t{Rows}];
    const auto sink = [&](int row, const auto& x) { rows[row] = Lanes(x); };
    write(predict(f, arguments, PassedIndices{}), sink, arguments);
    mtk::detail::deinterleave<Rows>(&rows->lanes, r, Rows);
  }

  SLOM_FLATTEN static void linearize(const F& f, const Source& source, double* r, double* J) {
    const auto arguments = gather(source, std::index_sequence_for<Stored...>{});
    Lanes rows[std::size_t{Rows}], partials[std::size_t{Rows * Columns}];
    const auto sink = [&](int row, const auto& x) {
      using X = std::remove_cvref_t<decltype(x)>;
      if constexpr (mtk::detail::is_dual<X>) {
        rows[row] = x.value();
        [&]<int... C>(std::integer_sequence<int, C...>) {
          ((partials[C * Rows + row] = mtk::detail::isIn(X::columns, C)
                                           ? x.partials().get(mtk::detail::placeIn(X::columns, C))
                                           : Lanes(0.0)),
           ...);
        }(std::make_integer_sequence<int, Columns>{});
      } else {
        rows[row] = Lanes(x);
        for (int c = 0; c < Columns; ++c) partials[c * Rows + row] = Lanes(0.0);
      }
    };
    const auto seeds = seed(arguments, std::index_sequence_for<Stored...>{});
    write(predict(f, seeds, PassedIndices{}), sink, arguments);
    mtk::detail::deinterleave<Rows>(&rows->lanes, r, Rows);
    mtk::detail::deinterleave<Rows * Columns>(&partials->lanes, J, Rows * Columns);
  }

 private:
  using Lanes = mtk::Pack<width>;
  using Arguments = Values<PackedArgument<Stored, width>...>;
  using PassedIndices = decltype(indicesWhere<!is_measured<Stored>...>());
  using DatumIndices = decltype(indicesWhere<is_measured<Stored>...>());

  template <std::size_t... I>
  static Arguments gather(const Source& source, std::index_sequence<I...>) {
    return {{PackedArgument<Stored, width>(
        contents<I, Stored>(source, std::make_index_sequence<std::size_t{width}>{}))}...};
  }
  /// Written out, because compilers turn a loop over pointers into gathering loads, which are slow.
  template <std::size_t I, class A, std::size_t... Lane>
  static std::array<const ContentOf<A>*, std::size_t{width}> contents(const Source& source,
                                                                      std::index_sequence<Lane...>) {
    return {&contentOf(valueAt<I, A>(*source[Lane]))...};
  }
  template <std::size_t... I>
  static Values<SeededArgument<Stored, width, Offset>...> seed(const Arguments& arguments,
                                                               std::index_sequence<I...>) {
    return {{SeededArgument<Stored, width, Offset>(valueAt<I>(arguments))}...};
  }
  template <class Packs, std::size_t... I>
  static auto predict(const F& f, const Packs& packs, std::index_sequence<I...>) {
    return call(f, valueAt<I>(packs).value...);
  }
  template <class Result, class Sink>
  static void write(const Result& result, const Sink& sink, const Arguments& arguments) {
    constexpr bool has_datum = DatumIndices::size() > 0;
    if constexpr (has_datum) {
      [&]<std::size_t... I>(std::index_sequence<I...>) {
        (eachResidual<F>(result, valueAt<I>(arguments).value, sink), ...);
      }(DatumIndices{});
    } else {
      eachRow(result, sink);
    }
  }
};

}  // namespace detail
}  // namespace slom
