/// Any callable as a measurement: its VarID arguments become variables, everything else is data stored by value.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "mtk/rebind.hpp"
#include "slom/model/function.hpp"
#include "slom/model/indices.hpp"
#include "slom/model/measurement.hpp"
#include "slom/model/noise.hpp"
#include "slom/model/prediction.hpp"
#include "slom/model/values.hpp"
#include "slom/model/vectorized.hpp"

namespace slom {

/// Marks the datum: the callable then predicts a Z, and the library forms the residual f(Y) [-] z.
template <class Z>
Measured<Z> measured(const Z& z) {
  mtk::requireManifold<Z>();
  if constexpr (requires { typename mtk::scalar_t<Z>; }) {
    static_assert(
        std::is_same_v<mtk::scalar_t<Z>, double>,
        "slom: what slom::measured marks must be made of doubles; this datum is made of float, integers or other numbers, which "
        "round the residual so that it has no derivatives");
  }
  return {z};
}

namespace detail {

/// How an argument of insertMeasurement is stored, and what the callable gets of it.
template <class A>
struct Argument {
  using Stored = A;
  using Passed = std::tuple<const A&>;
};
template <class T>
struct Argument<VarID<T>> {
  using Stored = VarArg<T>;
  using Passed = std::tuple<const T&>;
};
template <class Z>
struct Argument<Measured<Z>> {
  using Stored = Measured<Z>;
  using Passed = std::tuple<>;
};

template <class A>
inline constexpr bool is_var_id = false;
template <class T>
inline constexpr bool is_var_id<VarID<T>> = true;

/// The types of several tuples in a row.
template <class... Tuples>
struct Join;
template <class... A>
struct Join<std::tuple<A...>> {
  using type = std::tuple<A...>;
};
template <class... A, class... B, class... More>
struct Join<std::tuple<A...>, std::tuple<B...>, More...> : Join<std::tuple<A..., B...>, More...> {};

/// Whether F can be called with these arguments, and what it returns. Does not compile F's body where its return type is
/// written out.
template <class F, class Passed>
struct Call {
  static constexpr bool is_possible = false;
  using Result = double;
};
template <class F, class... P>
  requires requires(const F& f) { f(std::declval<P>()...); }
struct Call<F, std::tuple<P...>> {
  static constexpr bool is_possible = true;
  using Result = std::remove_cvref_t<decltype(std::declval<const F&>()(std::declval<P>()...))>;
};
template <class F, class... P>
  requires(std::is_member_pointer_v<F> && std::is_invocable_v<const F&, P...>)
struct Call<F, std::tuple<P...>> {
  static constexpr bool is_possible = true;
  using Result = std::remove_cvref_t<std::invoke_result_t<const F&, P...>>;
};

/// The parameters of a function that is no template.
template <class F>
struct Parameters {
  static constexpr bool known = false;
};
template <class... P>
struct ParameterList {
  static constexpr bool known = true;
  using type = std::tuple<P...>;
};
template <class R, class... P>
struct Parameters<R (*)(P...)> : ParameterList<P...> {};
template <class R, class... P>
struct Parameters<R (*)(P...) noexcept> : ParameterList<P...> {};
template <class R, class C, class... P>
struct Parameters<R (C::*)(P...) const> : ParameterList<P...> {};
template <class R, class C, class... P>
struct Parameters<R (C::*)(P...) const noexcept> : ParameterList<P...> {};
template <class F>
  requires requires { &F::operator(); }
struct Parameters<F> : Parameters<decltype(&F::operator())> {};

/// One line for the first argument that does not fit, with both types in the line that says where.
template <int Number, class Given, class Wanted>
constexpr void requireArgument() {
  constexpr bool fits = std::is_convertible_v<Given, Wanted>;
  static_assert(Number != 1 || fits,
                "slom: argument 1 of the measurement function is not of the type that it takes");
  static_assert(Number != 2 || fits,
                "slom: argument 2 of the measurement function is not of the type that it takes");
  static_assert(Number != 3 || fits,
                "slom: argument 3 of the measurement function is not of the type that it takes");
  static_assert(Number != 4 || fits,
                "slom: argument 4 of the measurement function is not of the type that it takes");
  static_assert(Number != 5 || fits,
                "slom: argument 5 of the measurement function is not of the type that it takes");
  static_assert(Number != 6 || fits,
                "slom: argument 6 of the measurement function is not of the type that it takes");
  static_assert(
      Number <= 6 || fits,
      "slom: an argument behind the 6th of the measurement function is not of the type that it takes");
}
/// Fails to compile, naming the argument where the function is no template.
template <class F, class... Given>
constexpr void requireAccepted(std::type_identity<std::tuple<Given...>>) {
  if constexpr (!Call<F, std::tuple<Given...>>::is_possible) {
    constexpr bool is_mutable = requires(F& f) { f(std::declval<Given>()...); };
    static_assert(
        !is_mutable,
        "slom: the measurement function must be const, as several threads call it at once: leave out `mutable`, or "
        "write `const` behind the parameters of operator()");
    if constexpr (is_mutable) {
    } else if constexpr (Parameters<F>::known) {
      using Wanted = typename Parameters<F>::type;
      constexpr bool right_number = std::tuple_size_v<Wanted> == sizeof...(Given);
      static_assert(right_number,
                    "slom: the measurement function takes another number of arguments: it gets one for each "
                    "VarID and each datum, none for noise, loss, name and slom::measured");
      if constexpr (right_number) {
        [&]<std::size_t... I>(std::index_sequence<I...>) {
          (requireArgument<static_cast<int>(I) + 1, Given, std::tuple_element_t<I, Wanted>>(), ...);
        }(std::index_sequence_for<Given...>{});
      }
    } else {
      static_assert(
          Call<F, std::tuple<Given...>>::is_possible,
          "slom: the measurement function does not accept these arguments: it gets `const T&` for each VarID<T> "
          "and `const D&` for each datum of type D, in the order of the call");
    }
  }
}

/// The residual that a callable's return value stands for.
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
      "slom: the measurement function returns an unevaluated Eigen expression, which may refer to temporaries "
      "that are gone; return its value, as eval of Eigen gives it, or give the function a return type");
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

/// J[c * stride] := d[c] for c < N
template <int N, class Partials>
void storeStrided(const Partials& d, double* J, int stride) {
  [&]<int... C>(std::integer_sequence<int, C...>) {
    ((J[C * stride] = d.get(C)), ...);
  }(std::make_integer_sequence<int, N>{});
}

/// Stands for the number of a first unknown that is known only at run time.
inline constexpr int kRuntimeOffset = -1;

/// What the function gets of a stored argument when derivatives are wanted: variables over the dual number D.
template <class Stored, class D, int Offset>
struct DualArgument {
  const Stored& value;
  DualArgument(const Stored& datum, int) : value(datum) {}
};
template <class T, class D, int Offset>
struct DualArgument<VarArg<T>, D, Offset> {
  mtk::rebind_t<T, D> value;
  /// first: the number of its first unknown.
  DualArgument(const VarArg<T>& variable, int first)
      : value(mtk::detail::seededAs<mtk::rebind_t<T, D>>(*variable, Offset == kRuntimeOffset ? first : Offset,
                                                         D::size)) {}
  DualArgument(const DualArgument&) = delete;
};

template <class A>
inline constexpr int argument_dof = 0;
template <class T>
inline constexpr int argument_dof<VarArg<T>> = mtk::DOF_v<T>;
template <class A>
inline constexpr bool is_rebindable_argument = true;
template <class T>
inline constexpr bool is_rebindable_argument<VarArg<T>> = mtk::is_rebindable_v<T>;

template <class T>
constexpr bool hasFixedSize() {
  if constexpr (requires { T::SizeAtCompileTime; }) {
    return T::SizeAtCompileTime != mtk::Dynamic;
  } else if constexpr (mtk::Manifold<T>) {
    return mtk::DOF_v<T> != mtk::Dynamic;
  } else {
    return true;
  }
}

template <class A>
int runtimeDof(const A&) {
  return 0;
}
template <class T>
int runtimeDof(const VarArg<T>& variable) {
  return mtk::dof(*variable);
}

/// Whether a function's result is made of dual numbers. One that returns doubles whatever it gets is no function of them.
template <class R>
constexpr bool carriesDerivatives() {
  if constexpr (mtk::detail::is_std_array<R>) {
    return carriesDerivatives<typename R::value_type>();
  } else if constexpr (mtk::Manifold<R>) {  // first: to mtk::Scalar, R::Scalar is its own name
    return mtk::detail::is_dual<mtk::scalar_t<R>>;
  } else if constexpr (requires { typename R::Scalar; }) {
    return mtk::detail::is_dual<typename R::Scalar>;
  } else {
    return requires(const R& x) { x.partials(); };
  }
}
/// What the function gets of a DualArgument, without the class around it.
template <class Stored, class D>
struct DualPassed {
  using type = std::tuple<const Stored&>;
};
template <class T, class D>
struct DualPassed<VarArg<T>, D> {
  using type = std::tuple<const mtk::rebind_t<T, D>&>;
};
template <class Z, class D>
struct DualPassed<Measured<Z>, D> {
  using type = std::tuple<>;
};
/// Whether F accepts variables over the dual number D in place of doubles.
template <class F, class D, class... Stored>
constexpr bool acceptsDuals() {
  if constexpr ((is_rebindable_argument<Stored> && ...)) {
    using Passed = typename Join<typename DualPassed<Stored, D>::type...>::type;
    if constexpr (Call<F, Passed>::is_possible) {
      return carriesDerivatives<typename Call<F, Passed>::Result>();
    } else {
      return false;
    }
  } else {
    return false;
  }
}

/// Whether a parameter would round the value of a variable that is a number.
template <class Arg, class Parameter>
constexpr bool roundsVariable() {
  using P = std::remove_cvref_t<Parameter>;
  return std::is_same_v<Arg, VarID<double>> && (std::is_integral_v<P> || std::is_same_v<P, float>);
}
/// `Wanted`: the parameters; of `Args` the function gets those that are not marked by slom::measured.
template <class Wanted, class... Args>
constexpr bool roundsVariables() {
  constexpr std::size_t count = (std::size_t{!is_measured<Args>} + ... + 0);
  if constexpr (std::tuple_size_v<Wanted> == count) {
    bool any = false;
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      std::size_t next = 0;
      const auto check = [&]<class Arg>(std::type_identity<Arg>) {
        const std::size_t here = is_measured<Arg> ? count : next++;
        ((I == here ? any = any || roundsVariable<Arg, std::tuple_element_t<I, Wanted>>() : false), ...);
      };
      (check(std::type_identity<Args>()), ...);
    }(std::make_index_sequence<count>());
    return any;
  } else {
    return false;
  }
}
template <class F, class... Args>
constexpr bool parametersRoundVariables() {
  if constexpr (Parameters<F>::known) {
    return roundsVariables<typename Parameters<F>::type, Args...>();
  } else {
    return false;
  }
}

