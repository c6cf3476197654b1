/// All measurements of one type, lying together: variables, noise, losses and data in contiguous arrays. The untyped part of
/// the library evaluates and differentiates them a batch at a time.
#pragma once

#include <array>
#include <cstdint>
#include <exception>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "slom/model/differentiate.hpp"
#include "slom/model/function.hpp"
#include "slom/model/loss.hpp"
#include "slom/model/noise.hpp"
#include "slom/model/variable_store.hpp"

namespace slom {

/// A row of the problem's table of variables.
struct VariableRecord {
  VariableStoreBase* store = nullptr;  ///< null: this row is free
  std::uint32_t slot = 0;
  int dof = 0;
  bool optimize = true;
  int uses = 0;      ///< measurements that depend on it
  long serial = 0;   ///< running number of insertion
  std::string name;  ///< the user's, may be empty
};

/// A user's function threw: which measurement of the pool, and what.
struct MeasurementThrew {
  int measurement;
  std::exception_ptr exception;
};

class MeasurementPool {
 public:
  MeasurementPool(std::string name, int arity, const std::vector<VariableRecord>& table)
      : name_(std::move(name)), arity_(arity), table_(table) {}
  virtual ~MeasurementPool() = default;
  MeasurementPool(const MeasurementPool&) = delete;
  MeasurementPool& operator=(const MeasurementPool&) = delete;

  const std::string& name() const { return name_; }
  /// `Gravity #12`: the name and the running number of insertion into this pool, from 1.
  std::string measurementName(int i) const { return name_ + " #" + std::to_string(serial_[at(i)]); }
  /// The name that the measurement inserted next will have.
  std::string nextName() const { return name_ + " #" + std::to_string(inserted_ + 1); }
  int size() const { return static_cast<int>(slot_.size()); }
  /// Number of variables that each measurement depends on.
  int arity() const { return arity_; }
  /// Indices of the variables of measurement i: arity() entries.
  const int* variables(int i) const { return variables_.data() + at(i) * at(arity_); }
  /// Length of the residual of measurement i.
  virtual int rows(int i) const = 0;
  /// Degrees of freedom of all variables of measurement i, fixed ones included.
  virtual int columns(int i) const = 0;
  /// Writes the lengths of the residuals of [first, last), and the degrees of freedom of all their variables.
  virtual void sizes(int first, int last, int* rows, int* dof) const = 0;
  /// The loss of measurement i; null: least squares. evaluate and linearize know nothing of it.
  const Loss* lossOf(int i) const { return loss_[at(i)]; }
  /// Number of measurements that have a loss.
  int lossCount() const { return loss_count_; }

  /// Where derivatives come from.
  virtual DerivativeSource derivatives() const = 0;

  /// Whitened residuals of [first, last), one after the other. Returns the first measurement whose residual is not
  /// finite, -1 when all are.
  virtual int evaluate(int first, int last, double* r) = 0;
  /// As evaluate, and whitened Jacobians: for each measurement rows x columns, column-major, one after the other; the
  /// columns of fixed variables are left as they are. Also returns a measurement whose Jacobian is not finite.
  virtual int linearize(int first, int last, double* r, double* J) = 0;
  /// The residual of one measurement in its own units.
  virtual void evaluateRaw(int i, double* r) = 0;

  /// Index of the measurement with this handle; throws [slom.stale-handle].
  int indexOf(SlotRef ref) const;
  /// Removes measurement i; the last one takes its place.
  void remove(int i);

 protected:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  const std::vector<VariableRecord>& table() const { return table_; }
  bool isFree(int variable) const { return table_[at(variable)].optimize; }

  /// Books a measurement whose data the derived class has just appended.
  SlotRef append(const int* variables, WhiteningKind kind, std::size_t noise_at, const Loss* loss);
  /// Makes room for one more, so that `append` cannot fail.
  void reserveOne();
  /// Appends W of the noise (or finds it equal to the last one's); returns where it lies.
  std::size_t appendNoise(const NoiseView& noise, int rows, WhiteningKind& kind);
  /// Where the pool keeps this loss, null for none. Throws [slom.bad-loss].
  const Loss* keepLoss(const Loss& loss);
  void whitenRows(int i, double* m, int cols) const {
    if (noise_kind_[at(i)] == WhiteningKind::unit) return;
    whiten(noise_kind_[at(i)], noise_.data() + noise_at_[at(i)], m, rows(i), cols);
  }
  virtual void moveLastTo(int i) = 0;

