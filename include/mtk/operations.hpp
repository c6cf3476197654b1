/// The operations that work on every manifold: [+], [-], names of components, typical sizes. To be included by mtk/manifold.hpp, which
/// says which types are manifolds.
#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "mtk/scalar.hpp"
#include "mtk/vectview.hpp"

namespace mtk {

/// How M is a manifold; the primary template is for types that are none.
template <class M>
struct ManifoldTraits {
  static constexpr bool is_manifold = false;
};

/// A type whose points move by `boxplus` and differ by `boxminus`.
template <class M>
concept Manifold = ManifoldTraits<std::remove_cv_t<M>>::is_manifold;

/// Degrees of freedom of M, mtk::Dynamic when they are known only at run time.
template <Manifold M>
inline constexpr int DOF_v = ManifoldTraits<std::remove_cv_t<M>>::DOF;

template <Manifold M>
using scalar_t = typename ManifoldTraits<std::remove_cv_t<M>>::scalar;

/// Tangent vector of M: DOF_v<M> entries.
template <Manifold M>
using tangent_t = PlainVector<scalar_t<M>, DOF_v<M>>;

/// Degrees of freedom of this value.
template <Manifold M>
int dof(const M& x) {
  return ManifoldTraits<M>::dof(x);
}

/// x := x [+] scale * d, d of dof(x) entries.
template <Manifold M>
void boxplus(M& x, vectview<const scalar_t<M>, DOF_v<M>> d, scalar_t<M> scale = scalar_t<M>(1)) {
  ManifoldTraits<M>::boxplus(x, d, scale);
}

/// out := x [-] y, the tangent vector at y that moves y to x.
template <Manifold M>
void boxminus(vectview<scalar_t<M>, DOF_v<M>> out, const M& x, const M& y) {
  ManifoldTraits<M>::boxminus(out, x, y);
}

/// x [+] scale * d as a new value.
template <Manifold M>
M moved(M x, vectview<const scalar_t<M>, DOF_v<M>> d, scalar_t<M> scale = scalar_t<M>(1)) {
  ManifoldTraits<M>::boxplus(x, d, scale);
  return x;
}

/// x [-] y as a new vector.
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

/// Names of the components of x; `path` is put before each of them.
template <Manifold M>
std::vector<std::string> componentNames(const M& x, const std::string& path = "") {
  std::vector<std::string> names;
  visitComponentNames(x, path, [&](std::string name) { names.push_back(std::move(name)); });
  return names;
}

/// Size of the coordinate that each component moves: |x_i| of vectors, 1 for angles. Numerical derivatives
/// take their step widths from it. `out` has dof(x) entries.
template <Manifold M>
void typicalSizes(vectview<scalar_t<M>, DOF_v<M>> out, const M& x) {
  ManifoldTraits<M>::typicalSizes(out, x);
}

}  // namespace mtk
