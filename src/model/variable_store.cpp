#include "slom/model/variable_store.hpp"

#include <locale>
#include <sstream>

namespace slom {

namespace detail {

std::string textOf(const void* value, void (*write)(std::ostream&, const void*)) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  write(text, value);
  return text.str();
}

void raiseStaleHandle(std::string (*type)(), bool was_valid) {
  raiseStaleHandle("VarID<" + type() + ">", was_valid);
}

void raiseStaleHandle(const std::string& handle, bool was_valid) {
  throw Error(
      "slom.stale-handle",
      "the " + handle + " " +
          (was_valid
               ? "refers to a variable that has been removed; keep the VarID that insertRV returned last"
               : "refers to no variable; assign it the result of insertRV first"),
      handle);
}

}  // namespace detail

OrientationSink::~OrientationSink() = default;

VariableStoreBase::VariableStoreBase(std::size_t value_size, std::size_t alignment)
    : value_size_(value_size),
      alignment_(alignment),
      values_(value_size, alignment),
      saved_(value_size, alignment) {}

VariableStoreBase::~VariableStoreBase() = default;

void VariableStoreBase::clear() noexcept {
  for (ValueArray* all : {&values_, &saved_}) {
    for (std::size_t i = 0; i < all->size(); ++i) destroy((*all)[i]);
  }
}

SlotRef VariableStoreBase::insert(const void* value, int variable) {
  std::uint32_t slot = static_cast<std::uint32_t>(values_.size());
  if (free_.empty()) {
    if (slot == free_.capacity()) {  // room for all, so neither this nor release() can fail half-way
      const std::size_t room = 2 * std::size_t{slot} + 16;
      variable_.reserve(room);
      generation_.reserve(room);
      free_.reserve(room);
    }
    construct(values_.place(), value);
    values_.grow();
    variable_.push_back(variable);
    generation_.push_back(0);
  } else {
    slot = free_.back();
    assign(values_[slot], value);
    free_.pop_back();
    variable_[slot] = variable;
  }
  return {slot, generation_[slot]};
}

void VariableStoreBase::copyFrom(const VariableStoreBase& other) {
  const std::size_t slots = other.variable_.size(), room = slots + 16;
  variable_.reserve(room);
  generation_.reserve(room);
  free_.reserve(room);
  for (std::size_t i = 0; i < slots; ++i) {
    construct(values_.place(), other.values_.at(i));
    values_.grow();
  }
  variable_ = other.variable_;
  generation_ = other.generation_;
  free_ = other.free_;
}

std::vector<std::uint32_t> VariableStoreBase::generations() const {
  std::vector<std::uint32_t> all = generation_;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (variable_[i] < 0) all[i] = kFree;
  }
  return all;
}

void VariableStoreBase::save() {
  for (std::size_t i = 0; i < values_.size(); ++i) {
    if (i < saved_.size()) {
      assign(saved_[i], values_[i]);
    } else {
      construct(saved_.place(), values_[i]);
      saved_.grow();
    }
  }
}

void VariableStoreBase::restore() {
  for (std::size_t i = 0; i < saved_.size(); ++i) assign(values_[i], saved_[i]);
}

void VariableStoreBase::applyStep(const std::vector<int>& offset, const double* step) {
  for (std::size_t i = 0; i < values_.size(); ++i) {
    if (variable_[i] < 0) continue;
    const auto v = static_cast<std::size_t>(variable_[i]);
    if (offset[v] < offset[v + 1]) boxplus(values_[i], step + offset[v]);
  }
}

void VariableStoreBase::release(std::uint32_t slot) {
  free_.push_back(slot);
  variable_[slot] = -1;
  ++generation_[slot];
}

template VariableStoreBase* makeVariableStore<double>();
template VariableStoreBase* makeVariableStore<Eigen::Vector2d>();
template VariableStoreBase* makeVariableStore<Eigen::Vector3d>();
template VariableStoreBase* makeVariableStore<Eigen::VectorXd>();
template VariableStoreBase* makeVariableStore<mtk::vect<2>>();
template VariableStoreBase* makeVariableStore<mtk::vect<3>>();
template VariableStoreBase* makeVariableStore<mtk::Scalar<>>();
template VariableStoreBase* makeVariableStore<mtk::SO2<>>();
template VariableStoreBase* makeVariableStore<mtk::SO3<>>();
template VariableStoreBase* makeVariableStore<mtk::trafo<mtk::SO2<>>>();
template VariableStoreBase* makeVariableStore<mtk::trafo<mtk::SO3<>>>();

}  // namespace slom