  /// Runs the user's function for measurement i; what it throws becomes a MeasurementThrew.
  template <class F>
  static void guarded(int i, const F& f) {
    try {
      f();
    } catch (const MeasurementThrew&) {
      throw;
    } catch (const Error&) {
      throw;
    } catch (...) {
      throw MeasurementThrew{i, std::current_exception()};
    }
  }

 private:
  void compact();
  void compactNoise();

  std::string name_;
  int arity_;
  const std::vector<VariableRecord>& table_;
  std::vector<int> variables_;
  std::vector<WhiteningKind> noise_kind_;
  std::vector<std::size_t> noise_at_;
  std::vector<double> noise_;
  std::vector<const Loss*> loss_;  // into losses_
  std::set<Loss> losses_;          // the different ones
  int loss_count_ = 0;
  std::vector<long> serial_;
  std::vector<std::uint32_t> slot_;        // of each measurement
  std::vector<int> index_of_slot_;         // -1: free
  std::vector<std::uint32_t> generation_;  // of each slot
  std::vector<std::uint32_t> free_slots_;
  long inserted_ = 0;
  int removed_since_compaction_ = 0;
};

template <Measurement M>
class TypedPool final : public MeasurementPool {
  static constexpr int kRows = M::residual_dim;
  using Args = decltype(std::declval<M&>().variableArgs());
  static constexpr int kArity = static_cast<int>(std::tuple_size_v<Args>);
  static constexpr auto kDof = []<class... T>(std::type_identity<std::tuple<VarArg<T>&...>>) {
    return std::array<int, sizeof...(T)>{mtk::DOF_v<T>...};
  }(std::type_identity<Args>{});
  static constexpr bool kHasFixedDof = [] {
    bool fixed = true;
    for (const int dof : kDof) fixed = fixed && dof != Dynamic;
    return fixed;
  }();
  static constexpr int kColumns = [] {
    int sum = 0;
    for (const int dof : kDof) sum += dof;
    return sum;
  }();

 public:
  TypedPool(std::string name, const std::vector<VariableRecord>& table)
      : MeasurementPool(std::move(name), kArity, table) {}

  /// Throws, with nothing changed, for bad noise, a bad loss or when a residual of run-time length cannot be evaluated.
  SlotRef insert(M measurement, const int* variables, const NoiseView& noise, const Loss& loss) {
    int rows = kRows;
    if constexpr (kRows == Dynamic) {
      Residual<kRows> ret;
      guarded(size(), [&] { measurement.evaluate(ret); });
      rows = static_cast<int>(ret.size());
      if (rows_.size() == rows_.capacity()) rows_.reserve(2 * rows_.size() + 1);
    }
    reserveOne();
    const Loss* const kept_loss = keepLoss(loss);
    WhiteningKind kind = WhiteningKind::unit;
    const std::size_t noise_at = appendNoise(noise, rows, kind);
    measurements_.push_back(std::move(measurement));
    if constexpr (kRows == Dynamic) rows_.push_back(rows);
    return append(variables, kind, noise_at, kept_loss);
  }

  int rows(int i) const override {
    if constexpr (kRows == Dynamic) {
      return rows_[at(i)];
    } else {
      return kRows;
    }
  }

  int columns(int i) const override {
    if constexpr (kHasFixedDof) {
      return kColumns;
    } else {
      int sum = 0;
      for (int k = 0; k < kArity; ++k) sum += table()[at(variables(i)[k])].dof;
      return sum;
    }
  }
  void sizes(int first, int last, int* row, int* dof) const override {
    for (int i = first; i < last; ++i) {
      *row++ = rows(i);
      for (int k = 0; k < kArity; ++k) *dof++ = kHasFixedDof ? kDof[k] : table()[at(variables(i)[k])].dof;
    }
  }

  DerivativeSource derivatives() const override {
    if constexpr (requires { M::derivatives; }) {
      return M::derivatives;
    } else {
      return DerivativeSource::numeric;
    }
  }

