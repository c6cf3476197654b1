/// The values of all variables of one type. Handles refer to their slots.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <memory>
#include <new>
#include <string>
#include <typeinfo>
#include <vector>

#include "mtk/manifold.hpp"
#include "mtk/rebind.hpp"
#include "mtk/stream.hpp"
#include "slom/model/boxminus_derivative.hpp"
#include "slom/model/component.hpp"
#include "slom/model/gauge_generators.hpp"
#include "slom/model/type_name.hpp"
#include "slom/model/value_array.hpp"

namespace slom {

using mtk::Error;

/// A place in a store. A slot is reused after its variable is removed; `generation` distinguishes the variables.
struct SlotRef {
  std::uint32_t slot = 0;
  std::uint32_t generation = 0;
};

namespace detail {
/// Returns what `write(stream, value)` writes. Compiled once, because each file that makes a stream compiles much.
std::string textOf(const void* value, void (*write)(std::ostream&, const void*));
[[noreturn]] void raiseStaleHandle(std::string (*type)(), bool was_valid);
/// Throws for a handle that is not a VarID; `handle` names it.
[[noreturn]] void raiseStaleHandle(const std::string& handle, bool was_valid);

/// Writes the matrices of the rotations in x, whose first component is `first`, to the diagonal of A, which has n rows.
template <class T>
void writeLeftPerturbation(const T& x, int first, double* A, int n) {
  mtk::detail::forEachBasicPart(x, x, first, [&](const auto& part, const auto&, int at) {
    if constexpr (requires { part.toRotationMatrix(); } &&
                  mtk::DOF_v<std::remove_cvref_t<decltype(part)>> == 3) {
      const auto R = part.toRotationMatrix();
      for (int i = 0; i < 9; ++i) A[(at + i / 3) * n + at + i % 3] = R(i / 3, i % 3);
    }
  });
}
}  // namespace detail

/// The values of all variables of one type. Code that does not depend on the type is compiled once. Derived classes
/// make, move and describe one value.
class VariableStoreBase {
 public:
  virtual ~VariableStoreBase();
  VariableStoreBase(const VariableStoreBase&) = delete;
  VariableStoreBase& operator=(const VariableStoreBase&) = delete;

  /// Returns whether values of the two stores have the same type.
  virtual bool hasTypeOf(const VariableStoreBase& other) const { return typeid(*this) == typeid(other); }
  /// Returns a store for values of the same type, with no variables.
  virtual std::unique_ptr<VariableStoreBase> makeEmpty() const = 0;
  /// Returns the name of T for messages.
  virtual std::string typeName() const = 0;
  /// Returns a name for each degree of freedom, with `path` in front: `pose.pos.x`.
  virtual std::vector<std::string> componentNames(std::uint32_t slot, const std::string& path) const = 0;
  /// Returns the value as text, for messages.
  virtual std::string valueText(std::uint32_t slot) const = 0;

  // Operations on one value. Pointers are to the type of this store.

  /// Copies `value` into uninitialised memory.
  virtual void construct(void* place, const void* value) const = 0;
  /// Calls the destructor.
  virtual void destroy(void* value) const noexcept = 0;
  /// Assigns to := from.
  virtual void assign(void* to, const void* from) const = 0;
  /// Returns the degrees of freedom of this value.
  virtual int dofOf(const void* value) const = 0;
  /// Computes value := value [+] d; d has dofOf(value) entries.
  virtual void boxplus(void* value, const double* d) const = 0;
  /// Writes x [-] y, dofOf(y) entries, to out.
  virtual void boxminus(double* out, const void* x, const void* y) const = 0;
  /// Writes the derivative of (x [+] d) [-] y with respect to d at d = 0 (dof x dof, column-major).
  virtual void boxminusDerivative(const void* x, const void* y, double* D) const = 0;
  /// Writes |x_i| of every component (1 for angles) to out.
  virtual void typicalSizesOf(const void* value, double* out) const = 0;
  /// Writes A (dof x dof, column-major) such that the perturbation A d on the right does what d does on the left of
  /// rotations.
  virtual void leftPerturbation(const void* value, double* A) const = 0;
  /// Writes the coordinate of each component; NaN for components without one, such as those of rotations.
  virtual void coordinates(const void* value, double* out) const = 0;
  /// Passes each rotation and direction in the value to `sink`.
  virtual void visitOrientations(const void* value, OrientationSink& sink) const = 0;
  /// Writes how the value moves with the world (dof x kGaugeGenerators, column-major).
  virtual void gaugeGenerators(const void* value, WorldRole role, double* out) const = 0;
  /// Returns the size of T [bytes].
  std::size_t valueSize() const { return value_size_; }
  /// Returns the alignment of T [bytes].
  std::size_t alignment() const { return alignment_; }

