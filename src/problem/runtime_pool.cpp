#include "problem/runtime_pool.hpp"

namespace slom {

namespace {

/// A base that holds what MeasurementPool refers to, so it must be constructed first.
struct OwnType {
  MeasurementType own_type;
};

/// A pool of OwnedMeasurements.
class RuntimePool final : private OwnType, public MeasurementPool {
 public:
  RuntimePool(const std::string& name, const std::string& label, const MeasurementType& type,
              const std::vector<VariableRecord>& table, const ActiveSet& active)
      : OwnType{type}, MeasurementPool(name, label, own_type, table, active) {}

  static MeasurementPool* make(const std::string& name, const std::string& label, const MeasurementType& type,
                               const std::vector<VariableRecord>& table, const ActiveSet& active) {
    return new RuntimePool(name, label, type, table, active);
  }

  const RuntimeMeasurement* runtimeMeasurement(int i) const override { return measurements_[at(i)].get(); }

 protected:
  int run(int& i, int last, double* r, double* J) override {
    for (; i < last; ++i) {
      const int n = rows(i);
      const int got = J == nullptr ? evaluateOne(i, n, r) : linearizeOne(i, n, r, J);
      if (got != n) return got;
      r += n;
      if (J != nullptr) J += static_cast<std::ptrdiff_t>(n) * columns(i);
    }
    return -1;
  }
  int evaluateOne(int i, int rows, double* r) override { return measurements_[at(i)]->evaluate(rows, r); }
  int lengthOf(const void* measurement) const override {
    return (*static_cast<const OwnedMeasurement*>(measurement))->evaluate(0, nullptr);
  }
  void push(void* measurement) override {
    measurements_.push_back(std::move(*static_cast<OwnedMeasurement*>(measurement)));
  }
  bool pushCopy(const MeasurementPool& from, int i, const std::vector<AnyVarID>& variables) override {
    OwnedMeasurement copy = from.runtimeMeasurement(i)->copyOver(variables);
    if (copy == nullptr) return false;
    measurements_.push_back(std::move(copy));
    return true;
  }
  void moveLastTo(int i) override {
    if (i != size() - 1) measurements_[at(i)] = std::move(measurements_.back());
    measurements_.pop_back();
  }
  VariableArgument& argument(int i, int k) override { return measurements_[at(i)]->views()[at(k)]; }

 private:
  int linearizeOne(int i, int rows, double* r, double* J) {
    if (derivatives() == DerivativeSource::numeric) return differentiate(i, rows, r, J, Differences::central);
    return measurements_[at(i)]->linearize(rows, r, J);
  }

  std::vector<OwnedMeasurement> measurements_;
};

}  // namespace

MeasurementType runtimeType(const RuntimeKind& kind, int arity) {
  return {kind.id,          arity, Dynamic, nullptr, kind.derivatives, nullptr, kind.name, &RuntimePool::make,
          kind.states_noise};
}

}  // namespace slom
