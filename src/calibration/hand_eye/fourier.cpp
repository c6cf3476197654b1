#include "calibration/hand_eye/fourier.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <utility>

namespace slom::calibration {
namespace {

using Complex = std::complex<double>;

/// Transforms in place; the size is a power of 2. Source: Cooley and Tukey, 1965.
void transform(std::vector<Complex>& x) {
  const std::size_t n = x.size();
  for (std::size_t i = 1, j = 0; i < n; ++i) {  // order by reversed bits
    std::size_t bit = n >> 1;
    for (; (j & bit) != 0; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(x[i], x[j]);
  }
  for (std::size_t half = 1; half < n; half *= 2) {
    std::vector<Complex> turn(half);
    for (std::size_t k = 0; k < half; ++k)
      turn[k] = std::polar(1.0, -std::numbers::pi * double(k) / double(half));
    for (std::size_t i = 0; i < n; i += 2 * half) {
      for (std::size_t k = 0; k < half; ++k) {
        const Complex even = x[i + k], odd = turn[k] * x[i + k + half];
        x[i + k] = even + odd;
        x[i + k + half] = even - odd;
      }
    }
  }
}

}  // namespace

std::vector<double> crossCorrelation(const std::vector<double>& a, const std::vector<double>& b) {
  const std::size_t count = a.size() + b.size() - 1;
  std::size_t n = 1;
  while (n < count) n *= 2;
  std::vector<Complex> x(n), y(n);
  for (std::size_t i = 0; i < a.size(); ++i) x[a.size() - 1 - i] = a[i];
  for (std::size_t i = 0; i < b.size(); ++i) y[i] = b[i];
  transform(x);
  transform(y);
  for (std::size_t i = 0; i < n; ++i) x[i] = std::conj(x[i] * y[i]);  // the conjugate transforms back
  transform(x);
  std::vector<double> sums(count);
  for (std::size_t i = 0; i < count; ++i) sums[i] = x[i].real() / double(n);
  return sums;
}

}  // namespace slom::calibration
