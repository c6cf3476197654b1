/// MeasurementPool: all measurements of one kind, with variables, noise and losses in contiguous arrays. The untyped
/// part of the library evaluates and differentiates them a batch at a time.
#pragma once

#include <cstdint>
#include <exception>
#include <memory>
#include <string>
#include <typeinfo>
#include <utility>
#include <vector>

#include "slom/model/any_var_id.hpp"
#include "slom/model/function.hpp"
#include "slom/model/loss.hpp"
#include "slom/model/meas_id.hpp"
#include "slom/model/measurement.hpp"
#include "slom/model/noise.hpp"
#include "slom/model/pimpl.hpp"
#include "slom/model/variable_store.hpp"
#include "slom/problem/active_set.hpp"
#include "slom/problem/first_estimates.hpp"

namespace slom {

/// A row of the problem's table of variables.
struct VariableRecord {
  VariableStoreBase* store = nullptr;  ///< null: the row is free
  std::uint32_t slot = 0;
  int dof = 0;
  int uses = 0;      ///< number of measurements that depend on it
  long serial = 0;   ///< running number of insertion
  std::string name;  ///< given by the user, may be empty
};

/// How differences approximate the derivatives with respect to a component, with steps h.
enum class Differences {
  central,       ///< (f(x + h) - f(x - h)) / 2h
  extrapolated,  ///< central differences with two larger steps: error of order h^4 instead of h^2
  forward,       ///< (f(x + h) - f(x)) / h: differs if f has a kink
};

/// An exception from a user's function, with the measurement of the pool.
struct MeasurementThrew {
  int measurement;
  std::exception_ptr exception;
};

class MeasurementPool;
class RuntimeMeasurement;

/// Common properties of all measurements of a type.
struct MeasurementType {
  const std::type_info* id;
  int arity;  ///< number of variables that each measurement depends on
  int rows;   ///< length of the residual, Dynamic if each measurement has its own
  /// Degrees of freedom of each variable, Dynamic if known only at run time; null: Dynamic for all.
  const int* dof;
  DerivativeSource derivatives;
  std::string (*const* variable_type)();  ///< name of the type of each variable; null: the stores have it
  std::string (*name)();                  ///< name of the measurements
  /// Creates a pool, which the caller owns.
  MeasurementPool* (*make_pool)(const std::string& name, const std::string& label,
                                const MeasurementType& type, const std::vector<VariableRecord>& table,
                                const ActiveSet& active);
  bool states_noise = false;  ///< residuals are in units of their standard deviations
  /// Object that distinguishes pools with the same id; null: none. It must live as long as the pool.
  const void* code = nullptr;
};

class MeasurementPool {
 public:
  /// Creates an empty pool for measurements of variables in `table`.
  MeasurementPool(const std::string& name, const std::string& label, const MeasurementType& type,
                  const std::vector<VariableRecord>& table, const ActiveSet& active);
  virtual ~MeasurementPool();
  MeasurementPool(const MeasurementPool&) = delete;
  MeasurementPool& operator=(const MeasurementPool&) = delete;

  /// Returns the name of the group for messages: the label or the name of the type.
  const std::string& name() const { return name_; }
  /// Returns the user's label of the measurements; empty: none, and `name` comes from their type.
  const std::string& label() const { return label_; }
  /// Returns the common properties of all measurements of the pool.
  const MeasurementType& type() const { return type_; }
  /// Returns the number of the pool's group. A table has one row for each group. Pools of one run-time kind and label
  /// that differ only in arity are one group with one name.
  int group() const { return group_; }
  /// Returns the pool's place among the problem's pools.
  int index() const { return index_; }
  /// Returns text such as `Gravity #12`: the name and the running number of insertion into this group, from 1.
  std::string measurementName(int i) const;
  /// Returns the name that the next inserted measurement will have.
  std::string nextName() const;
  int size() const { return static_cast<int>(slot_.size()); }
  /// Returns the number of variables that each measurement depends on.
  int arity() const { return arity_; }
  /// Returns the indices of the variables of measurement i: arity() entries.
  const int* variables(int i) const { return variables_.data() + at(i) * at(arity_); }
  /// Returns the length of the residual of measurement i.
  int rows(int i) const { return type_.rows != Dynamic ? type_.rows : rows_[at(i)]; }
  /// Returns the sum of the lengths of all residuals.
  int totalRows() const { return total_rows_; }
  /// Returns the degrees of freedom of all variables of measurement i, including fixed ones.
  int columns(int i) const { return columns_ != Dynamic ? columns_ : sumOfDof(i); }
  /// Returns whether all measurements have the same `rows` and `columns`, known from type() alone.
  bool hasFixedSizes() const { return type_.rows != Dynamic && columns_ != Dynamic; }
  /// Writes the lengths of the residuals of [first, last) and the degrees of freedom of all their variables.
  void sizes(int first, int last, int* rows, int* dof) const;
  /// Returns the loss of measurement i; null: least squares. evaluate and linearize ignore losses.
  const Loss* lossOf(int i) const { return loss_[at(i)]; }
  /// Returns W of measurement i, by which its residual is multiplied.
  std::pair<WhiteningKind, const double*> whitening(int i) const {
    return {noise_kind_[at(i)], noise_.data() + noise_at_[at(i)]};
  }
  /// Multiplies the standard deviations of each measurement by its factor. If the factor is infinite, W becomes 0.
  void scaleSigmas(const std::vector<double>& factors);
  /// The noise of all measurements, for restoreNoise().
  struct SavedNoise {
    std::vector<WhiteningKind> kind;
    std::vector<std::size_t> place;
    std::vector<double> numbers;
  };
  /// Returns a copy of the noise.
  SavedNoise saveNoise() const;
  /// Restores the noise. The measurements and their order must be those of saveNoise().
  void restoreNoise(SavedNoise&& noise) noexcept;
  /// Returns the number of measurements with a loss.
  int lossCount() const { return loss_count_; }

