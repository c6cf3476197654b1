/// Measurements whose variables are chosen at run time: their number, their types and the length of the residual.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <typeinfo>
#include <utility>
#include <vector>

#include "slom/model/any_var_id.hpp"
#include "slom/model/callable.hpp"

namespace slom {

/// Common properties of all run-time measurements of one class.
struct RuntimeKind {
  const std::type_info* id;
  DerivativeSource derivatives;
  std::string (*name)();  ///< name of the group
  bool states_noise;      ///< the residual is in units of its standard deviation
};

/// Base class of run-time measurements. The library reaches them by virtual calls, one for each measurement.
class RuntimeMeasurement {
 public:
  virtual ~RuntimeMeasurement();

  /// Returns the common properties of this class, the same object for all its measurements.
  virtual const RuntimeKind& kind() const = 0;
  /// Computes the residual. Writes `rows` entries to r, or nothing if r is null or the length differs. Returns the
  /// length.
  virtual int evaluate(int rows, double* r) const = 0;
  /// Writes residual and Jacobian, rows x (degrees of freedom of all variables), column-major. For kinds whose
  /// derivatives are not numeric.
  virtual int linearize(int rows, double* r, double* J) const;

  /// Returns the value at which all measurements of variable k are linearised while this one exists; null: their
  /// current values. The value must stay in place while this measurement lives.
  virtual const void* firstEstimate(int k) const;

  /// Returns this measurement over other variables of the same types, for Estimator::clone(); null if it cannot be
  /// copied.
  virtual std::unique_ptr<RuntimeMeasurement> copyOver(std::vector<AnyVarID> variables) const;
  /// Replaces variable k by another of the same type. Used by the library.
  void setVariable(int k, const VariableHandle& id);

  /// Returns the variables, in the order of the columns of the Jacobian.
  const std::vector<AnyVarID>& variables() const { return ids_; }
  /// Returns the number of variables.
  int arity() const { return static_cast<int>(ids_.size()); }
  /// Returns the views of the variables for evaluation; differences redirect them.
  std::vector<VariableView>& views() { return views_; }
  const std::vector<VariableView>& views() const { return views_; }

 protected:
  /// Checks the variables. Throws [slom.no-variables] or [slom.stale-handle]; the first calls the measurement
  /// `subject`.
  RuntimeMeasurement(const std::string& subject, std::vector<AnyVarID> variables);
  RuntimeMeasurement(const RuntimeMeasurement&);
  RuntimeMeasurement(RuntimeMeasurement&&) noexcept;
  RuntimeMeasurement& operator=(const RuntimeMeasurement&);
  RuntimeMeasurement& operator=(RuntimeMeasurement&&) noexcept;

 private:
  std::vector<AnyVarID> ids_;  // they keep the stores alive
  std::vector<VariableView> views_;
};

/// A callable f(variables, data...) over a list of variables, with `variables` a std::span<const VariableView>. It
/// returns the residual, like other measurement functions. Derivatives are central differences in the tangent space.
/// Dual numbers are not possible, because the types that f asks for are known only while it runs.
template <class F, class... Data>
class ListMeasurement final : public RuntimeMeasurement {
  using Variables = std::span<const VariableView>;
  static_assert(
      !(detail::is_var_id<Data> || ...),
      "slom: a measurement over a list takes its variables only from the list: put this VarID into the "
      "list");
  static_assert(
      std::is_invocable_v<const F&, Variables, const Data&...>,
      "slom: a measurement function over a list of variables gets a std::span<const slom::VariableView> and a "
      "`const D&` for each datum of type D");
  using Result = std::remove_cvref_t<std::invoke_result_t<const F&, Variables, const Data&...>>;
  using Returned = detail::Returned<Result>;

 public:
  /// Creates the measurement f(variables, data...). Throws [slom.no-variables] or [slom.stale-handle].
  ListMeasurement(std::vector<AnyVarID> variables, F f, const Data&... data)
      : RuntimeMeasurement("the measurement over a list", std::move(variables)),
        f_(std::move(f)),
        data_{{data}...} {}

  const RuntimeKind& kind() const override {
    static constexpr RuntimeKind kind{&typeid(ListMeasurement), DerivativeSource::numeric, &name, false};
    return kind;
  }
  int evaluate(int rows, double* r) const override {
    const Variables variables(views());
    const Result value =
        detail::applyTo(data_, [&](const auto&... datum) -> Result { return f_(variables, datum...); });
    const int size = Returned::size(value);
    if (r != nullptr && size == rows) Returned::write(value, r);
    return size;
  }
  std::unique_ptr<RuntimeMeasurement> copyOver(std::vector<AnyVarID> variables) const override {
    if constexpr (std::is_copy_constructible_v<F> && (std::is_copy_constructible_v<Data> && ...)) {
      return detail::applyTo(data_, [&](const auto&... datum) -> std::unique_ptr<RuntimeMeasurement> {
        return std::make_unique<ListMeasurement>(std::move(variables), F(f_), datum...);
      });
    } else {
      return nullptr;
    }
  }
  /// Returns the data, which are stored by value.
  const detail::Values<Data...>& data() const { return data_; }

 private:
  static std::string name() {
    using Function = typename detail::Unwrapped<F>::type;
    return std::is_class_v<Function> ? typeName<Function>() : "function";
  }

  [[no_unique_address]] F f_;
  detail::Values<Data...> data_;
};

}  // namespace slom
