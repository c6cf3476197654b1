/// Conversion of a callable's return value to a residual.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include <Eigen/Core>

#include "mtk/detail/cpp20.hpp"

namespace slom {

namespace detail {

/// The residual for a callable's return value of type R.
template <class R>
struct Returned {
  static_assert(
      std::is_convertible_v<R, double>,
      "slom: a measurement function must return a number, a std::array or an Eigen column vector of doubles; "
      "one that predicts another manifold value needs slom::measured(z) among the arguments");
  static_assert(
      !std::is_arithmetic_v<R> || std::is_same_v<R, double> || std::is_same_v<R, long double>,
      "slom: a measurement function must return double; this one returns float, an integer or bool, which rounds the "
      "residual so that it has no derivatives: compute with double, as in 1.0 and not 1 or 1.f");
  static constexpr int rows = 1;
  static int size(const R&) { return 1; }
  static void write(const R& value, double* r) { *r = static_cast<double>(value); }
};
template <class R>
  requires requires { typename R::PlainObject; }
struct Returned<R> {
  static_assert(
      requires(const R& x) { []<class D>(const Eigen::PlainObjectBase<D>&) {}(x); },
      "slom: the measurement function returns an unevaluated Eigen expression, which may refer to "
      "destroyed temporaries; return its value by .eval(), or give the function a return type");
  static_assert(R::ColsAtCompileTime == 1, "slom: a measurement function must return a column vector");
  static_assert(std::is_same_v<typename R::Scalar, double>,
                "slom: a measurement function must return a vector of doubles");
  static constexpr int rows = R::RowsAtCompileTime;
  static int size(const R& value) { return static_cast<int>(value.size()); }
  static void write(const R& value, double* r) {
    for (int i = 0; i < size(value); ++i) r[i] = value.data()[i];
  }
};
template <std::size_t N>
struct Returned<std::array<double, N>> {
  static constexpr int rows = static_cast<int>(N);
  static int size(const std::array<double, N>&) { return rows; }
  static void write(const std::array<double, N>& value, double* r) {
    for (std::size_t i = 0; i < N; ++i) r[i] = value[i];
  }
};

}  // namespace detail

}  // namespace slom
