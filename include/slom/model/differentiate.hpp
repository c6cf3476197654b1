/// Derivatives of a measurement with respect to its variables: central differences in the tangent space.
///   J(:, c) = (f(x [+] h e_c) - f(x [+] -h e_c)) / 2h
/// The best step h of a component with magnitude |x_c| (1 for angles) is about cbrt(eps * |x_c|) where the function
/// bends over lengths of order 1 (Nocedal and Wright, "Numerical optimization", 2006, section 8.1). For components
/// near zero, whose scale the value does not tell, the step shrinks until two steps agree.
#pragma once

#include <cmath>
#include <limits>
#include <string>

#include "slom/model/measurement.hpp"

namespace slom {

namespace detail {
[[noreturn]] void raiseWrongLength(const std::string& subject, Eigen::Index expected, Eigen::Index got);
}

/// Evaluates into `ret`, which is filled with NaN before.
template <Measurement M>
void evaluatePoisoned(const M& measurement, Residual<M::residual_dim>& ret) {
  ret.setConstant(std::numeric_limits<double>::quiet_NaN());
  measurement.evaluate(ret);
}

namespace detail {

/// Points a measurement's variable to another value for as long as this object lives.
template <class T>
class Redirected {
 public:
  Redirected(VarArg<T>& variable, const T& value) : variable_(variable), original_(variable.pointer()) {
    variable_.setPointer(&value);
  }
  Redirected(const Redirected&) = delete;
  Redirected& operator=(const Redirected&) = delete;
  ~Redirected() { variable_.setPointer(original_); }

 private:
  VarArg<T>& variable_;
  const T* original_;
};

/// Central differences of one measurement along one component of one variable.
template <class M, class T>
class CentralDifference {
 public:
  using Column = Residual<M::residual_dim>;

  CentralDifference(M& measurement, VarArg<T>& variable, int rows)
      : measurement_(measurement), at_(*variable), moved_(at_), redirected_(variable, moved_), plus_(rows),
        minus_(rows), delta_(mtk::tangent_t<T>::Zero(mtk::dof(at_))), magnitudes_(mtk::dof(at_)) {
    mtk::magnitudes<T>(magnitudes_, at_);
  }

  int dof() const { return static_cast<int>(delta_.size()); }

  /// The derivative along component c.
  void column(int c, Column& out) {
    const double size = magnitudes_[c];
    constexpr double cube_root_of_epsilon = 6.0554544523933395e-06;
    if (size >= 0.1) {
      difference(c, cube_root_of_epsilon * std::cbrt(std::max(size, 1.0)), out);
    } else {
      refined(c, cube_root_of_epsilon, cube_root_of_epsilon * size, out);
    }
  }

 private:
  void difference(int c, double h, Column& out) {
    shifted(c, h, plus_);
    shifted(c, -h, minus_);
    out = (plus_ - minus_) / (2 * h);
  }

  void shifted(int c, double h, Column& ret) {
    moved_ = at_;
    delta_[c] = h;
    mtk::boxplus<T>(moved_, delta_);
    delta_[c] = 0;
    const Eigen::Index rows = ret.size();
    evaluatePoisoned(measurement_, ret);
    if (ret.size() != rows) raiseWrongLength("", rows, ret.size());
  }

  /// Steps from `h` down to `smallest`, each an eighth of the last; keeps the one that agrees best with the step before.
  void refined(int c, double h, double smallest, Column& best) {
    Column coarse(plus_.size()), fine(plus_.size());
    difference(c, h, coarse);
    best = coarse;
    double best_gap = std::numeric_limits<double>::infinity();
    for (int worse = 0; worse < 2 && h > std::max(smallest, 1e-30);) {
      h /= 8;
      difference(c, h, fine);
      const double gap = (fine - coarse).template lpNorm<Eigen::Infinity>();  // NaN compares as not better
      const bool agrees = gap <= 1e-8 * fine.template lpNorm<Eigen::Infinity>();
      if (gap < best_gap || !best.allFinite()) {
        best = best_gap == std::numeric_limits<double>::infinity() && agrees ? coarse : fine;
        best_gap = std::isfinite(gap) ? gap : best_gap;
        worse = 0;
      } else {
        ++worse;
      }
      if (agrees) return;
      coarse.swap(fine);
    }
  }

  M& measurement_;
  const T at_;
  T moved_;
  Redirected<T> redirected_;
  Column plus_, minus_;
  mtk::tangent_t<T> delta_, magnitudes_;
};

}  // namespace detail

/// Writes d f / d variable (rows x dof, column-major) to J. `variable` is one of the measurement's own VarArgs.
template <Measurement M, class T>
void differentiate(M& measurement, VarArg<T>& variable, int rows, double* J) {
  detail::CentralDifference<M, T> difference(measurement, variable, rows);
  Residual<M::residual_dim> column(rows);
  for (int c = 0; c < difference.dof(); ++c) {
    difference.column(c, column);
    std::copy(column.data(), column.data() + rows, J + static_cast<std::ptrdiff_t>(c) * rows);
  }
}

}  // namespace slom
