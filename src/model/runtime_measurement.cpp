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

}  // namespace slom
