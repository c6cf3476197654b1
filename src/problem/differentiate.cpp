/// Derivatives of a measurement with respect to its variables: central differences in the tangent space.
///   J(:, c) = (f(x [+] h e_c) - f(x [+] -h e_c)) / 2h
/// The best step h of a component of typical size |x_c| (1 for angles) is about cbrt(eps * |x_c|) if the function bends
/// over lengths of order 1 (Nocedal and Wright, "Numerical optimization", 2006, section 8.1). The value of a component
/// near zero does not show its scale; there the step shrinks until two steps agree.
/// If x_c +- h leaves the bounds, differences of second order to one side:
///   J(:, c) = s (-3 f(x) + 4 f(x [+] s h e_c) - f(x [+] 2 s h e_c)) / 2h,  s = +-1
/// Extrapolated (Richardson): (4 D(h/2) - D(h)) / 3 of steps about eps^(1/5), with an error of order h^4.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "base/words.hpp"
#include "slom/problem/measurement_pool.hpp"

namespace slom {

namespace {

/// Width, relative to the argument, of the narrowest functions that extrapolated differences follow. Rounding leaves
/// half the digits.
constexpr double kNarrowest = 1e-9;
constexpr double kNoGap = std::numeric_limits<double>::infinity();

/// A guard that points a measurement's variable to a copy of its value. The copy can be moved.
class Redirected {
 public:
  Redirected(VariableArgument& variable, const VariableStoreBase& store)
      : variable_(variable), store_(store), original_(variable.pointer()) {
    if (store.valueSize() > sizeof(few_) || store.alignment() > kAlignment) {
      many_ = ::operator new(store.valueSize(), std::align_val_t(store.alignment()));
    }
    try {
      store_.construct(moved(), original_);
    } catch (...) {
      release();
      throw;
    }
    variable_.setPointer(moved());
  }
  Redirected(const Redirected&) = delete;
  Redirected& operator=(const Redirected&) = delete;
  ~Redirected() {
    variable_.setPointer(original_);
    store_.destroy(moved());
    release();
  }

  const void* original() const { return original_; }
  /// Sets the copy to the original value [+] d.
  void move(const double* d) {
    store_.assign(moved(), original_);
    store_.boxplus(moved(), d);
  }

 private:
  static constexpr std::size_t kAlignment = 64;

  void* moved() { return many_ != nullptr ? many_ : few_; }
  void release() {
    if (many_ != nullptr) ::operator delete(many_, std::align_val_t(store_.alignment()));
  }

  alignas(kAlignment) std::byte few_[512];  // storage for most values, without allocation
  void* many_ = nullptr;
  VariableArgument& variable_;
  const VariableStoreBase& store_;
  const void* original_;
};

/// Returns the largest |x_i|; NaN if any is NaN.
double largest(const double* x, int n) {
  double most = 0;
  for (int i = 0; i < n; ++i) {
    const double size = std::abs(x[i]);
    if (size > most || std::isnan(size)) most = size;
  }
  return most;
}

/// Central differences of one measurement by one variable. `evaluate(r)` returns the length of the residual.
template <class Evaluate>
class CentralDifferences {
 public:
  /// Prepares differences. `delta`: zeros, one for each component. `workspace`: 4 * rows numbers. `here`: the residual
  /// at the value itself.
  CentralDifferences(Redirected& variable, int rows, double* delta, double* workspace, const double* here,
                     Differences kind, const Evaluate& evaluate)
      : variable_(variable),
        rows_(rows),
        delta_(delta),
        plus_(workspace),
        minus_(plus_ + rows),
        coarse_(minus_ + rows),
        fine_(coarse_ + rows),
        here_(here),
        kind_(kind),
        evaluate_(evaluate) {}