  /// Returns the number of the key of measurement i in this dimension of Problem::groups(); -1: none.
  int groupKey(int dimension, int i) const;
  /// Puts measurement i into a group of this dimension, by the number of its key.
  void setGroupKey(int dimension, int i, int key);

  /// Returns the source of the derivatives.
  DerivativeSource derivatives() const { return type_.derivatives; }
  /// Returns the relative step that slom::differences states for the derivatives; 0: none.
  virtual double statedStep() const { return 0; }
  /// Returns measurement i of a pool whose kind is known only at run time; null for other pools.
  virtual const RuntimeMeasurement* runtimeMeasurement(int i) const;

  /// Writes the whitened residuals of [first, last), one after another. Returns the first measurement whose residual is
  /// not finite, or -1 if all are finite.
  int evaluate(int first, int last, double* r);
  /// Does what evaluate does and writes whitened Jacobians: for each measurement rows x columns, column-major, one
  /// after another. Columns of fixed variables are left unchanged. For variables with a first estimate, Jacobians are
  /// taken there. Also returns a measurement whose Jacobian is not finite.
  int linearize(int first, int last, double* r, double* J);
  /// Writes the residual of one measurement in its own units.
  void evaluateRaw(int i, double* r);
  /// Writes residual and Jacobian of one measurement in its own units. Columns of fixed variables may be left
  /// unchanged.
  void linearizeRaw(int i, double* r, double* J);
  /// Writes residual and Jacobian of one measurement, by differences.
  void differenceRaw(int i, double* r, double* J, Differences kind = Differences::extrapolated);

  /// Moves `measurement`, which must be of the pool's type, into the pool. Throws, with nothing changed, for bad noise,
  /// a bad loss, or if a residual of run-time length cannot be evaluated.
  SlotRef insert(void* measurement, const int* variables, const NoiseView& noise, const Loss& loss);
  /// Returns the index of the measurement with this handle. Throws [slom.stale-handle].
  int indexOf(SlotRef ref) const;
  /// Returns the index of a measurement that is known to exist.
  int indexOfPresent(SlotRef ref) const { return index_of_slot_[ref.slot]; }
  /// Returns whether a measurement has this handle.
  bool has(SlotRef ref) const {
    return ref.slot < generation_.size() && generation_[ref.slot] == ref.generation &&
           index_of_slot_[ref.slot] >= 0;
  }
  /// Returns the running number of insertion of measurement i into its group, from 1.
  long serial(int i) const { return serial_[at(i)]; }
  /// Returns the handle of measurement i.
  SlotRef handleOf(int i) const { return {slot_[at(i)], generation_[slot_[at(i)]]}; }
  /// Returns the presence of the pool, which handles to its measurements hold.
  const std::shared_ptr<PoolPresence>& presence() const { return presence_; }
  /// Copies all measurements of a pool of the same type into this pool, which must be empty. `handles` are the
  /// variables of this problem, by index. Throws [slom.not-copyable].
  void copyFrom(const MeasurementPool& other, const std::vector<VariableHandle>& handles);
  /// Returns whether the measurement was in this pool's original, or in an original of that one, at the time of the
  /// copy.
  bool isFromOrigin(const MeasurementHandle& id) const;
  /// Removes measurement i; the last measurement takes its place.
  void remove(int i);
  /// Sets the first estimates of the variables; without this call there are none.
  void setFirstEstimates(const FirstEstimates& first_estimates) { first_estimates_ = &first_estimates; }
  /// Puts this pool, which must be empty, at place `index` among the problem's pools and into the group with this
  /// number. `first` is the first pool of the group; null: this pool is the first.
  void joinGroup(int index, int group, MeasurementPool* first) {
    index_ = index;
    group_ = group;
    inserted_ = first != nullptr ? first->inserted_ : &own_inserted_;
  }