  int evaluate(int first, int last, double* r) override {
    double* const start = r;
    evaluateAtOnce(first, last, r, nullptr);
    for (int i = first; i < last; ++i) {
      if constexpr (!isVectorized()) evaluateRaw(i, r);
      whitenRows(i, r, 1);
      r += rows(i);
    }
    if (isFinite(start, r - start)) return -1;
    r = start;
    for (int i = first; i < last; r += rows(i++)) {
      if (!isFinite(r, rows(i))) return i;
    }
    return -1;
  }

  int linearize(int first, int last, double* r, double* J) override {
    double *const start_r = r, *const start_J = J;
    evaluateAtOnce(first, last, r, J);
    for (int i = first; i < last; ++i) {
      const int n = rows(i), width = columns(i);
      if constexpr (!isVectorized()) guarded(i, [&] { linearizeRaw(i, n, r, J); });
      whitenRows(i, r, 1);
      whitenRows(i, J, width);
      r += n;
      J += static_cast<std::ptrdiff_t>(n) * width;
    }
    if (isFinite(start_r, r - start_r) && isFinite(start_J, J - start_J)) return -1;
    r = start_r;
    J = start_J;
    for (int i = first; i < last; ++i) {
      if (!isFinite(r, rows(i)) || !areFreeColumnsFinite(i, rows(i), J)) return i;
      r += rows(i);
      J += static_cast<std::ptrdiff_t>(rows(i)) * columns(i);
    }
    return -1;
  }

  void evaluateRaw(int i, double* r) override {
    Residual<kRows> ret(rows(i));
    guarded(i, [&] { evaluatePoisoned(measurements_[at(i)], ret); });
    if (ret.size() != rows(i)) detail::raiseWrongLength(measurementName(i), rows(i), ret.size());
    std::copy(ret.data(), ret.data() + ret.size(), r);
  }

 private:
  static bool isFinite(const double* x, std::ptrdiff_t n) {
    return (Eigen::Map<const Eigen::ArrayXd>(x, n) * 0.0).sum() == 0.0;  // NaN for NaN and infinities
  }

  static constexpr bool isVectorized() {
    if constexpr (requires { M::vectorized; }) {
      return M::vectorized;
    } else {
      return false;
    }
  }
  /// Vectorised measurements: residuals of [first, last), derivatives too unless J is null, in their own units.
  void evaluateAtOnce([[maybe_unused]] int first, [[maybe_unused]] int last, [[maybe_unused]] double* r,
                      [[maybe_unused]] double* J) {
    if constexpr (isVectorized()) {
      guarded(first, [&] { M::evaluateMany(measurements_.data() + first, last - first, r, J); });
    }
  }

  /// Residual and Jacobian in the measurement's own units; the columns of fixed variables may be left as they are.
  void linearizeRaw(int i, int rows, double* r, double* J) {
    M& measurement = measurements_[at(i)];
    if constexpr (requires { measurement.linearize(rows, r, J); }) {
      const int got = measurement.linearize(rows, r, J);
      if (got != rows) detail::raiseWrongLength(measurementName(i), rows, got);
    } else {
      evaluateRaw(i, r);
      const int* variable = variables(i);
      const auto one = [&](auto& arg) {
        if (isFree(*variable)) differentiate(measurement, arg, rows, J);
        J += static_cast<std::ptrdiff_t>(rows) * table()[at(*variable)].dof;
        ++variable;
      };
      std::apply([&](auto&... arg) { (one(arg), ...); }, measurement.variableArgs());
    }
  }
  bool areFreeColumnsFinite(int i, int rows, const double* J) const {
    bool finite = true;
    for (int k = 0; k < kArity; ++k) {
      const VariableRecord& record = table()[at(variables(i)[k])];
      if (record.optimize) finite = finite && isFinite(J, rows * record.dof);
      J += static_cast<std::ptrdiff_t>(rows) * record.dof;
    }
    return finite;
  }

  void moveLastTo(int i) override {
    if (i != size() - 1) {  // by construction: callables with captures cannot be assigned
      std::destroy_at(&measurements_[at(i)]);
      std::construct_at(&measurements_[at(i)], std::move(measurements_.back()));
    }
    measurements_.pop_back();
    if constexpr (kRows == Dynamic) {
      rows_[at(i)] = rows_.back();
      rows_.pop_back();
    }
  }

  std::vector<M> measurements_;
  std::vector<int> rows_;  // only for residuals of run-time length
};

}  // namespace slom