  /// Sets the distances that the component may move down and up within its bounds.
  void setRoom(double down, double up) {
    down_ = down;
    up_ = up;
  }
  /// Computes the derivative along component c with steps of this length.
  int columnBy(int c, double step, double* out) { return difference(c, step, out); }
  /// Computes the derivative along component c of the given size. Returns the length of the residual; `out` is complete
  /// only if that length is the right one.
  int column(int c, double size, double* out) {
    constexpr double cube_root_of_epsilon = 6.0554544523933395e-06;
    if (kind_ == Differences::forward)
      return forward(c, cube_root_of_epsilon * std::cbrt(std::max(size, 1.0)), out);
    if (size >= 0.1 && kind_ == Differences::extrapolated) {
      return extrapolated(c, 7.4e-4 * std::max(size, 1.0), kNarrowest * std::max(size, 1.0), out);
    }
    if (size >= 0.1) return difference(c, cube_root_of_epsilon * std::cbrt(std::max(size, 1.0)), out);
    return refined(c, cube_root_of_epsilon, cube_root_of_epsilon * size, out);
  }

 private:
  int difference(int c, double h, double* out) {
    if (h > down_ || h > up_) return oneSided(c, h, out);
    if (const int got = shifted(c, h, plus_); got != rows_) return got;
    if (const int got = shifted(c, -h, minus_); got != rows_) return got;
    for (int i = 0; i < rows_; ++i) out[i] = (plus_[i] - minus_[i]) / (2 * h);
    return rows_;
  }

  int oneSided(int c, double h, double* out) {
    const double side = up_ >= down_ ? 1 : -1, room = std::max(up_, down_);
    h = side * std::min(h, room / 2);
    if (const int got = shifted(c, h, plus_); got != rows_) return got;
    if (const int got = shifted(c, 2 * h, minus_); got != rows_) return got;
    for (int i = 0; i < rows_; ++i) out[i] = (4 * plus_[i] - 3 * here_[i] - minus_[i]) / (2 * h);
    return rows_;
  }

  int forward(int c, double h, double* out) {
    if (h > up_) h = -std::min(h, down_);
    if (const int got = shifted(c, h, plus_); got != rows_) return got;
    for (int i = 0; i < rows_; ++i) out[i] = (plus_[i] - here_[i]) / h;
    return rows_;
  }

  /// Tries steps from `h` down to `smallest`, each a quarter of the last, until differences of several steps agree.
  /// Otherwise keeps the differences that agree best. A function may be narrow compared with its argument, such as
  /// sin(x) at 10^6 or sin(10^6 x) at 1. Differences over whole periods of it may agree by chance, so a third step must
  /// agree as well.
  int extrapolated(int c, double h, double smallest, double* best) {
    constexpr double agreeing = 1e-3;  // the error of the extrapolation is about the square of this
    for (double best_gap = kNoGap;; h = std::max(h / 4, smallest)) {
      if (const int got = difference(c, h, coarse_); got != rows_) return got;
      if (const int got = difference(c, h / 2, fine_); got != rows_) return got;
      double gap = relativeGap();
      if (!(gap >= best_gap)) {
        for (int i = 0; i < rows_; ++i) best[i] = (4 * fine_[i] - coarse_[i]) / 3;
      }
      if (gap <= agreeing) {
        if (const int got = difference(c, h / 5.3, coarse_); got != rows_) return got;
        gap = std::max(gap, relativeGap());
      }
      if (h <= smallest || gap <= agreeing) return rows_;
      if (!(gap >= best_gap)) best_gap = gap;
    }
  }
  /// Returns |fine - coarse| / |fine|; 0 for zeros.
  double relativeGap() {
    for (int i = 0; i < rows_; ++i) plus_[i] = fine_[i] - coarse_[i];
    const double gap = largest(plus_, rows_);
    return gap > 0 ? gap / largest(fine_, rows_) : gap;
  }

  int shifted(int c, double h, double* r) {
    delta_[c] = h;
    variable_.move(delta_);
    delta_[c] = 0;
    return evaluate_(r);
  }

