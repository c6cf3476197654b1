/// Transport of an error state from one tangent space to another.
///
/// An error e about a point mu [+] d, seen in the tangent space of mu, is J e in the tangent space of the new mean
/// mu' = mu [+] d, to first order:
///   J = d ((mu [+] (d + e)) [-] mu') / d e,   at e = 0
/// J is block diagonal: the identity for numbers and vectors, the right Jacobian of d for a rotation.
/// A type with the member `keeps_covariance = true` keeps e as it is. Invariant errors do so (invariant.hpp).
///   source   He, Xu, Zhang, "Kalman filters on differentiable manifolds", 2021, section IV.B; for rotations Markley,
///            "Attitude error representations for Kalman filtering", 2003, and Mueller, Hehn, D'Andrea, "Covariance
///            correction step for Kalman filtering with an attitude", 2017
#pragma once

#include "slom/filter/linearization.hpp"

namespace slom::detail {

/// Writes the block of J of one part.
template <class P, class D>
auto transportOf(const P& mean, const P& new_mean, const D& d) {
  using S = mtk::scalar_t<P>;
  constexpr int n = mtk::DOF_v<P>;
  SquareMatrix<S, n> J;
  if constexpr (mtk::is_rebindable_v<P>) {
    using Dual = mtk::Dual<S, n>;
    auto moved = mtk::lifted<Dual>(mean);
    mtk::PlainVector<Dual, n> step;
    for (int i = 0; i < n; ++i) step[i].seed(d[i], i);
    mtk::boxplus<mtk::rebind_t<P, Dual>>(moved, step);
    eachDifference(moved, new_mean, 0,
                   [&](int row, const auto& number) { writePartials<n>(J, row, 0, number); });
  } else {
    mtk::vect<n, S> step;
    for (int i = 0; i < n; ++i) step[i] = d[i];
    differentiateNumerically(
        J, [&](const mtk::vect<n, S>& s) { return mtk::difference<P>(mtk::moved<P>(mean, s), new_mean); },
        step);
  }
  return J;
}

/// Calls apply(first component, J) for each part whose transport is not the identity.
template <class State, class Apply>
void forEachTransport(const State& mean, const State& new_mean, const mtk::tangent_t<State>& d,
                      const Apply& apply) {
  mtk::detail::forEachBasicPart(mean, new_mean, 0, [&](const auto& part, const auto& new_part, int at) {
    using P = std::remove_cvref_t<decltype(part)>;
    if constexpr (!mtk::detail::AddsToState<P> && !requires { P::keeps_covariance; }) {
      apply(at, transportOf(part, new_part, d.template segment<mtk::DOF_v<P>>(at)));
    }
  });
}

}  // namespace slom::detail
