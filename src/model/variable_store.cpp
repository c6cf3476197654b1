#include "slom/model/variable_store.hpp"

#include <sstream>

namespace slom {

namespace detail {

std::string textOf(const void* value, void (*write)(std::ostream&, const void*)) {
  std::ostringstream text;
  write(text, value);
  return text.str();
}

void raiseStaleHandle(const std::string& type, bool was_valid) {
  throw Error("slom.stale-handle",
              "the VarID<" + type + "> " +
                  (was_valid ? "refers to a variable that has been removed; keep the VarID that insertRV returned last"
                             : "refers to no variable; assign it the result of insertRV first"));
}

}  // namespace detail

VariableStoreBase::~VariableStoreBase() = default;

void VariableStoreBase::release(std::uint32_t slot) {
  free_.push_back(slot);
  variable_[slot] = -1;
  ++generation_[slot];
}

}  // namespace slom
