/// Measurements whose variables are chosen at run time: how many there are, of which types, and how long the residual is.
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

/// What all run-time measurements of one class have in common.
struct RuntimeKind {
  const std::type_info* id;
  DerivativeSource derivatives;
  std::string (*name)();  ///< name of the group
  bool states_noise;      ///< the residual is in units of its standard deviation
};

/// The base of all of them. They are reached by virtual calls, one for each measurement.
class RuntimeMeasurement {
 public:
  virtual ~RuntimeMeasurement();

  /// What all measurements of this class have in common; which is the same object for each of them.
  virtual const RuntimeKind& kind() const = 0;
  /// The residual. Writes `rows` entries to r, or nothing when r is null or the length is another one. Returns the length.
  virtual int evaluate(int rows, double* r) const = 0;
  /// Residual and Jacobian, rows x (degrees of freedom of all variables), column-major. For kinds whose derivatives are not numeric.
  virtual int linearize(int rows, double* r, double* J) const;

  /// The value at which all measurements of variable k are linearised for as long as this one is there; null: their current values. The
  /// value stays where it is while this measurement lives.
  virtual const void* firstEstimate(int k) const;

  /// The same measurement over other variables of the same types, for Estimator::clone(); null: there is none.
  virtual std::unique_ptr<RuntimeMeasurement> copyOver(std::vector<AnyVarID> variables) const;
  /// Used by the library: makes variable k another one of the same type.
  void setVariable(int k, const VariableHandle& id);

  /// The variables, in the order of the columns of the Jacobian.
  const std::vector<AnyVarID>& variables() const { return ids_; }
  /// The number of variables.
  int arity() const { return static_cast<int>(ids_.size()); }
  /// The variables at which it is evaluated, which differences redirect.
  std::vector<VariableView>& views() { return views_; }
  const std::vector<VariableView>& views() const { return views_; }

 protected:
  /// Throws [slom.no-variables] or [slom.stale-handle]; `subject` is what the former calls the measurement.
  RuntimeMeasurement(const std::string& subject, std::vector<AnyVarID> variables);
  RuntimeMeasurement(const RuntimeMeasurement&);
  RuntimeMeasurement(RuntimeMeasurement&&) noexcept;
  RuntimeMeasurement& operator=(const RuntimeMeasurement&);
  RuntimeMeasurement& operator=(RuntimeMeasurement&&) noexcept;

 private:
  std::vector<AnyVarID> ids_;  // they keep the stores alive
  std::vector<VariableView> views_;
};

/// A callable f(variables, data...) over a list of variables, `variables` a std::span<const VariableView>. It returns the residual,
/// as other measurement functions do. Derivatives are central differences in the tangent space: the types that f asks for are
/// known only while it runs, so that it cannot be handed dual numbers.
template <class F, class... Data>
class ListMeasurement final : public RuntimeMeasurement {
  using Variables = std::span<const VariableView>;
  static_assert(!(detail::is_var_id<Data> || ...),
                "slom: all variables of a measurement over a list are in the list: put this VarID into it");
  static_assert(
      std::is_invocable_v<const F&, Variables, const Data&...>,
      "slom: a measurement function over a list of variables gets a std::span<const slom::VariableView> and a "
      "`const D&` for each datum of type D");
  using Result = std::remove_cvref_t<std::invoke_result_t<const F&, Variables, const Data&...>>;
  using Returned = detail::Returned<Result>;

 public:
  /// Of f(variables, data...). Throws [slom.no-variables] or [slom.stale-handle].
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
  /// The data, which are stored by value.
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
