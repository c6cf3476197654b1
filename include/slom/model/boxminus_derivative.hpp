/// The derivative of (x [+] d) [-] y with respect to d, at d = 0.
///   numbers, vectors, SO2   the identity
///   SO3                     the inverse right Jacobian of w = x [-] y (Barfoot, "State estimation for robotics", 2017,
///                           eq. 7.76)
///   S2                      exact, by dual numbers
///   user-defined types      extrapolated differences, because their [-] need not accept dual numbers
#pragma once

#include "mtk/rebind.hpp"

namespace slom::detail {

// Functions compiled once. D is the first entry of the block, which lies in a column-major matrix with `stride` rows.

void writeBoxminusDerivative(const mtk::SO3<>& x, const mtk::SO3<>& y, double* D, int stride);
void writeBoxminusDerivative(const mtk::S2<>& x, const mtk::S2<>& y, double* D, int stride);

/// A part x of a user-defined type and y, without their type.
struct OwnPart {
  const void *x, *y;
  int dof;
  const double* sizes;  ///< typical sizes of the components of x
  /// Writes out := (x [+] d) [-] y.
  void (*difference)(const void* x, const void* y, const double* d, double* out);
};
void writeDifferences(const OwnPart& part, double* D, int stride);

/// Writes the block of one basic part. Before the call, the diagonal of D must be 1 and everything else 0.
template <class P>
void writePart(const P& x, const P& y, double* D, int stride) {
  if constexpr (requires { writeBoxminusDerivative(x, y, D, stride); }) {
    writeBoxminusDerivative(x, y, D, stride);
  } else if constexpr (!mtk::detail::AddsToState<P>) {
    mtk::tangent_t<P> sizes(mtk::dof(x));
    mtk::typicalSizes<P>(sizes, x);
    const auto difference = [](const void* from, const void* to, const double* d, double* out) {
      const P& origin = *static_cast<const P*>(to);
      P moved = *static_cast<const P*>(from);
      const int n = mtk::dof(moved);
      mtk::boxplus<P>(moved, mtk::vectview<const double, mtk::DOF_v<P>>(d, n));
      mtk::boxminus<P>(mtk::vectview<double, mtk::DOF_v<P>>(out, n), moved, origin);
    };
    writeDifferences({&x, &y, mtk::dof(x), sizes.data(), difference}, D, stride);
  }
}

}  // namespace slom::detail
