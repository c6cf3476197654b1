#include "slom/model/var_id.hpp"

#include <utility>

namespace slom {

VariableHandle::VariableHandle() = default;
VariableHandle::VariableHandle(std::shared_ptr<VariableStoreBase> store, SlotRef ref)
    : store_(std::move(store)), ref_(ref) {}
VariableHandle::VariableHandle(const VariableHandle&) = default;
VariableHandle::VariableHandle(VariableHandle&&) noexcept = default;
VariableHandle& VariableHandle::operator=(const VariableHandle&) = default;
VariableHandle& VariableHandle::operator=(VariableHandle&&) noexcept = default;
VariableHandle::~VariableHandle() = default;

}  // namespace slom
