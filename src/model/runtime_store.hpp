/// The values of all variables of one RuntimeType.
#pragma once

#include "slom/model/runtime_type.hpp"
#include "slom/model/variable_store.hpp"

namespace slom {

class RuntimeStore final : public VariableStoreBase {
 public:
  explicit RuntimeStore(std::shared_ptr<const RuntimeType> type);
  ~RuntimeStore() override { clear(); }

  const std::shared_ptr<const RuntimeType>& type() const { return type_; }

  bool hasTypeOf(const VariableStoreBase& other) const override;
  std::unique_ptr<VariableStoreBase> makeEmpty() const override;
  std::string typeName() const override { return type_->name(); }
  std::vector<std::string> componentNames(std::uint32_t slot, const std::string& path) const override;
  std::string valueText(std::uint32_t slot) const override;
  void construct(void* place, const void* value) const override;
  void destroy(void*) const noexcept override {}
  void assign(void* to, const void* from) const override;
  int dofOf(const void*) const override { return type_->dof(); }
  void boxplus(void* value, const double* d) const override;
  void boxminus(double* out, const void* x, const void* y) const override;
  void boxminusDerivative(const void* x, const void* y, double* D) const override;
  void typicalSizesOf(const void* value, double* out) const override;
  void leftPerturbation(const void* value, double* A) const override;
  void coordinates(const void* value, double* out) const override;
  void visitOrientations(const void* value, OrientationSink& sink) const override;
  void gaugeGenerators(const void* value, WorldRole role, double* out) const override;

 private:
  std::shared_ptr<const RuntimeType> type_;
};

}  // namespace slom