 protected:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  // Functions that depend on the type of the measurements. Only the first three run user code, whose exceptions pass
  // through.

  /// Writes residuals of [i, last), one after another, and their derivatives unless J is null, in the measurements' own
  /// units. `i` is the measurement in progress. Stops at a residual whose length is not rows(i) and returns its length;
  /// otherwise returns -1.
  virtual int run(int& i, int last, double* r, double* J) = 0;
  /// Writes the residual of measurement i, `rows` entries. Returns its length; if that differs, writes nothing.
  virtual int evaluateOne(int i, int rows, double* r) = 0;
  /// Returns the length of this measurement's residual, which it evaluates.
  virtual int lengthOf(const void* measurement) const = 0;
  /// Appends the measurement by moving it.
  virtual void push(void* measurement) = 0;
  /// Appends a copy of measurement i of a pool of the same type, over these variables. Returns false if it cannot be
  /// copied.
  virtual bool pushCopy(const MeasurementPool& from, int i, const std::vector<AnyVarID>& variables) = 0;
  /// Moves the last measurement to the place of measurement i.
  virtual void moveLastTo(int i) = 0;
  /// Returns variable k of measurement i.
  virtual VariableArgument& argument(int i, int k) = 0;

  /// Writes the residual and differences with respect to the free variables of measurement i. Returns what evaluateOne
  /// returns.
  int differentiate(int i, int rows, double* r, double* J, Differences kind,
                    const DifferenceStep* step = nullptr);

 private:
  int sumOfDof(int i) const;
  bool areFreeColumnsFinite(int i, const double* J) const;
  void whitenRows(int i, double* m, int cols) const {
    if (noise_kind_[at(i)] == WhiteningKind::unit) return;
    whiten(noise_kind_[at(i)], noise_.data() + noise_at_[at(i)], m, rows(i), cols);
  }
  void runGuarded(int first, int last, double* r, double* J);
  void linearizeAtFirstEstimates(int first, int last, double* J);

  /// Reserves memory for one more, so that `append` cannot fail.
  void reserveOne();
  /// Appends W of the noise unless it equals the last one. Returns the place of W.
  std::size_t appendNoise(const NoiseView& noise, int rows, WhiteningKind& kind);
  /// Returns the place of this loss in the pool, null for no loss. Throws [slom.bad-loss].
  const Loss* keepLoss(const Loss& loss);
  /// Registers a measurement that has just been appended.
  SlotRef append(const int* variables, WhiteningKind kind, std::size_t noise_at, const Loss* loss);
  void compact();
  void compactNoise();

  std::string name_, label_;
  const MeasurementType& type_;
  int arity_;
  int columns_;  // Dynamic if it depends on the measurement
  const std::vector<VariableRecord>& table_;
  const ActiveSet& active_;
  const FirstEstimates* first_estimates_ = nullptr;
  std::vector<int> variables_;
  std::vector<int> rows_;  // only for residuals of run-time length
  int total_rows_ = 0;
  std::vector<WhiteningKind> noise_kind_;
  std::vector<std::size_t> noise_at_;
  std::vector<double> noise_;
  std::vector<const Loss*> loss_;  // into losses_
  struct Losses;
  detail::Pimpl<Losses> losses_;  // the different losses
  int loss_count_ = 0;
  struct GroupKeys;
  detail::Pimpl<GroupKeys> group_keys_;  // null: no measurement ever had a key
  std::vector<long> serial_;
  std::vector<std::uint32_t> slot_;        // slot of each measurement
  std::vector<int> index_of_slot_;         // -1: free
  std::vector<std::uint32_t> generation_;  // generation of each slot
  std::vector<std::uint32_t> free_slots_;
  std::shared_ptr<PoolPresence> presence_;
  struct Origins;
  detail::Pimpl<Origins> origins_;  // null: the pool is not a copy
  int index_ = 0, group_ = 0;
  long own_inserted_ = 0;
  long* inserted_ = &own_inserted_;  // counter of the group, in its first pool, which lives as long
  int removed_since_compaction_ = 0;
};

}  // namespace slom
