#include "slom/model/runtime_measurement.hpp"

namespace slom {

RuntimeMeasurement::RuntimeMeasurement(const std::string& subject, std::vector<AnyVarID> variables)
    : ids_(std::move(variables)) {
  if (ids_.empty()) {
    throw Error("slom.no-variables",
                subject + " has no variables, its list is empty; pass the VarID of at least one", subject);
  }
  views_.reserve(ids_.size());
  for (const AnyVarID& id : ids_) views_.emplace_back(id);
}

RuntimeMeasurement::RuntimeMeasurement(const RuntimeMeasurement&) = default;
RuntimeMeasurement::RuntimeMeasurement(RuntimeMeasurement&&) noexcept = default;
RuntimeMeasurement& RuntimeMeasurement::operator=(const RuntimeMeasurement&) = default;
RuntimeMeasurement& RuntimeMeasurement::operator=(RuntimeMeasurement&&) noexcept = default;
RuntimeMeasurement::~RuntimeMeasurement() = default;

int RuntimeMeasurement::linearize(int, double*, double*) const { return -1; }
const void* RuntimeMeasurement::firstEstimate(int) const { return nullptr; }
std::unique_ptr<RuntimeMeasurement> RuntimeMeasurement::copyOver(std::vector<AnyVarID>) const {
  return nullptr;
}

void RuntimeMeasurement::setVariable(int k, const VariableHandle& id) {
  const auto i = static_cast<std::size_t>(k);
  ids_[i] = AnyVarID(id);
  views_[i].rebind(id);
}

}  // namespace slom
