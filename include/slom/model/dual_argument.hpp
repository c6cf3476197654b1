/// Arguments of a callable for exact derivatives: the same types over dual numbers.
#pragma once

#include <type_traits>
#include <utility>

#include "mtk/rebind.hpp"
#include "slom/model/accepted_call.hpp"
#include "slom/model/carries_derivatives.hpp"
#include "slom/model/vectorized.hpp"

namespace slom {

namespace detail {

/// Sets J[c * stride] := d[c] for c < N.
template <int N, class Partials>
void storeStrided(const Partials& d, double* J, int stride) {
  [&]<int... C>(std::integer_sequence<int, C...>) {
    ((J[C * stride] = d.get(C)), ...);
  }(std::make_integer_sequence<int, N>{});
}

/// A stand-in for the number of a first unknown that is known only at run time.
inline constexpr int kRuntimeOffset = -1;

/// The function's argument for a stored one when derivatives are computed. Variables are over the dual number D.
template <class Stored, class D, int Offset>
struct DualArgument {
  const Stored& value;
  DualArgument(const Stored& datum, int) : value(datum) {}
};
template <class T, class D, int Offset>
struct DualArgument<VarArg<T>, D, Offset> {
  mtk::rebind_t<T, D> value;
  /// Seeds the variable. first: the number of its first unknown.
  DualArgument(const VarArg<T>& variable, int first)
      : value(mtk::detail::seededAs<mtk::rebind_t<T, D>>(*variable, Offset == kRuntimeOffset ? first : Offset,
                                                         D::size)) {}
  DualArgument(const DualArgument&) = delete;
};

template <class Stored, class D, int Offset>
const auto& contentOf(const DualArgument<Stored, D, Offset>& argument) {
  return argument.value;
}

template <class A>
inline constexpr int argument_dof = 0;
template <class T>
inline constexpr int argument_dof<VarArg<T>> = mtk::DOF_v<T>;
template <class A>
inline constexpr bool is_rebindable_argument = true;
template <class T>
inline constexpr bool is_rebindable_argument<VarArg<T>> = mtk::is_rebindable_v<T>;

template <class T>
constexpr bool hasFixedSize() {
  if constexpr (requires { T::SizeAtCompileTime; }) {
    return T::SizeAtCompileTime != mtk::Dynamic;
  } else if constexpr (mtk::Manifold<T>) {
    return mtk::DOF_v<T> != mtk::Dynamic;
  } else {
    return true;
  }
}

template <class A>
int runtimeDof(const A&) {
  return 0;
}
template <class T>
int runtimeDof(const VarArg<T>& variable) {
  return mtk::dof(*variable);
}

/// The function's argument for a DualArgument, without the class around it.
template <class Stored, class D>
struct DualPassed {
  using type = std::tuple<const Stored&>;
};
template <class T, class D>
struct DualPassed<VarArg<T>, D> {
  using type = std::tuple<const mtk::rebind_t<T, D>&>;
};
template <class Z, class D>
struct DualPassed<Measured<Z>, D> {
  using type = std::tuple<>;
};
/// Returns whether F accepts variables over the dual number D in place of doubles.
template <class F, class D, class... Stored>
constexpr bool acceptsDuals() {
  if constexpr ((is_rebindable_argument<Stored> && ...)) {
    using Passed = typename Join<typename DualPassed<Stored, D>::type...>::type;
    if constexpr (Call<F, Passed>::is_possible) {
      return carriesDerivatives<typename Call<F, Passed>::Result>();
    } else {
      return false;
    }
  } else {
    return false;
  }
}

}  // namespace detail

}  // namespace slom
