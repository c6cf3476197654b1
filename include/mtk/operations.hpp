/// Operations of every manifold: [+], [-], names of components, typical sizes. mtk/manifold.hpp includes this header
/// and defines which types are manifolds.
#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "mtk/scalar.hpp"
#include "mtk/vectview.hpp"

namespace mtk {

/// The operations of M as a manifold. The primary template is for types that are not manifolds.
template <class M>
struct ManifoldTraits {
  static constexpr bool is_manifold = false;
};

/// A type whose points move by `boxplus` and whose differences `boxminus` gives.
template <class M>
concept Manifold = ManifoldTraits<std::remove_cv_t<M>>::is_manifold;

/// Degrees of freedom of M; mtk::Dynamic if they are known only at run time.
template <Manifold M>
inline constexpr int DOF_v = ManifoldTraits<std::remove_cv_t<M>>::DOF;

template <Manifold M>
using scalar_t = typename ManifoldTraits<std::remove_cv_t<M>>::scalar;

/// Tangent vector of M: DOF_v<M> entries.
template <Manifold M>
using tangent_t = PlainVector<scalar_t<M>, DOF_v<M>>;

/// Returns the degrees of freedom of this value.
template <Manifold M>
int dof(const M& x) {
  return ManifoldTraits<M>::dof(x);
}

/// Sets x := x [+] scale * d; d has dof(x) entries.
template <Manifold M>
void boxplus(M& x, vectview<const scalar_t<M>, DOF_v<M>> d, scalar_t<M> scale = scalar_t<M>(1)) {
  ManifoldTraits<M>::boxplus(x, d, scale);
}

/// Sets out := x [-] y, the tangent vector at y that moves y to x.
template <Manifold M>
void boxminus(vectview<scalar_t<M>, DOF_v<M>> out, const M& x, const M& y) {
  ManifoldTraits<M>::boxminus(out, x, y);
}

/// Returns x [+] scale * d.
template <Manifold M>
M moved(M x, vectview<const scalar_t<M>, DOF_v<M>> d, scalar_t<M> scale = scalar_t<M>(1)) {
  ManifoldTraits<M>::boxplus(x, d, scale);
  return x;
}

/// Returns x [-] y.
template <Manifold M>
tangent_t<M> difference(const M& x, const M& y) {
  tangent_t<M> out(dof(y));
  ManifoldTraits<M>::boxminus(out, x, y);
  return out;
}

/// Calls sink(path) for each of the dof(x) components of x in order: `left2right.pos.z`, `left.0`.
template <Manifold M, class Sink>
void visitComponentNames(const M& x, const std::string& path, Sink&& sink) {
  ManifoldTraits<M>::visitComponentNames(x, path, sink);
}

/// Returns the names of the components of x, each with `path` before it.
template <Manifold M>
std::vector<std::string> componentNames(const M& x, const std::string& path = "") {
  std::vector<std::string> names;
  visitComponentNames(x, path, [&](std::string name) { names.push_back(std::move(name)); });
  return names;
}

/// Writes the size of the coordinate that each component moves: |x_i| for vectors, 1 for angles. Numerical derivatives
/// derive their step widths from it. `out` has dof(x) entries.
template <Manifold M>
void typicalSizes(vectview<scalar_t<M>, DOF_v<M>> out, const M& x) {
  ManifoldTraits<M>::typicalSizes(out, x);
}

}  // namespace mtk
