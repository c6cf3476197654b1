/// Programs that compute the same results: checked against each other, then timed in turn.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace slom::bench {

/// Residuals and Jacobians of measurements of one kind, one after another.
struct Derivatives {
  Derivatives(int rows, int cols, int count)
      : rows(rows), cols(cols), count(count), r(size(rows * count)), J(size(rows * cols * count)) {}

  static std::size_t size(int n) { return static_cast<std::size_t>(n); }
  double* residual(int i) { return r.data() + size(rows * i); }
  double* jacobian(int i) { return J.data() + size(rows * cols * i); }

  int rows, cols, count;
  std::vector<double> r;
  std::vector<double> J;  ///< each rows x cols, column-major, in the tangent space of SLoM
};

/// One way to compute the derivatives.
struct Variant {
  std::string name;
  double tolerance = 0;                      ///< largest deviation from the reference, see `deviation`
  std::function<void()> pass;                ///< computes all results, keeps none; this is timed
  std::function<Derivatives()> derivatives;  ///< results of the computation
};

/// Makes the compiler assume that all memory is read and written here.
inline void keepMemory(const void* data) { asm volatile("" : : "g"(data) : "memory"); }

/// Returns a variant whose `kernel(i, r, J)` computes measurement i. As in SLoM, the results of 64 measurements are
/// contiguous.
template <int Rows, int Cols, class Kernel>
Variant kernelVariant(std::string name, int count, Kernel kernel) {
  constexpr int batch = 64;
  const auto pass = [count, kernel, r = std::vector<double>(Rows * batch),
                     J = std::vector<double>(Rows * Cols * batch)]() mutable {
    for (int first = 0; first < count; first += batch) {
      for (int i = first; i < first + batch && i < count; ++i) {
        kernel(i, r.data() + Rows * (i - first), J.data() + Rows * Cols * (i - first));
      }
      keepMemory(r.data());
      keepMemory(J.data());
    }
  };
  const auto derivatives = [count, kernel] {
    Derivatives all(Rows, Cols, count);
    for (int i = 0; i < count; ++i) kernel(i, all.residual(i), all.jacobian(i));
    return all;
  };
  return {std::move(name), 1e-9, pass, derivatives};
}

/// Returns the largest difference of a residual or of an entry of a Jacobian. It is relative to the largest value of
/// any measurement there (in this row of the residual, in this column of the Jacobian). NaN if a value is not finite.
double deviation(const Derivatives& x, const Derivatives& reference);

/// Quartiles of the time of one pass, divided by the number of measurements.
struct Timing {
  double lower_ns = 0, median_ns = 0, upper_ns = 0;
};

/// Times each variant `repetitions` times, in turn (A B C A B C ...). Each time is the mean over as many passes as fill
/// half a millisecond, after one pass that is not timed.
std::vector<Timing> timeInTurn(const std::vector<Variant>& variants, int count, int repetitions);

}  // namespace slom::bench
