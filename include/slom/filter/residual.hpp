/// The residual of a measurement function, its length and its derivatives.
///   without datum         r = h(x, data...)
///   with slom::measured   r = h(x, data...) [-] z, or what the function's member `residualFromDatum` returns
/// In both forms r ~ N(0, R) at the true state.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "slom/filter/linearization.hpp"

namespace slom::detail {

/// The number type of a residual or prediction; void for manifolds and structs.
template <class R>
struct ResidualNumber {
  using type = std::conditional_t<std::is_arithmetic_v<R>, R, void>;
};
template <class R>
  requires requires { typename R::PlainObject; }
struct ResidualNumber<R> {
  using type = typename R::Scalar;
};
template <class T, std::size_t N>
struct ResidualNumber<std::array<T, N>> {
  using type = T;
};

/// The number of entries of a residual of type R, or Dynamic.
template <class R>
struct ResidualLength {
  static constexpr bool is_vector = requires { R::ColsAtCompileTime; };
  static_assert(
      std::is_arithmetic_v<R> || std::is_convertible_v<R, double> || is_vector,
      "slom: a measurement function must return a number, a std::array or a column vector; one that predicts "
      "another manifold value needs slom::measured(z) among the arguments");
  static constexpr int value = 1;
};
template <class R>
  requires requires { typename R::PlainObject; }
struct ResidualLength<R> {
  static_assert(
      requires(const R& x) { []<class D>(const Eigen::PlainObjectBase<D>&) {}(x); },
      "slom: the measurement function returns an unevaluated Eigen expression, which may refer to destroyed "
      "temporaries; return its value by .eval(), or give the function a return type");
  static_assert(R::ColsAtCompileTime == 1, "slom: a measurement function must return a column vector");
  static constexpr int value = R::RowsAtCompileTime;
};
template <class T, std::size_t N>
struct ResidualLength<std::array<T, N>> {
  static constexpr int value = static_cast<int>(N);
};

/// A measurement function with its datum (a pointer, or nullptr) and data.
template <class F, class State, class Datum, class... A>
class MeasurementFunction {
  using S = mtk::scalar_t<State>;
  using Value = std::remove_cvref_t<std::invoke_result_t<const F&, const State&, const A&...>>;
  static constexpr bool has_datum = !std::is_same_v<Datum, std::nullptr_t>;
  using Z =
      std::remove_cvref_t<decltype(*std::declval<std::conditional_t<has_datum, Datum, const State*>>())>;
  static constexpr int countRows() {
    if constexpr (has_datum) {
      static_assert(
          std::is_convertible_v<Value, Z>,
          "slom: with slom::measured(z) the measurement function must predict a value of the type of z");
      return mtk::DOF_v<Z>;
    } else {
      return ResidualLength<Value>::value;
    }
  }

  static_assert(
      !std::is_integral_v<typename ResidualNumber<Value>::type>,
      "slom: the measurement function of an update must return floating-point numbers; this one returns integers or bool, "
      "which round the residual so that it has no derivatives: compute with 1.0 and not 1");

 public:
  static constexpr int rows = countRows();
  static_assert(rows != mtk::Dynamic, "slom: a filter needs residuals of a size known at compile time");
  using Residual = mtk::PlainVector<S, rows>;
  using Jacobian = FixedMatrix<S, rows, mtk::DOF_v<State>>;

  MeasurementFunction(const F& f, const Datum& datum, const A&... data)
      : f_(f), datum_(datum), data_(data...) {}

  /// Returns the residual at x.
  Residual operator()(const State& x) const {
    Residual r;
    const auto sink = [&](int row, const auto& number) { r[row] = S(number); };
    const Value value = call(x);
    if constexpr (!has_datum) {
      eachRow(value, sink);
    } else if constexpr (requires(const Z& z) { F::residualFromDatum(z, z); }) {
      eachRow(F::residualFromDatum(value, *datum_), sink);
    } else {
      r = mtk::difference<Z>(value, *datum_);
    }
    return r;
  }
  /// Writes d r / d x at x.
  void differentiate(const State& x, Jacobian& J) const {
    using D =
        mtk::Dual<S, Jacobian::ColsAtCompileTime <= kMostFilterColumns ? Jacobian::ColsAtCompileTime : 16>;
    if constexpr (accepts_duals<F, D, std::tuple<State>, std::tuple<A...>>) {
      detail::differentiate(
          J, [&](const auto& dual) { return call(dual); },
          [&](const auto& result, const auto& sink) {
            if constexpr (has_datum) {
              eachResidual<F>(result, *datum_, sink);
            } else {
              eachRow(result, sink);
            }
          },
          x);
    } else {
      differentiateNumerically(J, *this, x);
    }
  }

 private:
  template <class X>
  auto call(const X& x) const {
    return std::apply([&](const auto&... data) { return f_(x, data...); }, data_);
  }

  const F& f_;
  Datum datum_;
  std::tuple<const A&...> data_;
};

}  // namespace slom::detail