  /// Tries steps from `h` down to `smallest`, each an eighth of the last. Keeps the one that agrees best with the step
  /// before it.
  int refined(int c, double h, double smallest, double* best) {
    if (const int got = difference(c, h, coarse_); got != rows_) return got;
    std::copy_n(coarse_, rows_, best);
    double best_gap = kNoGap;
    for (int worse = 0; worse < 2 && h > std::max(smallest, 1e-30);) {
      h /= 8;
      if (const int got = difference(c, h, fine_); got != rows_) return got;
      for (int i = 0; i < rows_; ++i) plus_[i] = fine_[i] - coarse_[i];
      const double gap = largest(plus_, rows_);  // a comparison with NaN counts as not better
      const bool agrees = gap <= 1e-8 * largest(fine_, rows_);
      if (gap < best_gap || !std::isfinite(largest(best, rows_))) {
        std::copy_n(best_gap == kNoGap && agrees ? coarse_ : fine_, rows_, best);
        best_gap = std::isfinite(gap) ? gap : best_gap;
        worse = 0;
      } else {
        ++worse;
      }
      if (agrees) break;
      std::swap(coarse_, fine_);
    }
    return rows_;
  }

  Redirected& variable_;
  int rows_;
  double* delta_;
  double *plus_, *minus_, *coarse_, *fine_;
  const double* here_;
  Differences kind_;
  const Evaluate& evaluate_;
  double down_ = kNoGap, up_ = kNoGap;
};

/// Returns the distances that component c at coordinate x may move down and up within its bounds.
std::pair<double, double> roomOf(const std::vector<ComponentBound>& bounds, int c, double x) {
  for (const ComponentBound& bound : bounds) {
    if (bound.component == c && bound.upper > bound.lower)
      return {std::max(0.0, x - bound.lower), std::max(0.0, bound.upper - x)};
  }
  return {kNoGap, kNoGap};
}

}  // namespace

DifferenceStep differences(double relative, std::vector<double> sizes) {
  const auto require = [](double number, const char* what) {
    if (number > 0 && std::isfinite(number)) return;
    throw Error(
        "slom.bad-option",
        std::string(what) + " of differences is " + slom::number(number, 6) + "; pass a positive number",
        "differences");
  };
  require(relative, "the step");
  for (const double size : sizes) require(size, "a typical size");
  return {relative, std::move(sizes)};
}

int MeasurementPool::differentiate(int i, int rows, double* r, double* J, Differences kind,
                                   const DifferenceStep* step) {
  if (const int got = evaluateOne(i, rows, r); got != rows) return got;
  const auto evaluate = [&](double* out) { return evaluateOne(i, rows, out); };
  std::size_t columns = 0;
  if (step != nullptr && !step->sizes.empty() && step->sizes.size() != at(this->columns(i))) {
    throw Error("slom.bad-option",
                std::to_string(step->sizes.size()) +
                    " typical sizes were passed to differences, but measurement " + measurementName(i) +
                    " has " + counted(this->columns(i), "component") +
                    " of its variables; pass one for each, or none",
                measurementName(i));
  }
  for (int k = 0; k < arity_; ++k) {
    const VariableRecord& record = table_[at(variables(i)[k])];
    const int dof = record.dof;
    if (active_.isOptimized(variables(i)[k])) {
      double few[128];
      const std::size_t needed = 2 * at(dof) + 4 * at(rows);
      std::vector<double> many(needed > std::size(few) ? needed : 0);
      double* const delta = many.empty() ? few : many.data();
      double* const sizes = delta + dof;
      std::fill_n(delta, dof, 0.0);
      Redirected variable(argument(i, k), *record.store);
      record.store->typicalSizesOf(variable.original(), sizes);
      CentralDifferences differences(variable, rows, delta, sizes + dof, r, kind, evaluate);
      const std::vector<ComponentBound>& bounds = active_.bounds(variables(i)[k]);
      std::vector<double> x(bounds.empty() ? 0 : at(dof));
      if (!x.empty()) record.store->coordinates(variable.original(), x.data());
      for (int c = 0; c < dof; ++c) {
        double* const column = J + static_cast<std::ptrdiff_t>(c) * rows;
        if (!x.empty()) {
          const auto [down, up] = roomOf(bounds, c, x[at(c)]);
          differences.setRoom(down, up);
        }
        const double size = step == nullptr || step->sizes.empty() ? sizes[c] : step->sizes[columns + at(c)];
        const int got = step != nullptr
                            ? differences.columnBy(c, step->relative * (size > 0 ? size : 1), column)
                            : differences.column(c, size, column);
        if (got != rows) return got;
      }
    }
    columns += at(dof);
    J += static_cast<std::ptrdiff_t>(rows) * dof;
  }
  return rows;
}

}  // namespace slom
