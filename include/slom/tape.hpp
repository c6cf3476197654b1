/// slom::traced(f): a measurement function that is called once, with numbers that record what it does. The measurements
/// are then evaluated from the tape, many at once, with exact derivatives.
///
///     est.insertMeasurement(slom::traced([](const auto& c, const auto& r, const auto& p) {
///       return (p - c).norm() - r;
///     }), centre, radius, point, slom::StandardDeviation(0.1));
///
///   arguments   as for other functions: VarIDs are variables, slom::measured(z) is predicted, others are data
///   data        numbers, vectors and mtk's types become columns of data. Others, such as integers, become constants of
///               the tape
///   captures    become constants of the tape, too. Pass them through slom::tape::data(x) to make them data. A function
///               without captures is recorded once for each list of types: it must not read variables of its own that
///               change, unless through slom::tape::data
///   branches    f must use mtk::select in place of `if` on computed numbers
/// Measurements with equal tapes are one kind and one batch, whatever functions made them.
#pragma once

#include <bit>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "slom/model/argument.hpp"
#include "slom/model/prediction.hpp"
#include "slom/tape/measurement.hpp"

namespace slom {

namespace detail {

/// True if data of type A always give the same columns.
template <class A>
constexpr bool hasFixedColumns() {
  if constexpr (!tape::detail::is_column_data<A>) {
    return false;
  } else if constexpr (mtk::Manifold<A>) {
    return mtk::DOF_v<A> != mtk::Dynamic;
  } else {
    return A::SizeAtCompileTime != mtk::Dynamic;
  }
}
template <class A>
inline constexpr bool has_fixed_columns = hasFixedColumns<A>();
template <class T>
inline constexpr bool has_fixed_columns<VarID<T>> = true;
template <class Z>
inline constexpr bool has_fixed_columns<Measured<Z>> = hasFixedColumns<Z>();

/// An argument of a traced function as recorded numbers.
template <class A>
decltype(auto) recorded(tape::Recording& recording, const A& datum) {
  return tape::detail::dataOf(recording, datum);
}
template <class T>
auto recorded(tape::Recording& recording, const VarID<T>& id) {
  return tape::detail::variableOf(recording, *id);
}
template <class Z>
decltype(auto) recorded(tape::Recording& recording, const Measured<Z>& datum) {
  static_assert(
      tape::detail::is_column_data<Z>,
      "slom: a traced measurement function needs a datum that exists over other scalars: numbers, vectors, "
      "mtk's types, compounds of them and class templates (see mtk/rebind.hpp)");
  return tape::detail::dataOf(recording, datum.value);
}

/// Calls f(x...) without the datum and returns the residual's entries.
template <class F, class... Args, std::size_t... Passed, std::size_t... Datum>
std::vector<tape::Number> recordedResidual(const F& f, tape::Recording& recording,
                                           std::index_sequence<Passed...>, std::index_sequence<Datum...>,
                                           const Args&... args) {
  const Values<decltype(recorded(recording, args))...> x{{recorded(recording, args)}...};
  const auto y = call(f, valueAt<Passed>(x)...);
  std::vector<tape::Number> residual;
  const auto sink = [&](int row, const auto& number) {
    if (residual.size() <= static_cast<std::size_t>(row)) residual.resize(static_cast<std::size_t>(row) + 1);
    residual[static_cast<std::size_t>(row)] = tape::Number(number);
  };
  if constexpr (sizeof...(Datum) > 0) {
    (eachResidual<F>(y, valueAt<Datum>(x), sink), ...);
  } else {
    eachRow(y, sink);
  }
  return residual;
}

/// Adds what tells kinds of measurements apart besides the formula: the types of their variables.
template <class A>
void appendType(const A&, std::vector<std::type_index>&, std::vector<tape::Layout>&) {}
template <class T>
void appendType(const VarID<T>& id, std::vector<std::type_index>& types, std::vector<tape::Layout>& layouts) {
  types.emplace_back(typeid(T));
  layouts.push_back(tape::detail::layoutOf(*id));
}

/// Returns the kind of the measurement f(args...). Appends the values of its data.
template <class F, class... Args>
std::shared_ptr<const TracedKind> trace(const F& f, std::vector<double>& data, const Args&... args) {
  tape::Recording recording;
  const std::vector<tape::Number> residual = recordedResidual(
      f, recording, indicesWhere<!is_measured<Args>...>(), indicesWhere<is_measured<Args>...>(), args...);
  data.insert(data.end(), recording.values().begin(), recording.values().end());
  std::vector<std::type_index> types;
  std::vector<tape::Layout> layouts;
  (appendType(args, types, layouts), ...);
  std::uint64_t fingerprint = recording.fingerprint(residual);
  for (const std::type_index& type : types) fingerprint = std::rotl(fingerprint, 7) ^ type.hash_code();
  std::shared_ptr<const TracedKind> kind = TracedKind::remembered(fingerprint);
  if (kind == nullptr) {
    kind = TracedKind::shared(recording.finish(residual), std::move(types), std::move(layouts));
    TracedKind::remember(fingerprint, kind);
  }
  return kind;
}

template <class A>
void appendVariable(const A&, std::vector<VariableView>&) {}
template <class T>
void appendVariable(const VarID<T>& id, std::vector<VariableView>& variables) {
  variables.emplace_back(AnyVarID(id));
}
template <class A>
void appendData(const A& datum, std::vector<double>& data) {
  tape::detail::appendNumbers(datum, data);
}
template <class T>
void appendData(const VarID<T>&, std::vector<double>&) {}
template <class Z>
void appendData(const Measured<Z>& datum, std::vector<double>& data) {
  tape::detail::appendNumbers(datum.value, data);
}

/// A function that is traced when measurements with it are inserted.
template <class F>
struct TracedFunction {
  using Traced = F;
  F f;

  template <class... Args>
  static MeasID<TracedMeasurement> insert(Problem& problem, const TracedFunction& function,
                                          const NoiseView& noise, std::string_view label, const Loss& loss,
                                          const Args&... args) {
    static_assert((is_var_id<Args> || ...),
                  "slom: a measurement needs at least one variable: pass the VarID that insertRV returned");
    static_assert(
        (int{is_measured<Args>} + ... + 0) <= 1,
        "slom: a measurement predicts one datum: mark one argument by slom::measured, and pass the others "
        "without it");
    TracedMeasurement measurement;
    (appendVariable(args, measurement.variables), ...);
    if constexpr (std::is_empty_v<F> && (has_fixed_columns<Args> && ...)) {
      // Without captures, the tape is the same for all values, unless the function adds data of its own.
      static const std::shared_ptr<const TracedKind> known = [&] {
        std::vector<double> traced, passed;
        auto kind = trace(function.f, traced, args...);
        (appendData(args, passed), ...);
        return traced.size() == passed.size() ? kind : nullptr;
      }();
      if (known != nullptr) {
        measurement.kind = known;
        (appendData(args, measurement.data), ...);
      }
    }
    if (measurement.kind == nullptr) measurement.kind = trace(function.f, measurement.data, args...);
    return insertTraced(problem, measurement, noise, label, loss);
  }
};

}  // namespace detail

/// Marks a measurement function to be recorded once and evaluated from its tape. All its parameters must be
/// `const auto&`.
template <class F>
auto traced(F f) {
  return detail::TracedFunction<F>{std::move(f)};
}

}  // namespace slom
