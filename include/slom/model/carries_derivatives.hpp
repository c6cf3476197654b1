/// Whether a function's result carries derivatives.
#pragma once

#include <type_traits>

#include "mtk/manifold.hpp"

namespace slom::detail {

/// Returns whether a function's result consists of dual numbers. A function that returns doubles for every input has no
/// derivatives.
template <class R>
constexpr bool carriesDerivatives() {
  if constexpr (mtk::detail::is_std_array<R>) {
    return carriesDerivatives<typename R::value_type>();
  } else if constexpr (mtk::Manifold<R>) {  // first, because R::Scalar of mtk::Scalar is its own name
    return mtk::detail::is_dual<mtk::scalar_t<R>>;
  } else if constexpr (requires { typename R::Scalar; }) {
    return mtk::detail::is_dual<typename R::Scalar>;
  } else {
    return requires(const R& x) { x.partials(); };
  }
}

}  // namespace slom::detail
