/// The values of all variables of one type, in slots that handles refer to.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "mtk/manifold.hpp"
#include "mtk/stream.hpp"
#include "slom/model/stable_vector.hpp"
#include "slom/model/type_name.hpp"

namespace slom {

using mtk::Error;

/// A place in a store. A slot is used again after its variable was removed; `generation` tells the two apart.
struct SlotRef {
  std::uint32_t slot = 0;
  std::uint32_t generation = 0;
};

namespace detail {
/// What `write(stream, value)` writes, as a string. Compiled once: streams are dear to every file that makes one.
std::string textOf(const void* value, void (*write)(std::ostream&, const void*));
[[noreturn]] void raiseStaleHandle(const std::string& type, bool was_valid);
}  // namespace detail

/// What the untyped part of the library does with values: all of one type in one call.
class VariableStoreBase {
 public:
  virtual ~VariableStoreBase();

  virtual std::string typeName() const = 0;
  virtual int dof(std::uint32_t slot) const = 0;
  virtual std::vector<std::string> componentNames(std::uint32_t slot, const std::string& path) const = 0;
  /// The value as text, for messages.
  virtual std::string valueText(std::uint32_t slot) const = 0;
  /// Writes |x_i| of every component (1 for angles) to out.
  virtual void magnitudes(std::uint32_t slot, double* out) const = 0;

  /// Remembers all values; `restore` brings them back.
  virtual void save() = 0;
  virtual void restore() = 0;
  /// x := x [+] step[offset_of_variable[v]...] for each variable v of this store whose offset is not negative.
  virtual void applyStep(const std::vector<int>& offset_of_variable, const double* step) = 0;

  /// Index of the slot's variable in the problem, -1 when the slot is free.
  int variable(std::uint32_t slot) const { return variable_[slot]; }
  bool isCurrent(SlotRef ref) const {
    return ref.slot < generation_.size() && generation_[ref.slot] == ref.generation && variable_[ref.slot] >= 0;
  }
  /// Frees the slot; handles to it become stale.
  void release(std::uint32_t slot);

 protected:
  std::vector<int> variable_;
  std::vector<std::uint32_t> generation_;
  std::vector<std::uint32_t> free_;
};

template <class T>
class VariableStore final : public VariableStoreBase {
  static_assert(std::is_same_v<mtk::scalar_t<T>, double>, "slom: the scalar of an estimated variable must be double");

 public:
  /// Stores `value` as the variable with index `variable`.
  SlotRef insert(const T& value, int variable) {
    std::uint32_t slot = static_cast<std::uint32_t>(values_.size());
    if (free_.empty()) {
      variable_.reserve(slot + 1);
      generation_.reserve(slot + 1);
      free_.reserve(slot + 1);  // so that release() cannot fail
      values_.push_back(value);
      variable_.push_back(variable);
      generation_.push_back(0);
    } else {
      slot = free_.back();
      values_[slot] = value;
      free_.pop_back();
      variable_[slot] = variable;
    }
    return {slot, generation_[slot]};
  }

  const T& value(std::uint32_t slot) const { return values_[slot]; }
  T& value(std::uint32_t slot) { return values_[slot]; }

  std::string typeName() const override { return slom::typeName<T>(); }
  int dof(std::uint32_t slot) const override { return mtk::dof(values_[slot]); }
  std::vector<std::string> componentNames(std::uint32_t slot, const std::string& path) const override {
    return mtk::componentNames(values_[slot], path);
  }
  std::string valueText(std::uint32_t slot) const override {
    if constexpr (mtk::isWritable<T>()) {
      return detail::textOf(&values_[slot], [](std::ostream& os, const void* value) {
        mtk::write(os, *static_cast<const T*>(value));
      });
    } else {
      return "a " + typeName();
    }
  }
  void magnitudes(std::uint32_t slot, double* out) const override {
    mtk::magnitudes<T>(mtk::vectview<double, mtk::DOF_v<T>>(out, dof(slot)), values_[slot]);
  }

  void save() override {
    saved_.clear();
    saved_.reserve(values_.size());
    for (std::size_t i = 0; i < values_.size(); ++i) saved_.push_back(values_[i]);
  }
  void restore() override {
    for (std::size_t i = 0; i < saved_.size(); ++i) values_[i] = saved_[i];
  }
  void applyStep(const std::vector<int>& offset_of_variable, const double* step) override {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const int v = variable_[i];
      if (v < 0 || offset_of_variable[static_cast<std::size_t>(v)] < 0) continue;
      const double* d = step + offset_of_variable[static_cast<std::size_t>(v)];
      mtk::boxplus<T>(values_[i], mtk::vectview<const double, mtk::DOF_v<T>>(d, mtk::dof(values_[i])));
    }
  }

 private:
  StableVector<T> values_;
  std::vector<T> saved_;
};

}  // namespace slom
