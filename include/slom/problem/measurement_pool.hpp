/// All measurements of one kind, lying together: variables, noise and losses in contiguous arrays. The untyped part of the library
/// evaluates and differentiates them a batch at a time.
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
  VariableStoreBase* store = nullptr;  ///< null: this row is free
  std::uint32_t slot = 0;
  int dof = 0;
  int uses = 0;      ///< measurements that depend on it
  long serial = 0;   ///< running number of insertion
  std::string name;  ///< the user's, may be empty
};

/// How differences approximate derivatives by a component, with steps h.
enum class Differences {
  central,       ///< (f(x + h) - f(x - h)) / 2h
  extrapolated,  ///< central ones of two steps, larger: an error of order h^4 in place of h^2
  forward,       ///< (f(x + h) - f(x)) / h: not the same where f has a kink
};

/// A user's function threw: which measurement of the pool, and what.
struct MeasurementThrew {
  int measurement;
  std::exception_ptr exception;
};

class MeasurementPool;
class RuntimeMeasurement;

/// What all measurements of a type have in common.
struct MeasurementType {
  const std::type_info* id;
  int arity;  ///< number of variables that each measurement depends on
  int rows;   ///< length of the residual, Dynamic when each has its own
  const int*
      dof;  ///< degrees of freedom of each variable, Dynamic when known only at run time; null: all are
  DerivativeSource derivatives;
  std::string (*const* variable_type)();  ///< name of the type of each variable; null: the stores know it
  std::string (*name)();                  ///< name of the measurements
  /// The caller owns the pool.
  MeasurementPool* (*make_pool)(const std::string& name, const std::string& label,
                                const MeasurementType& type, const std::vector<VariableRecord>& table,
                                const ActiveSet& active);
  bool states_noise = false;  ///< residuals are in units of their standard deviations
};

class MeasurementPool {
 public:
  /// Empty, for measurements of variables in `table`.
  MeasurementPool(const std::string& name, const std::string& label, const MeasurementType& type,
                  const std::vector<VariableRecord>& table, const ActiveSet& active);
  virtual ~MeasurementPool();
  MeasurementPool(const MeasurementPool&) = delete;
  MeasurementPool& operator=(const MeasurementPool&) = delete;

  /// The name of the group, for messages: the label, or that of the type.
  const std::string& name() const { return name_; }
  /// The user's label of the measurements; empty: none, `name` is made of their type's.
  const std::string& label() const { return label_; }
  /// What all measurements of the pool have in common.
  const MeasurementType& type() const { return type_; }
  /// Number of the pool's group. A table has a row for each group; pools of one run-time kind and one label, which differ in arity
  /// alone, are one group with one name.
  int group() const { return group_; }
  /// Its place among the problem's pools.
  int index() const { return index_; }
  /// `Gravity #12`: the name and the running number of insertion into this group, from 1.
  std::string measurementName(int i) const;
  /// The name that the measurement inserted next will have.
  std::string nextName() const;
  int size() const { return static_cast<int>(slot_.size()); }
  /// Number of variables that each measurement depends on.
  int arity() const { return arity_; }
  /// Indices of the variables of measurement i: arity() entries.
  const int* variables(int i) const { return variables_.data() + at(i) * at(arity_); }
  /// Length of the residual of measurement i.
  int rows(int i) const { return type_.rows != Dynamic ? type_.rows : rows_[at(i)]; }
  /// Sum of the lengths of all residuals.
  int totalRows() const { return total_rows_; }
  /// Degrees of freedom of all variables of measurement i, fixed ones included.
  int columns(int i) const { return columns_ != Dynamic ? columns_ : sumOfDof(i); }
  /// Whether all measurements have the same `rows` and `columns`, known from type() alone.
  bool hasFixedSizes() const { return type_.rows != Dynamic && columns_ != Dynamic; }
  /// Writes the lengths of the residuals of [first, last), and the degrees of freedom of all their variables.
  void sizes(int first, int last, int* rows, int* dof) const;
  /// The loss of measurement i; null: least squares. evaluate and linearize know nothing of it.
  const Loss* lossOf(int i) const { return loss_[at(i)]; }
  /// W of measurement i: residuals are multiplied by it.
  std::pair<WhiteningKind, const double*> whitening(int i) const {
    return {noise_kind_[at(i)], noise_.data() + noise_at_[at(i)]};
  }
  /// Multiplies the standard deviations of each measurement by a factor, one for each; infinite: W becomes 0.
  void scaleSigmas(const std::vector<double>& factors);
  /// The noise of all measurements, to go back to by restoreNoise().
  struct SavedNoise {
    std::vector<WhiteningKind> kind;
    std::vector<std::size_t> place;
    std::vector<double> numbers;
  };
  /// A copy of it.
  SavedNoise saveNoise() const;
  /// Of the same measurements in the same order.
  void restoreNoise(SavedNoise&& noise) noexcept;
  /// Number of measurements that have a loss.
  int lossCount() const { return loss_count_; }

  /// Number of the key of measurement i in this dimension of Problem::groups(); -1: none.
  int groupKey(int dimension, int i) const;
  /// Puts measurement i into a group of this dimension, by the number of its key.
  void setGroupKey(int dimension, int i, int key);

  /// Where derivatives come from.
  DerivativeSource derivatives() const { return type_.derivatives; }
  /// The relative step that slom::differences states for the derivatives; 0: none.
  virtual double statedStep() const { return 0; }
  /// Measurement i of a pool whose kind is known at run time; null for others.
  virtual const RuntimeMeasurement* runtimeMeasurement(int i) const;