/// One block of a hand-written Jacobian: rows x dof, filled with NaN before.
template <int Rows, int Dof>
using JacobianBlock =
    Eigen::Matrix<double, Rows, Dof,
                  Eigen::DontAlign |
                      (Rows == 1 && Dof != 1 ? Eigen::RowMajor
                                             : Eigen::ColMajor)>;  // rows are row-major to Eigen
template <int Rows, class A>
struct BlockFor {
  using type = std::tuple<>;
};
template <int Rows, class T>
struct BlockFor<Rows, VarArg<T>> {
  using type = std::tuple<JacobianBlock<Rows, mtk::DOF_v<T>>>;
};
template <int Rows, class... Stored>
using BlockTuple = typename Join<typename BlockFor<Rows, Stored>::type...>::type;

template <class F, class Passed, class Blocks>
inline constexpr bool has_jacobian = false;
template <class F, class... P, class... B>
inline constexpr bool has_jacobian<F, std::tuple<P...>, std::tuple<B...>> =
    requires(const F& f, B&... block) { f.jacobian(std::declval<P>()..., block...); };

}  // namespace detail

/// Holds a callable and its arguments; fulfils `Measurement`.
///
/// Derivatives: `f.jacobian(arguments..., blocks...)` where the functor has such a member; it writes d residual / d variable
/// (rows x dof, right perturbation of rotations) to one Eigen matrix per variable. Otherwise dual numbers where f accepts
/// them, and central differences where it does not.
template <class F, class... Args>
class CallableMeasurement {
  template <class A>
  using Stored = typename detail::Argument<A>::Stored;
  using Function = typename detail::Unwrapped<F>::type;
  using VariableIndices = decltype(detail::indicesWhere<detail::is_var_id<Args>...>());
  using PassedIndices = decltype(detail::indicesWhere<!detail::is_measured<Args>...>());
  using Passed = typename detail::Join<typename detail::Argument<Args>::Passed...>::type;
  static_assert((detail::is_var_id<Args> || ...),
                "slom: a measurement needs at least one variable: pass the VarID that insertRV returned");
  static_assert(
      (int{detail::is_measured<Args>} + ... + 0) <= 1,
      "slom: a measurement predicts one datum: mark one argument by slom::measured, and pass the others as they are");
  static_assert((detail::requireAccepted<Function>(std::type_identity<Passed>{}), true));
  static_assert(
      !detail::parametersRoundVariables<Function, Args...>(),
      "slom: a parameter of the measurement function is float, an integer or bool where the variable is a double, which rounds "
      "its value so that there are no derivatives: declare it as double or const auto&");
  using Value = typename detail::Call<Function, Passed>::Result;
  using Datum = decltype(detail::findDatum(std::declval<const Stored<Args>&>()...));
  static constexpr bool has_datum = !std::is_same_v<Datum, std::nullptr_t>;

