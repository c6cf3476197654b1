// Residuals and Jacobians of a pool's measurements: calls of the user's functions, whitening, and the search for
// entries that are not finite.
#include <cstddef>
#include <deque>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "problem/guarded.hpp"
#include "slom/problem/measurement_pool.hpp"

namespace slom {

namespace {
/// Returns whether all x are finite. Sums x * 0, which is NaN for NaN and infinity, in 8 registers, so no sum waits for
/// another.
bool isFinite(const double* x, std::ptrdiff_t n) {
  constexpr int at_once = 8 * Eigen::internal::packet_traits<double>::size;
  using Sums = Eigen::Array<double, at_once, 1>;
  Sums sums = Sums::Zero();
  std::ptrdiff_t i = 0;
  for (; i + at_once <= n; i += at_once) sums += Eigen::Map<const Sums>(x + i) * 0.0;
  return sums.sum() + (Eigen::Map<const Eigen::ArrayXd>(x + i, n - i) * 0.0).sum() == 0.0;
}

/// A guard that points a variable of a measurement to another value.
class AtFirstEstimate {
 public:
  AtFirstEstimate(VariableArgument& variable, const void* value)
      : variable_(variable), original_(variable.pointer()) {
    variable_.setPointer(value);
  }
  AtFirstEstimate(const AtFirstEstimate&) = delete;
  AtFirstEstimate& operator=(const AtFirstEstimate&) = delete;
  ~AtFirstEstimate() { variable_.setPointer(original_); }

 private:
  VariableArgument& variable_;
  const void* original_;
};

[[noreturn]] void raiseWrongLength(const std::string& measurement, int expected, int got) {
  throw Error("slom.residual-length",
              "measurement " + measurement + " returned a residual of length " + std::to_string(got) +
                  " but had length " + std::to_string(expected) +
                  " when it was inserted; return the same length for all values of the variables",
              measurement);
}
}  // namespace

void MeasurementPool::runGuarded(int first, int last, double* r, double* J) {
  int i = first;
  const int got = guarded(i, [&] { return run(i, last, r, J); });
  if (got >= 0) raiseWrongLength(measurementName(i), rows(i), got);
}

int MeasurementPool::evaluate(int first, int last, double* r) {
  runGuarded(first, last, r, nullptr);
  double* const start = r;
  for (int i = first; i < last; ++i) {
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

/// Writes the Jacobians, in the measurements' own units, of the measurements of [first, last) that depend on a variable
/// with a first estimate.
void MeasurementPool::linearizeAtFirstEstimates(int first, int last, double* J) {
  std::vector<double> r;
  for (int i = first; i < last; ++i) {
    if (first_estimates_->hasAny(variables(i), arity_)) {
      std::deque<AtFirstEstimate> redirected;
      for (int k = 0; k < arity_; ++k) {
        if (const void* const point = first_estimates_->of(variables(i)[k]); point != nullptr)
          redirected.emplace_back(argument(i, k), point);
      }
      r.resize(at(rows(i)));
      runGuarded(i, i + 1, r.data(), J);
    }
    J += static_cast<std::ptrdiff_t>(rows(i)) * columns(i);
  }
}

int MeasurementPool::linearize(int first, int last, double* r, double* J) {
  runGuarded(first, last, r, J);
  if (first_estimates_ != nullptr && !first_estimates_->isEmpty()) linearizeAtFirstEstimates(first, last, J);
  double *const start_r = r, *const start_J = J;
  for (int i = first; i < last; ++i) {
    const int n = rows(i), width = columns(i);
    whitenRows(i, r, 1);
    whitenRows(i, J, width);
    r += n;
    J += static_cast<std::ptrdiff_t>(n) * width;
  }
  if (isFinite(start_r, r - start_r) && isFinite(start_J, J - start_J)) return -1;
  r = start_r;
  J = start_J;
  for (int i = first; i < last; ++i) {
    if (!isFinite(r, rows(i)) || !areFreeColumnsFinite(i, J)) return i;
    r += rows(i);
    J += static_cast<std::ptrdiff_t>(rows(i)) * columns(i);
  }
  return -1;
}

bool MeasurementPool::areFreeColumnsFinite(int i, const double* J) const {
  bool finite = true;
  for (int k = 0; k < arity_; ++k) {
    const int variable = variables(i)[k];
    const VariableRecord& record = table_[at(variable)];
    const std::ptrdiff_t length = rows(i), entries = length * record.dof;
    if (active_.isOptimized(variable) && !active_.hasFixed(variable)) {
      finite = finite && isFinite(J, entries);
    } else if (active_.isOptimized(variable)) {
      for (int c = 0; c < record.dof; ++c)
        finite = finite && (active_.isFixed(variable, c) || isFinite(J + c * length, length));
    }
    J += entries;
  }
  return finite;
}

void MeasurementPool::evaluateRaw(int i, double* r) {
  const int got = guarded(i, [&] { return evaluateOne(i, rows(i), r); });
  if (got != rows(i)) raiseWrongLength(measurementName(i), rows(i), got);
}

void MeasurementPool::linearizeRaw(int i, double* r, double* J) { runGuarded(i, i + 1, r, J); }

void MeasurementPool::differenceRaw(int i, double* r, double* J, Differences kind) {
  const int got = guarded(i, [&] { return differentiate(i, rows(i), r, J, kind); });
  if (got != rows(i)) raiseWrongLength(measurementName(i), rows(i), got);
}

}  // namespace slom
