/// Any callable as a measurement: its VarID arguments become variables, everything else is data stored by value.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "mtk/manifold.hpp"
#include "slom/model/measurement.hpp"
#include "slom/model/noise.hpp"

namespace slom {

/// A measured value of a manifold Z; see `measured`.
template <class Z>
struct Measured {
  Z value;
};

/// Marks the datum: the callable then predicts a Z, and the library forms the residual f(Y) [-] z.
template <class Z>
Measured<Z> measured(const Z& z) {
  mtk::requireManifold<Z>();
  return {z};
}

namespace detail {

/// How an argument of insertMeasurement is stored, and what the callable gets of it.
template <class A>
struct Argument {
  using Stored = A;
  using Passed = std::tuple<const A&>;
  static Passed pass(const Stored& a) { return std::tie(a); }
};
template <class T>
struct Argument<VarID<T>> {
  using Stored = VarArg<T>;
  using Passed = std::tuple<const T&>;
  static Passed pass(const Stored& a) { return std::tie(*a); }
};
template <class Z>
struct Argument<Measured<Z>> {
  using Stored = Measured<Z>;
  using Passed = std::tuple<>;
  static Passed pass(const Stored&) { return {}; }
};

template <class A>
inline constexpr bool is_var_id = false;
template <class T>
inline constexpr bool is_var_id<VarID<T>> = true;

template <class F, class Passed>
inline constexpr bool accepts = false;
template <class F, class... P>
inline constexpr bool accepts<F, std::tuple<P...>> = std::is_invocable_v<const F&, P...>;

/// The residual that a callable's return value stands for.
template <class R>
struct Returned {
  static_assert(std::is_convertible_v<R, double>,
                "slom: a measurement function must return a number, a std::array or an Eigen column vector of doubles; "
                "one that predicts another manifold value needs slom::measured(z) among the arguments");
  static constexpr int rows = 1;
  static void write(const R& value, Residual<1>& ret) { ret[0] = static_cast<double>(value); }
};
template <class R>
  requires requires { typename R::PlainObject; }
struct Returned<R> {
  static_assert(requires(const R& x) { []<class D>(const Eigen::PlainObjectBase<D>&) {}(x); },
                "slom: the measurement function returns an unevaluated Eigen expression, which may refer to temporaries "
                "that are gone; give it a return type, such as `-> Eigen::Vector2d`");
  static_assert(R::ColsAtCompileTime == 1, "slom: a measurement function must return a column vector");
  static constexpr int rows = R::RowsAtCompileTime;
  static void write(const R& value, Residual<rows>& ret) { ret = value; }
};
template <std::size_t N>
struct Returned<std::array<double, N>> {
  static constexpr int rows = static_cast<int>(N);
  static void write(const std::array<double, N>& value, Residual<rows>& ret) {
    for (std::size_t i = 0; i < N; ++i) ret[static_cast<Eigen::Index>(i)] = value[i];
  }
};

/// The datum z of `measured(z)` among the stored arguments, or a null pointer.
inline constexpr std::nullptr_t findDatum() { return nullptr; }
template <class First, class... Rest>
constexpr auto findDatum(const First& first, const Rest&... rest) {
  if constexpr (requires { []<class Z>(const Measured<Z>&) {}(first); }) {
    return &first.value;
  } else {
    return findDatum(rest...);
  }
}

}  // namespace detail

/// Holds a callable and its arguments; fulfils `Measurement`.
template <class F, class... Args>
class CallableMeasurement {
  template <class A>
  using Stored = typename detail::Argument<A>::Stored;
  using Passed = decltype(std::tuple_cat(std::declval<typename detail::Argument<Args>::Passed>()...));
  static_assert((detail::is_var_id<Args> || ...),
                "slom: a measurement needs at least one variable: pass the VarID that insertRV returned");
  static_assert(detail::accepts<F, Passed>,
                "slom: the measurement function does not accept these arguments: it gets `const T&` for each VarID<T> "
                "and `const D&` for each datum of type D, in the order of the call");
  using Value = std::remove_cvref_t<decltype(std::apply(std::declval<const F&>(), std::declval<Passed>()))>;
  using Datum = decltype(detail::findDatum(std::declval<const Stored<Args>&>()...));
  static constexpr bool has_datum = !std::is_same_v<Datum, std::nullptr_t>;

  static constexpr int rows() {
    if constexpr (has_datum) {
      using Z = std::remove_cvref_t<decltype(*std::declval<Datum>())>;
      static_assert(std::is_convertible_v<Value, Z>,
                    "slom: with slom::measured(z) the measurement function must predict a value of the type of z");
      return mtk::DOF_v<Z>;
    } else {
      return detail::Returned<Value>::rows;
    }
  }

 public:
  static constexpr int residual_dim = rows();
  /// What messages call measurements of this callable: its type, `lambda` or `function`.
  static std::string groupName() { return std::is_class_v<F> ? typeName<F>() : "function"; }

  explicit CallableMeasurement(F f, const Args&... args) : f_(std::move(f)), args_(Stored<Args>(args)...) {}

  auto variableArgs() {
    return std::apply([](auto&... stored) { return std::tuple_cat(tieVariable(stored)...); }, args_);
  }
  void evaluate(Residual<residual_dim>& ret) const {
    const auto predict = [&](const auto&... stored) -> Value {
      return std::apply(f_, std::tuple_cat(detail::Argument<Args>::pass(stored)...));
    };
    if constexpr (has_datum) {
      const auto* datum = std::apply([](const auto&... stored) { return detail::findDatum(stored...); }, args_);
      using Z = std::remove_cvref_t<decltype(*datum)>;
      ret = mtk::difference<Z>(std::apply(predict, args_), *datum);
    } else {
      detail::Returned<Value>::write(std::apply(predict, args_), ret);
    }
  }

 private:
  template <class T>
  static std::tuple<VarArg<T>&> tieVariable(VarArg<T>& variable) {
    return std::tie(variable);
  }
  template <class D>
  static std::tuple<> tieVariable(D&) {
    return {};
  }

  F f_;
  std::tuple<Stored<Args>...> args_;
};

}  // namespace slom
