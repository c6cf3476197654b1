#include "slom/model/meas_id.hpp"

#include "slom/problem/measurement_pool.hpp"

namespace slom {

MeasurementHandle::MeasurementHandle() = default;
MeasurementHandle::MeasurementHandle(std::shared_ptr<const PoolPresence> presence, SlotRef ref)
    : presence_(std::move(presence)), ref_(ref) {}
MeasurementHandle::MeasurementHandle(const MeasurementHandle&) = default;
MeasurementHandle::MeasurementHandle(MeasurementHandle&&) noexcept = default;
MeasurementHandle& MeasurementHandle::operator=(const MeasurementHandle&) = default;
MeasurementHandle& MeasurementHandle::operator=(MeasurementHandle&&) noexcept = default;
MeasurementHandle::~MeasurementHandle() = default;

bool MeasurementHandle::isValid() const {
  return presence_ != nullptr && presence_->pool != nullptr && presence_->pool->has(ref_);
}

}  // namespace slom
