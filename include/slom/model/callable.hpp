/// CallableMeasurement: any callable as a measurement. Its VarID arguments become variables; other arguments are data,
/// stored by value.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "mtk/rebind.hpp"
#include "slom/model/accepted_call.hpp"
#include "slom/model/argument.hpp"
#include "slom/model/dual_argument.hpp"
#include "slom/model/function.hpp"
#include "slom/model/given_jacobian.hpp"
#include "slom/model/indices.hpp"
#include "slom/model/measurement.hpp"
#include "slom/model/noise.hpp"
#include "slom/model/prediction.hpp"
#include "slom/model/returned.hpp"
#include "slom/model/values.hpp"
#include "slom/model/vectorized.hpp"

namespace slom {

/// Holds a callable and its arguments and satisfies `Measurement`.
///
/// Derivatives come from one of three sources:
///   f.jacobian(arguments..., blocks...)   if the functor has such a member. It writes d residual / d variable (rows x
///                                         dof, right perturbation of rotations) to one Eigen matrix for each variable.
///   dual numbers                          otherwise, if f accepts them
///   central differences                   otherwise
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
      "slom: a measurement predicts one datum: mark one argument by slom::measured, and pass the others "
      "without it");
  static_assert((detail::requireAccepted<Function, Args...>(std::type_identity<Passed>{}), true));
  static_assert(
      !detail::parametersRoundVariables<Function, Args...>(),
      "slom: a parameter of the measurement function is float, an integer or bool, but the variable is "
      "a double; rounding its value removes the derivatives: declare the parameter as double or const "
      "auto&");
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

  // Derivatives with respect to a fixed number of unknowns take one pass; those of many or an unknown number take
  // several.
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
  /// True if several measurements are evaluated at once.
  static constexpr bool vectorized = [] {
    if constexpr (detail::is_vectorized<F>) {
      return true;
    } else if constexpr (detail::VectorizedByItself<F>) {
      return columns <= detail::kMostPackedColumns &&
             (detail::isPackable<detail::ContentOf<Stored<Args>>>() && ...);
    } else {
      return false;
    }
  }();
  static constexpr DerivativeSource derivatives = [] {
    using Blocks = detail::BlockTuple<residual_dim, Stored<Args>...>;
    if constexpr (vectorized) {  // others would instantiate the function without calling it
      return DerivativeSource::exact;
    } else if constexpr (detail::is_numeric<F>) {
      return DerivativeSource::numeric;
    } else if constexpr (detail::has_jacobian<Function, Passed, Blocks>) {
      return DerivativeSource::given;
    } else {
      return detail::acceptsDuals<Function, Number, Stored<Args>...>() ? DerivativeSource::exact
                                                                       : DerivativeSource::numeric;
    }
  }();
  static constexpr bool richardson = detail::is_richardson<F>;
  /// Returns the steps given by the user.
  const DifferenceStep& differenceStep() const
    requires(detail::has_difference_step<F>)
  {
    return f_.how;
  }

  /// Returns the name of measurements of this callable in messages: its type, `lambda` or `function`.
  static std::string groupName() {
    if constexpr (std::is_class_v<Function>) {
      return typeName<Function>();
    } else {
      return "function";
    }
  }

  /// Creates a measurement from a function and its arguments as passed: VarID<T> for variables, Measured<Z>, data.
  explicit CallableMeasurement(F f, const Args&... args) : f_(std::move(f)), args_{{Stored<Args>(args)}...} {}

  /// Returns the variables, in the form that measurements declared by macro use.
  auto variableArgs() {
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      return detail::listVariables(detail::valueAt<I>(args_)...);
    }(VariableIndices{});
  }
  /// Returns the arguments as stored: VarArg<T> for variables, Measured<Z>, data.
  const auto& arguments() const { return args_; }
  /// Writes the residual in the measurement's units. Resizes `ret` if the length is Dynamic.
  void evaluate(Residual<residual_dim>& ret) const {
    evaluateTo([&](int size) {
      if constexpr (residual_dim == mtk::Dynamic) ret.resize(size);
      return ret.data();
    });
  }
  /// Writes the residual to r. Returns its length; if that is not `rows`, writes nothing.
  int evaluate(int rows, double* r) const {
    return evaluateTo([&](int size) { return size == rows ? r : nullptr; });
  }

  /// Writes the residual (`rows` entries) and the derivatives with respect to all unknowns (rows x columns,
  /// column-major). Returns the length of the function's residual; if that is not `rows`, writes nothing.
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

  /// Writes the residuals of `count` consecutive measurements and, unless J is null, their derivatives.
  static void evaluateMany(const CallableMeasurement* first, int count, double* r, double* J)
    requires(vectorized)
  {
    static_assert(
        std::is_empty_v<Function>,
        "slom: slom::vectorized needs a function without captures or members, since one call serves several "
        "measurements: pass what it captures as further arguments of insertMeasurement");
    static_assert(
        is_fixed && residual_dim != mtk::Dynamic &&
            (detail::hasFixedSize<detail::ContentOf<Stored<Args>>>() && ...),
        "slom: slom::vectorized needs variables, data and residuals of sizes known at compile time");
    static_assert(!is_fixed || columns <= detail::kMostPackedColumns,
                  "slom: slom::vectorized supports at most 60 unknowns in a measurement; remove it for more");
    static_assert(
        (!std::is_void_v<mtk::rebind_t<detail::ContentOf<Stored<Args>>, double>> && ...),
        "slom: slom::vectorized needs variables and data that exist over other scalars: numbers, vectors, mtk's "
        "types, compounds of them and class templates (see mtk/rebind.hpp)");
    using Evaluation = typename Packed<std::make_index_sequence<sizeof...(Args)>>::type;
    constexpr int width = Evaluation::width, entries = residual_dim * columns;
    for (int left = count; left > 0; left -= width) {
      typename Evaluation::Source source;
      for (int lane = 0; lane < width; ++lane) {  // the last one fills unused lanes
        source[static_cast<std::size_t>(lane)] = &first[std::min(lane, left - 1)].args_;
      }
      double rest_r[std::size_t{width * residual_dim}], rest_J[std::size_t{width * entries}];
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

  /// Returns the function's value for these arguments: the stored ones, or those over dual numbers.
  template <class Arguments, std::size_t... I>
  auto evaluateWith(const Arguments& arguments, std::index_sequence<I...>) const {
    return detail::call(function(), detail::contentOf(detail::valueAt<I>(arguments))...);
  }
  /// Writes the blocks of f.jacobian, one after another.
  template <std::size_t... P, std::size_t... V>
  void writeJacobian(int rows, double* J, std::index_sequence<P...>, std::index_sequence<V...>) const {
    detail::BlockTuple<residual_dim, Stored<Args>...> blocks;
    std::apply(
        [&](auto&... block) {
          (block.setConstant(rows, detail::runtimeDof(detail::valueAt<V>(args_)),
                             std::numeric_limits<double>::quiet_NaN()),
           ...);
          function().jacobian(detail::contentOf(detail::valueAt<P>(args_))..., block...);
          ((J = std::copy(block.data(), block.data() + block.size(), J)), ...);
        },
        blocks);
  }
  /// Writes the residual to the place target(its length), unless that is null. Returns the length.
  template <class Target>
  int evaluateTo(const Target& target) const {
    if constexpr (has_datum) {
      using Z = std::remove_cvref_t<decltype(*datum())>;
      const auto difference = [&] {
        if constexpr (requires(const Z& z) { Function::residualFromDatum(z, z); }) {
          return Function::residualFromDatum(evaluateWith(args_, PassedIndices{}), *datum());
        } else {
          return mtk::difference<Z>(evaluateWith(args_, PassedIndices{}), *datum());
        }
      }();
      const int size = static_cast<int>(difference.size());
      double* const r = target(size);
      for (int i = 0; r != nullptr && i < size; ++i) r[i] = difference.data()[i];
      return size;
    } else {
      using Returned = detail::Returned<Value>;
      const Value value = evaluateWith(args_, PassedIndices{});
      const int size = Returned::size(value);
      if (double* const r = target(size)) Returned::write(value, r);
      return size;
    }
  }

  /// Returns the number of the first unknown of each argument.
  std::array<int, sizeof...(Args)> offsets(int first) const {
    return detail::applyTo(args_, [&](const auto&... stored) {
      int next = -first;
      return std::array<int, sizeof...(Args)>{std::exchange(next, next + detail::runtimeDof(stored))...};
    });
  }
  /// Writes the residual and the `width` columns of the derivatives in a window. offset: place of each argument's first
  /// unknown in the window.
  template <std::size_t... I>
  SLOM_FLATTEN int linearizeSeeded(std::index_sequence<I...>, const std::array<int, sizeof...(Args)>& offset,
                                   int rows, double* r, double* J, int width) const {
    constexpr bool one_pass = is_fixed && columns == window;
    const detail::Values<Dual<Args, one_pass ? fixedOffsets()[I] : detail::kRuntimeOffset>...> seeds{
        {Dual < Args,
         one_pass ? fixedOffsets()[I] : detail::kRuntimeOffset > (detail::valueAt<I>(args_), offset[I])}...};
    if constexpr (one_pass) width = columns;
    if constexpr (residual_dim != mtk::Dynamic) rows = residual_dim;
    return write(evaluateWith(seeds, PassedIndices{}), rows, r, J, width);
  }
  template <class Result>
  int write(const Result& result, int rows, double* r, double* J, int width) const {
    // The columns of a small Jacobian are assembled in registers. With fewer rows, arithmetic hides the single stores.
    constexpr bool in_registers =
        is_fixed && columns == window && residual_dim >= 4 && residual_dim * columns <= kMostInRegisters;
    [[maybe_unused]] mtk::detail::Lanes<double, in_registers ? columns : 1>
        gathered[std::size_t{in_registers ? residual_dim : 1}];
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