  // Operations on all values.

  /// Stores `value` as the variable with index `variable`.
  SlotRef insert(const void* value, int variable);
  /// Returns the value in a slot. It stays in place while the store lives.
  void* valueAt(std::uint32_t slot) { return values_[slot]; }
  const void* valueAt(std::uint32_t slot) const { return values_.at(slot); }
  /// Returns the value in a slot. T is the type of this store.
  template <class T>
  const T& value(std::uint32_t slot) const {
    return values_.as<T>(slot);
  }
  /// Returns the degrees of freedom of the value in a slot.
  int dof(std::uint32_t slot) { return dofOf(values_[slot]); }
  /// Calls typicalSizesOf for the value in a slot.
  void typicalSizes(std::uint32_t slot, double* out) { typicalSizesOf(values_[slot], out); }
  /// Saves all values for `restore`.
  void save();
  /// Restores the values of the last `save`.
  void restore();
  /// Computes x := x [+] step[offset[v] ...] for each variable v of this store with offset[v] < offset[v + 1].
  void applyStep(const std::vector<int>& offset, const double* step);

  /// Returns the index of the slot's variable in the problem; -1 if the slot is free.
  int variable(std::uint32_t slot) const { return variable_[slot]; }
  /// Returns whether the slot still holds the variable that the handle was made for.
  bool isCurrent(SlotRef ref) const {
    return ref.slot < generation_.size() && generation_[ref.slot] == ref.generation &&
           variable_[ref.slot] >= 0;
  }
  /// Returns the reference that handles to the variable in this slot hold.
  SlotRef refTo(std::uint32_t slot) const { return {slot, generation_[slot]}; }
  /// Frees the slot; handles to it become stale.
  void release(std::uint32_t slot);
  /// Copies all slots of a store of the same type into this one, which must be empty.
  void copyFrom(const VariableStoreBase& other);
  /// Returns the generation of each slot; kFree for free ones.
  std::vector<std::uint32_t> generations() const;
  static constexpr std::uint32_t kFree = ~std::uint32_t{0};

 protected:
  VariableStoreBase(std::size_t value_size, std::size_t alignment);
  /// Destroys all values. The derived class must call it in its destructor.
  void clear() noexcept;

 private:
  std::size_t value_size_, alignment_;
  ValueArray values_, saved_;
  std::vector<int> variable_;
  std::vector<std::uint32_t> generation_;
  std::vector<std::uint32_t> free_;
};

template <class T>
class VariableStore final : public VariableStoreBase {
  static_assert(std::is_same_v<mtk::scalar_t<T>, double>,
                "slom: the scalar of an estimated variable must be double");

 public:
  VariableStore();
  ~VariableStore() override;