  /// Whitened residuals of [first, last), one after the other. Returns the first measurement whose residual is not
  /// finite, -1 when all are.
  int evaluate(int first, int last, double* r);
  /// As evaluate, and whitened Jacobians: for each measurement rows x columns, column-major, one after the other; the
  /// columns of fixed variables are left as they are. Jacobians are those at first estimates of variables that have one. Also returns a
  /// measurement whose Jacobian is not finite.
  int linearize(int first, int last, double* r, double* J);
  /// The residual of one measurement in its own units.
  void evaluateRaw(int i, double* r);
  /// Residual and Jacobian of one measurement in its own units; columns of fixed variables may be left as they are.
  void linearizeRaw(int i, double* r, double* J);
  /// The same by differences.
  void differenceRaw(int i, double* r, double* J, Differences kind = Differences::extrapolated);

  /// Moves `measurement`, which is of the pool's type, into the pool. Throws, with nothing changed, for bad noise, a bad
  /// loss or when a residual of run-time length cannot be evaluated.
  SlotRef insert(void* measurement, const int* variables, const NoiseView& noise, const Loss& loss);
  /// Index of the measurement with this handle; throws [slom.stale-handle].
  int indexOf(SlotRef ref) const;
  /// The same of one that is there.
  int indexOfPresent(SlotRef ref) const { return index_of_slot_[ref.slot]; }
  /// Whether a measurement has this handle.
  bool has(SlotRef ref) const {
    return ref.slot < generation_.size() && generation_[ref.slot] == ref.generation &&
           index_of_slot_[ref.slot] >= 0;
  }
  /// Running number of insertion of measurement i into its group, from 1.
  long serial(int i) const { return serial_[at(i)]; }
  /// The handle of measurement i.
  SlotRef handleOf(int i) const { return {slot_[at(i)], generation_[slot_[at(i)]]}; }
  /// What handles to its measurements hold.
  const std::shared_ptr<PoolPresence>& presence() const { return presence_; }
  /// Copies all measurements of a pool of the same type into this one, which is empty; `handles` are this problem's variables, by index.
  /// Throws [slom.not-copyable].
  void copyFrom(const MeasurementPool& other, const std::vector<VariableHandle>& handles);
  /// Whether the measurement was in the pool that this one is a copy of, or in one that that was a copy of, when it was copied.
  bool isFromOrigin(const MeasurementHandle& id) const;
  /// Removes measurement i; the last one takes its place.
  void remove(int i);
  /// The first estimates of the variables; without them there are none.
  void setFirstEstimates(const FirstEstimates& first_estimates) { first_estimates_ = &first_estimates; }
  /// Puts this pool, which is empty, at this place among the problem's and into the group with this number: its first one, or another when `first` is not null.
  void joinGroup(int index, int group, MeasurementPool* first) {
    index_ = index;
    group_ = group;
    inserted_ = first != nullptr ? first->inserted_ : &own_inserted_;
  }

 protected:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  // What depends on the type of the measurements. User code runs in the first three alone; what it throws, they let pass.

  /// Writes residuals of [i, last), one after the other, and their derivatives unless J is null, in the measurements' own
  /// units; i says which one is at work. Stops at a residual whose length is not rows(i); returns its length, or -1.
  virtual int run(int& i, int last, double* r, double* J) = 0;
  /// The residual of measurement i, `rows` entries. Returns its length; writes nothing when that is another one.
  virtual int evaluateOne(int i, int rows, double* r) = 0;
  /// Length of this measurement's residual, which is evaluated.
  virtual int lengthOf(const void* measurement) const = 0;
  /// Appends the measurement, which is moved from.
  virtual void push(void* measurement) = 0;
  /// Appends a copy of measurement i of a pool of the same type, over these variables; false: it cannot be copied.
  virtual bool pushCopy(const MeasurementPool& from, int i, const std::vector<AnyVarID>& variables) = 0;
  /// The last measurement takes the place of measurement i.
  virtual void moveLastTo(int i) = 0;
  /// Variable k of measurement i.
  virtual VariableArgument& argument(int i, int k) = 0;

  /// Residual and differences by the free variables of measurement i. Returns what evaluateOne does.
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

  /// Makes room for one more, so that `append` cannot fail.
  void reserveOne();
  /// Appends W of the noise (or finds it equal to the last one's); returns where it lies.
  std::size_t appendNoise(const NoiseView& noise, int rows, WhiteningKind& kind);
  /// Where the pool keeps this loss, null for none. Throws [slom.bad-loss].
  const Loss* keepLoss(const Loss& loss);
  /// Registers a measurement that has just been appended.
  SlotRef append(const int* variables, WhiteningKind kind, std::size_t noise_at, const Loss* loss);
  void compact();
  void compactNoise();

  std::string name_, label_;
  const MeasurementType& type_;
  int arity_;
  int columns_;  // Dynamic when it depends on the measurement
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
  detail::Pimpl<Losses> losses_;  // the different ones
  int loss_count_ = 0;
  struct GroupKeys;
  detail::Pimpl<GroupKeys> group_keys_;  // null: no measurement ever had one
  std::vector<long> serial_;
  std::vector<std::uint32_t> slot_;        // slot of each measurement
  std::vector<int> index_of_slot_;         // -1: free
  std::vector<std::uint32_t> generation_;  // generation of each slot
  std::vector<std::uint32_t> free_slots_;
  std::shared_ptr<PoolPresence> presence_;
  struct Origins;
  detail::Pimpl<Origins> origins_;  // null: it is not a copy
  int index_ = 0, group_ = 0;
  long own_inserted_ = 0;
  long* inserted_ = &own_inserted_;  // into the group: that of its first pool, which lives as long
  int removed_since_compaction_ = 0;
};

}  // namespace slom
