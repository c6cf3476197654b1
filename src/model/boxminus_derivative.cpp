#include "slom/model/boxminus_derivative.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace slom::detail {

namespace {

/// Returns (1 - t/2 cot(t/2)) / t^2, given t^2. The series serves small angles, where the closed form cancels. The
/// denominator of the closed form is not 0 at any angle up to pi.
double quadraticFactor(double square) {
  if (square < 0.09)
    return 1.0 / 12 +
           square * (1.0 / 720 + square * (1.0 / 30240 + square * (1.0 / 1209600 + square / 47900160)));
  const double half = std::sqrt(square) / 2;
  return (1 - half * std::cos(half) / std::sin(half)) / square;
}

}  // namespace

/// Writes D = I + [w]x / 2 + quadraticFactor(|w|^2) [w]x^2.
void writeBoxminusDerivative(const mtk::SO3<>& x, const mtk::SO3<>& y, double* D, int stride) {
  const mtk::vect<3> w = mtk::difference(x, y);
  const double square = w.squaredNorm(), factor = quadraticFactor(square);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      D[j * stride + i] =
          factor * w[i] * w[j] + (i == j ? 1 - factor * square : 0);  // [w]x^2 = w w^T - |w|^2
    const int next = (i + 1) % 3, last = (i + 2) % 3;
    D[next * stride + i] -= w[last] / 2;
    D[last * stride + i] += w[next] / 2;
  }
}

void writeBoxminusDerivative(const mtk::S2<>& x, const mtk::S2<>& y, double* D, int stride) {
  using Dual = mtk::Dual<double, 2>;
  using Direction = mtk::S2<Dual>;
  const auto moved = mtk::detail::seededAs<Direction>(x, 0, 2);
  const Direction origin = mtk::lifted<Dual>(y);
  mtk::PlainVector<Dual, 2> out;
  mtk::boxminus<Direction>(mtk::vectview<Dual, 2>(out.data(), 2), moved, origin);
  for (int i = 0; i < 2; ++i) {
    for (int c = 0; c < 2; ++c) D[c * stride + i] = out[i].partials().get(c);
  }
}

/// Writes Richardson's extrapolation of central differences with the steps h and h/2. Errors are of order h^4 and
/// epsilon / h.
void writeDifferences(const OwnPart& part, double* D, int stride) {
  const std::size_t n = static_cast<std::size_t>(part.dof);
  std::vector<double> d(n, 0.0), plus(n), minus(n);
  for (std::size_t c = 0; c < n; ++c) {
    double* const column = D + static_cast<std::ptrdiff_t>(c) * stride;
    std::fill_n(column, n, 0.0);
    const double h = 1e-3 * std::max(1.0, part.sizes[c]);
    for (const auto& [step, share] : {std::pair(h, -1.0 / 3), std::pair(h / 2, 4.0 / 3)}) {
      d[c] = step;
      part.difference(part.x, part.y, d.data(), plus.data());
      d[c] = -step;
      part.difference(part.x, part.y, d.data(), minus.data());
      for (std::size_t i = 0; i < n; ++i) column[i] += share * (plus[i] - minus[i]) / (2 * step);
    }
    d[c] = 0;
  }
}

}  // namespace slom::detail