  std::unique_ptr<VariableStoreBase> makeEmpty() const override;
  std::string typeName() const override;
  std::vector<std::string> componentNames(std::uint32_t slot, const std::string& path) const override;
  std::string valueText(std::uint32_t slot) const override;
  void construct(void* place, const void* value) const override;
  void destroy(void* value) const noexcept override;
  void assign(void* to, const void* from) const override;
  int dofOf(const void* value) const override;
  void boxplus(void* value, const double* d) const override;
  void boxminus(double* out, const void* x, const void* y) const override;
  void boxminusDerivative(const void* x, const void* y, double* D) const override;
  void typicalSizesOf(const void* value, double* out) const override;
  void leftPerturbation(const void* value, double* A) const override;
  void coordinates(const void* value, double* out) const override;
  void visitOrientations(const void* value, OrientationSink& sink) const override;
  void gaugeGenerators(const void* value, WorldRole role, double* out) const override;
};

template <class T>
VariableStore<T>::VariableStore() : VariableStoreBase(sizeof(T), alignof(T)) {}
template <class T>
VariableStore<T>::~VariableStore() {
  clear();
}
template <class T>
std::unique_ptr<VariableStoreBase> VariableStore<T>::makeEmpty() const {
  return std::make_unique<VariableStore>();
}
template <class T>
std::string VariableStore<T>::typeName() const {
  return slom::typeName<T>();
}
template <class T>
std::vector<std::string> VariableStore<T>::componentNames(std::uint32_t slot, const std::string& path) const {
  return mtk::componentNames(value<T>(slot), path);
}
template <class T>
std::string VariableStore<T>::valueText(std::uint32_t slot) const {
  if constexpr (mtk::isWritable<T>()) {
    return detail::textOf(&value<T>(slot), [](std::ostream& os, const void* value) {
      mtk::write(os, *static_cast<const T*>(value));
    });
  } else {
    return "a " + typeName();
  }
}
template <class T>
void VariableStore<T>::construct(void* place, const void* value) const {
  ::new (place) T(*static_cast<const T*>(value));
}
template <class T>
void VariableStore<T>::destroy(void* value) const noexcept {
  static_cast<T*>(value)->~T();
}
template <class T>
void VariableStore<T>::assign(void* to, const void* from) const {
  *static_cast<T*>(to) = *static_cast<const T*>(from);
}
template <class T>
int VariableStore<T>::dofOf(const void* value) const {
  return mtk::dof(*static_cast<const T*>(value));
}
template <class T>
void VariableStore<T>::boxplus(void* value, const double* d) const {
  T& x = *static_cast<T*>(value);
  mtk::boxplus<T>(x, mtk::vectview<const double, mtk::DOF_v<T>>(d, mtk::dof(x)));
}
template <class T>
void VariableStore<T>::boxminus(double* out, const void* x, const void* y) const {
  const T& origin = *static_cast<const T*>(y);
  mtk::boxminus<T>(mtk::vectview<double, mtk::DOF_v<T>>(out, mtk::dof(origin)), *static_cast<const T*>(x),
                   origin);
}
template <class T>
void VariableStore<T>::boxminusDerivative(const void* x, const void* y, double* D) const {
  const int n = dofOf(x);
  for (int i = 0; i < n * n; ++i) D[i] = i % (n + 1) == 0 ? 1 : 0;
  mtk::detail::forEachBasicPart(
      *static_cast<const T*>(y), *static_cast<const T*>(x), 0,
      [&](const auto& from, const auto& to, int at) { detail::writePart(to, from, D + at * n + at, n); });
}
template <class T>
void VariableStore<T>::leftPerturbation(const void* value, double* A) const {
  const int n = dofOf(value);
  for (int i = 0; i < n * n; ++i) A[i] = i % (n + 1) == 0 ? 1 : 0;
  const T& x = *static_cast<const T*>(value);
  detail::writeLeftPerturbation(x, 0, A, n);
}
template <class T>
void VariableStore<T>::coordinates(const void* value, double* out) const {
  slom::coordinates(*static_cast<const T*>(value), out);
}
template <class T>
void VariableStore<T>::visitOrientations(const void* value, OrientationSink& sink) const {
  slom::visitOrientations(*static_cast<const T*>(value), sink);
}
template <class T>
void VariableStore<T>::gaugeGenerators(const void* value, WorldRole role, double* out) const {
  slom::gaugeGenerators(*static_cast<const T*>(value), role, out);
}
template <class T>
void VariableStore<T>::typicalSizesOf(const void* value, double* out) const {
  const T& x = *static_cast<const T*>(value);
  mtk::typicalSizes<T>(mtk::vectview<double, mtk::DOF_v<T>>(out, mtk::dof(x)), x);
}

/// Creates a store for values of type T. It is not inline, and the library instantiates it for frequent types. So files
/// that use these types compile nothing of their stores.
template <class T>
VariableStoreBase* makeVariableStore() {
  return new VariableStore<T>;
}
extern template VariableStoreBase* makeVariableStore<double>();
// With other flags (-march=native) and macros (EIGEN_DONT_ALIGN), Eigen aligns otherwise than in the library.
#if EIGEN_MAX_ALIGN_BYTES == 16 && EIGEN_MAX_STATIC_ALIGN_BYTES == 16
extern template VariableStoreBase* makeVariableStore<Eigen::Vector2d>();
extern template VariableStoreBase* makeVariableStore<Eigen::Vector3d>();
extern template VariableStoreBase* makeVariableStore<Eigen::VectorXd>();
#endif
extern template VariableStoreBase* makeVariableStore<mtk::vect<2>>();
extern template VariableStoreBase* makeVariableStore<mtk::vect<3>>();
extern template VariableStoreBase* makeVariableStore<mtk::Scalar<>>();
extern template VariableStoreBase* makeVariableStore<mtk::SO2<>>();
extern template VariableStoreBase* makeVariableStore<mtk::SO3<>>();
extern template VariableStoreBase* makeVariableStore<mtk::trafo<mtk::SO2<>>>();
extern template VariableStoreBase* makeVariableStore<mtk::trafo<mtk::SO3<>>>();

}  // namespace slom
