/// What linearised measurements go to.
#pragma once

#include <span>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// Whitened residuals and Jacobians of the measurements [first, first + count) of one group, reweighted by their losses.
struct JacobianBatch {
  int group = 0;
  int first = 0;
  int count = 0;
  const int* rows = nullptr;  ///< count entries: length of each residual
  const int* dof = nullptr;   ///< count x arity: columns of each variable
  const double* r = nullptr;  ///< residuals, one after the other
  const double* J =
      nullptr;  ///< for each measurement rows x (sum of its dof), column-major, one after the other;
                ///< columns of fixed variables hold nothing meaningful
};

/// A measurement in the order of all: by group, and in it by index.
struct MeasurementPlace {
  int group = 0, index = 0;
};

/// Receives the linearised measurements, one batch at a time. Solvers implement it.
class JacobianSink {
 public:
  virtual ~JacobianSink() = default;
  /// Called before the first batch of a linearisation: what was added before counts no longer.
  virtual void beginLinearization() = 0;
  /// Takes one batch, whose arrays are valid during the call alone.
  virtual void add(const JacobianBatch& batch) = 0;
  /// Whether it wants `addUnweighted` too.
  virtual bool wantsUnweighted() const { return false; }
  /// The batch just added, of a group with losses, before these reweighted it.
  virtual void addUnweighted(const JacobianBatch& batch) { static_cast<void>(batch); }
  /// Where the partitions of the measurements begin; the first begins at {0, 0}. Several threads may add different partitions at the
  /// same time; within one, batches arrive in order. The partitions must not depend on the number of threads: they fix the order of
  /// every sum. Empty: one partition, all is added in order.
  virtual std::span<const MeasurementPlace> partitions() const { return {}; }
  /// Called after the last batch.
  virtual void endLinearization() = 0;
};

}  // namespace slom