  static constexpr int rows() {
    if constexpr (has_datum) {
      using Z = std::remove_cvref_t<decltype(*std::declval<Datum>())>;
      static_assert(
          std::is_convertible_v<Value, Z>,
          "slom: with slom::measured(z) the measurement function must predict a value of the type of z");
      static_assert(
          !std::is_arithmetic_v<Value> || std::is_same_v<Value, double> || std::is_same_v<Value, long double>,
          "slom: a measurement function must predict double; this one returns float, an integer or bool, which rounds the "
          "residual so that it has no derivatives: compute with double, as in 1.0 and not 1 or 1.f");
      return mtk::DOF_v<Z>;
    } else {
      return detail::Returned<Value>::rows;
    }
  }

  // Derivatives of a fixed number of unknowns are computed in one pass, of many or of an unknown number in several.
  static constexpr bool is_fixed = ((detail::argument_dof<Stored<Args>> != mtk::Dynamic) && ...);
  static constexpr int columns = is_fixed ? (detail::argument_dof<Stored<Args>> + ...) : mtk::Dynamic;
  static constexpr int kMostColumnsPerPass = 32;
  static constexpr int window = !is_fixed ? 8 : columns <= kMostColumnsPerPass ? columns : 16;
  static constexpr int kMostInRegisters = 256;  // entries of a Jacobian
  using Number = mtk::Dual<double, window>;
  template <class A, int Offset>
  using Dual = detail::DualArgument<Stored<A>, Number, Offset>;
  static constexpr std::array<int, sizeof...(Args)> fixedOffsets() {
    std::array<int, sizeof...(Args)> result{};
    const int dofs[] = {detail::argument_dof<Stored<Args>>...};
    for (std::size_t i = 1; i < sizeof...(Args); ++i) result[i] = result[i - 1] + dofs[i - 1];
    return result;
  }

