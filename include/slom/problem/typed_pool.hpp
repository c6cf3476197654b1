/// TypedPool: the measurements of one type in an array. Code below this class does not have the user's type.
#pragma once

#include <string>
#include <type_traits>
#include <typeinfo>
#include <utility>
#include <vector>

#include "slom/problem/growing_array.hpp"
#include "slom/problem/measurement_pool.hpp"

namespace slom {

template <Measurement M>
class TypedPool final : public MeasurementPool {
  static constexpr int kRows = M::residual_dim;
  using Args = decltype(std::declval<M&>().variableArgs());
  template <class>
  struct Of;
  template <class... T>
  struct Of<detail::VariableList<T...>> {
    static constexpr int arity = static_cast<int>(sizeof...(T));
    static constexpr int dof[] = {mtk::DOF_v<T>...};
    static constexpr std::string (*name[])() = {&slom::typeName<T>...};
    static constexpr int columns = ((mtk::DOF_v<T> == Dynamic) || ...) ? Dynamic : (mtk::DOF_v<T> + ...);
  };
  static constexpr DerivativeSource source() {
    if constexpr (requires { M::derivatives; }) {
      return M::derivatives;
    } else {
      return DerivativeSource::numeric;
    }
  }
  static constexpr bool isVectorized() {
    if constexpr (requires { M::vectorized; }) {
      return M::vectorized;
    } else {
      return false;
    }
  }
  static std::string typeName() {
    if constexpr (requires { M::groupName(); }) {
      return M::groupName();
    } else {
      return slom::typeName<M>();
    }
  }
  static MeasurementPool* make(const std::string& name, const std::string& label, const MeasurementType&,
                               const std::vector<VariableRecord>& table, const ActiveSet& active) {
    return new TypedPool(name, label, table, active);
  }

 public:
  static constexpr MeasurementType type{&typeid(M), Of<Args>::arity, kRows,     Of<Args>::dof,
                                        source(),   Of<Args>::name,  &typeName, &make};

  /// Creates an empty pool for measurements of variables in `table`.
  TypedPool(const std::string& name, const std::string& label, const std::vector<VariableRecord>& table,
            const ActiveSet& active)
      : MeasurementPool(name, label, type, table, active) {}

  const M& operator[](int i) const { return measurements_[at(i)]; }

 protected:
  int run(int& i, int last, double* r, double* J) override {
    if constexpr (isVectorized()) {
      M::evaluateMany(measurements_.data() + i, last - i, r, J);
    } else {
      for (; i < last; ++i) {
        const int n = kRows == Dynamic ? rows(i) : kRows;
        const int got = J == nullptr ? evaluateOne(i, n, r) : linearizeOne(i, n, r, J);
        if (got != n) return got;
        r += n;
        if (J != nullptr)
          J += static_cast<std::ptrdiff_t>(n) *
               (Of<Args>::columns == Dynamic ? columns(i) : Of<Args>::columns);
      }
    }
    return -1;
  }

  int evaluateOne(int i, int rows, double* r) override {
    const M& measurement = measurements_[at(i)];
    if constexpr (requires { measurement.evaluate(rows, r); }) {
      return measurement.evaluate(rows, r);
    } else {
      return detail::evaluatePoisoned(measurement, rows, r);
    }
  }

  int lengthOf(const void* measurement) const override {
    if constexpr (kRows == Dynamic) {
      Residual<kRows> ret;
      static_cast<const M*>(measurement)->evaluate(ret);
      return static_cast<int>(ret.size());
    } else {
      return kRows;
    }
  }

  void push(void* measurement) override { measurements_.push(std::move(*static_cast<M*>(measurement))); }

  bool pushCopy(const MeasurementPool& from, int i, const std::vector<AnyVarID>&) override {
    if constexpr (std::is_copy_constructible_v<M>) {
      M copy(static_cast<const TypedPool&>(from).measurements_[at(i)]);
      push(&copy);
      return true;
    } else {
      return false;
    }
  }

  void moveLastTo(int i) override { measurements_.moveLastTo(at(i)); }

  VariableArgument& argument(int i, int k) override {
    return *measurements_[at(i)].variableArgs().all[at(k)];
  }

  double statedStep() const override {
    if constexpr (requires(const M& measurement) { measurement.differenceStep(); }) {
      return this->size() > 0 ? measurements_[0].differenceStep().relative : 0;
    } else {
      return 0;
    }
  }

 private:
  int linearizeOne(int i, int rows, double* r, double* J) {
    M& measurement = measurements_[at(i)];
    if constexpr (requires { measurement.linearize(rows, r, J); }) {
      return measurement.linearize(rows, r, J);
    } else if constexpr (requires { measurement.differenceStep(); }) {
      return differentiate(i, rows, r, J, Differences::central, &measurement.differenceStep());
    } else {
      return differentiate(
          i, rows, r, J,
          requires { requires M::richardson; } ? Differences::extrapolated : Differences::central);
    }
  }

  GrowingArray<M> measurements_;
};

}  // namespace slom