 public:
  static constexpr int residual_dim = rows();
  /// Whether several measurements are evaluated at once.
  static constexpr bool vectorized = [] {
    if constexpr (detail::is_vectorized<F>) {
      return true;
    } else if constexpr (detail::VectorizedByItself<F>) {
      return columns <= detail::kMostPackedColumns &&
             (detail::isPackable<detail::Held<Stored<Args>>>() && ...);
    } else {
      return false;
    }
  }();
  static constexpr DerivativeSource derivatives = [] {
    using Blocks = detail::BlockTuple<residual_dim, Stored<Args>...>;
    if (vectorized) return DerivativeSource::exact;
    if (detail::is_numeric<F>) return DerivativeSource::numeric;
    if (detail::has_jacobian<Function, Passed, Blocks>) return DerivativeSource::given;
    return detail::acceptsDuals<Function, Number, Stored<Args>...>() ? DerivativeSource::exact
                                                                     : DerivativeSource::numeric;
  }();
  static constexpr bool richardson = detail::is_richardson<F>;

  /// What messages call measurements of this callable: its type, `lambda` or `function`.
  static std::string groupName() {
    if constexpr (std::is_class_v<Function>) {
      return typeName<Function>();
    } else {
      return "function";
    }
  }

  explicit CallableMeasurement(F f, const Args&... args) : f_(std::move(f)), args_{{Stored<Args>(args)}...} {}

  auto variableArgs() {
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      return detail::listVariables(detail::valueAt<I>(args_)...);
    }(VariableIndices{});
  }
  /// As stored: VarArg<T> for variables, Measured<Z>, data.
  const auto& arguments() const { return args_; }
  void evaluate(Residual<residual_dim>& ret) const {
    evaluateTo([&](int size) {
      if constexpr (residual_dim == mtk::Dynamic) ret.resize(size);
      return ret.data();
    });
  }
  /// The same to r. Returns the length of the residual; nothing is written when it is not `rows`.
  int evaluate(int rows, double* r) const {
    return evaluateTo([&](int size) { return size == rows ? r : nullptr; });
  }

  /// Residual (`rows` entries) and derivatives by all unknowns (rows x columns, column-major). Returns the length of the
  /// residual that the function returned; nothing is written when it is not `rows`.
  int linearize(int rows, double* r, double* J) const
    requires(derivatives == DerivativeSource::exact && !vectorized)
  {
    constexpr auto arguments = std::index_sequence_for<Args...>{};
    if constexpr (is_fixed && columns == window) {
      return linearizeSeeded(arguments, fixedOffsets(), rows, r, J, columns);
    } else {
      const int all =
          detail::applyTo(args_, [](const auto&... stored) { return (detail::runtimeDof(stored) + ...); });
      int got = rows;
      for (int first = 0; first < all && got == rows; first += window) {
        got = linearizeSeeded(arguments, offsets(first), rows, r,
                              J + static_cast<std::ptrdiff_t>(first) * rows, std::min(window, all - first));
      }
      return got;
    }
  }
  int linearize(int rows, double* r, double* J) const
    requires(derivatives == DerivativeSource::given)
  {
    if (const int got = evaluate(rows, r); got != rows) return got;
    writeJacobian(rows, J, PassedIndices{}, VariableIndices{});
    return rows;
  }

  /// Residuals of `count` measurements, which lie one after the other, and, unless J is null, derivatives.
  static void evaluateMany(const CallableMeasurement* first, int count, double* r, double* J)
    requires(vectorized)
  {
    static_assert(
        std::is_empty_v<Function>,
        "slom: slom::vectorized needs a function without captures or members, since one call serves several "
        "measurements: pass what it captures as further arguments of insertMeasurement");
    static_assert(
        is_fixed && residual_dim != mtk::Dynamic &&
            (detail::hasFixedSize<detail::Held<Stored<Args>>>() && ...),
        "slom: slom::vectorized needs variables, data and residuals of sizes known at compile time");
    static_assert(
        !is_fixed || columns <= detail::kMostPackedColumns,
        "slom: slom::vectorized has room for 60 unknowns in a measurement; without it there may be more");
    static_assert(
        (!std::is_void_v<mtk::rebind_t<detail::Held<Stored<Args>>, double>> && ...),
        "slom: slom::vectorized needs variables and data that exist over other scalars: numbers, vectors, mtk's "
        "types, compounds of them and class templates (see mtk/rebind.hpp)");
    using Evaluation = typename Packed<std::make_index_sequence<sizeof...(Args)>>::type;
    constexpr int width = Evaluation::width, entries = residual_dim * columns;
    for (int left = count; left > 0; left -= width) {
      typename Evaluation::Source source;
      for (int lane = 0; lane < width; ++lane) {  // the last one fills lanes that are left over
        source[static_cast<std::size_t>(lane)] = &first[std::min(lane, left - 1)].args_;
      }
      double rest_r[width * residual_dim], rest_J[width * entries];
      const bool is_full = left >= width;
      double* const to_r = is_full ? r : rest_r;
      if (J == nullptr) {
        Evaluation::evaluate(first->function(), source, to_r);
      } else {
        Evaluation::linearize(first->function(), source, to_r, is_full ? J : rest_J);
        if (!is_full) std::copy_n(rest_J, left * entries, J);
        J += width * entries;
      }
      if (!is_full) std::copy_n(rest_r, left * residual_dim, r);
      first += width;
      r += width * residual_dim;
    }
  }

 private:
  template <class Indices>
  struct Packed;
  template <std::size_t... I>
  struct Packed<std::index_sequence<I...>> {
    using type = detail::PackEvaluation<Function, residual_dim, columns,
                                        std::integer_sequence<int, fixedOffsets()[I]...>, Stored<Args>...>;
  };

  const Function& function() const {
    if constexpr (std::is_same_v<F, Function>) {
      return f_;
    } else {
      return f_.f;
    }
  }
  Datum datum() const {
    return detail::applyTo(args_, [](const auto&... stored) { return detail::findDatum(stored...); });
  }

  template <std::size_t... I>
  Value predict(std::index_sequence<I...>) const {
    return detail::call(function(), detail::held(detail::valueAt<I>(args_))...);
  }
  template <class Seeds, std::size_t... I>
  auto predictFrom(const Seeds& seeds, std::index_sequence<I...>) const {
    return detail::call(function(), detail::valueAt<I>(seeds).value...);
  }
  /// The blocks of f.jacobian, one after the other.
  template <std::size_t... P, std::size_t... V>
  void writeJacobian(int rows, double* J, std::index_sequence<P...>, std::index_sequence<V...>) const {
    detail::BlockTuple<residual_dim, Stored<Args>...> blocks;
    std::apply(
        [&](auto&... block) {
          (block.setConstant(rows, detail::runtimeDof(detail::valueAt<V>(args_)),
                             std::numeric_limits<double>::quiet_NaN()),
           ...);
          function().jacobian(detail::held(detail::valueAt<P>(args_))..., block...);
          ((J = std::copy(block.data(), block.data() + block.size(), J)), ...);
        },
        blocks);
  }
  /// Writes the residual to where target(its length) says, unless that is null. Returns its length.
  template <class Target>
  int evaluateTo(const Target& target) const {
    if constexpr (has_datum) {
      using Z = std::remove_cvref_t<decltype(*datum())>;
      const auto difference = [&] {
        if constexpr (requires(const Z& z) { Function::residualFromDatum(z, z); }) {
          return Function::residualFromDatum(predict(PassedIndices{}), *datum());
        } else {
          return mtk::difference<Z>(predict(PassedIndices{}), *datum());
        }
      }();
      const int size = static_cast<int>(difference.size());
      double* const r = target(size);
      for (int i = 0; r != nullptr && i < size; ++i) r[i] = difference.data()[i];
      return size;
    } else {
      using Returned = detail::Returned<Value>;
      const Value value = predict(PassedIndices{});
      const int size = Returned::size(value);
      if (double* const r = target(size)) Returned::write(value, r);
      return size;
    }
  }

  /// Number of the first unknown of each argument.
  std::array<int, sizeof...(Args)> offsets(int first) const {
    return detail::applyTo(args_, [&](const auto&... stored) {
      int next = -first;
      return std::array<int, sizeof...(Args)>{std::exchange(next, next + detail::runtimeDof(stored))...};
    });
  }
  /// Residual and the `width` columns of the derivatives in a window; offset: of each argument's first unknown in it.
  template <std::size_t... I>
  SLOM_FLATTEN int linearizeSeeded(std::index_sequence<I...>, const std::array<int, sizeof...(Args)>& offset,
                                   int rows, double* r, double* J, int width) const {
    constexpr bool one_pass = is_fixed && columns == window;
    const detail::Values<Dual<Args, one_pass ? fixedOffsets()[I] : detail::kRuntimeOffset>...> seeds{
        {Dual < Args,
         one_pass ? fixedOffsets()[I] : detail::kRuntimeOffset > (detail::valueAt<I>(args_), offset[I])}...};
    if constexpr (one_pass) width = columns;
    if constexpr (residual_dim != mtk::Dynamic) rows = residual_dim;
    return write(predictFrom(seeds, PassedIndices{}), rows, r, J, width);
  }
  template <class Result>
  int write(const Result& result, int rows, double* r, double* J, int width) const {
    // The columns of a small Jacobian are put together in registers. With fewer rows, single stores are hidden by arithmetic.
    constexpr bool in_registers =
        is_fixed && columns == window && residual_dim >= 4 && residual_dim * columns <= kMostInRegisters;
    [[maybe_unused]] mtk::detail::Lanes<double, in_registers ? columns : 1>
        gathered[in_registers ? residual_dim : 1];
    const auto sink = [&](int row, const auto& x) {
      if constexpr (mtk::detail::is_dual<std::remove_cvref_t<decltype(x + 0.0)>>) {
        r[row] = x.value();
        if constexpr (in_registers) {
          gathered[row] = x.partials();
        } else if constexpr (is_fixed && columns == window) {
          detail::storeStrided<columns>(x.partials(), J + row, rows);
        } else {
          for (int c = 0; c < width; ++c) J[c * rows + row] = x.partials().get(c);
        }
      } else {  // does not depend on the variables
        r[row] = x;
        if constexpr (in_registers) {
          gathered[row] = mtk::detail::Lanes<double, columns>::zero();
        } else {
          for (int c = 0; c < width; ++c) J[c * rows + row] = 0;
        }
      }
    };
    if constexpr (has_datum) {
      detail::eachResidual<Function>(result, *datum(), sink);
    } else {
      if constexpr (residual_dim == mtk::Dynamic) {
        if (result.size() != rows) return static_cast<int>(result.size());
      }
      detail::eachRow(result, sink);
    }
    if constexpr (in_registers) mtk::detail::deinterleave<residual_dim>(gathered, J, residual_dim);
    return rows;
  }

  [[no_unique_address]] F f_;
  detail::Values<Stored<Args>...> args_;
};

}  // namespace slom
