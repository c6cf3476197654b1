/// JacobianSink: the receiver of linearised measurements.
#pragma once

#include <span>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// Whitened residuals and Jacobians of the measurements [first, first + count) of one group, reweighted by their
/// losses.
struct JacobianBatch {
  int group = 0;
  int first = 0;
  int count = 0;
  const int* rows = nullptr;  ///< count entries: length of each residual
  const int* dof = nullptr;   ///< count x arity: columns of each variable
  const double* r = nullptr;  ///< residuals, one after another
  /// For each measurement rows x (sum of its dof), column-major, one after another. Columns of fixed variables are
  /// meaningless.
  const double* J = nullptr;
};

/// The place of a measurement in the order of all: by group, then by index.
struct MeasurementPlace {
  int group = 0, index = 0;
};

/// Receives the linearised measurements, one batch at a time. Solvers implement this interface.
class JacobianSink {
 public:
  virtual ~JacobianSink() = default;
  /// Called before the first batch of a linearisation. Discards what was added before.
  virtual void beginLinearization() = 0;
  /// Takes one batch, whose arrays are valid only during the call.
  virtual void add(const JacobianBatch& batch) = 0;
  /// Returns whether the sink also needs `addUnweighted`.
  virtual bool wantsUnweighted() const { return false; }
  /// Takes the batch just added, of a group with losses, before the losses reweighted it.
  virtual void addUnweighted(const JacobianBatch& batch) { static_cast<void>(batch); }
  /// Returns where the partitions of the measurements begin; the first begins at {0, 0}. Several threads may add
  /// different partitions at the same time. Within a partition, batches arrive in order. The partitions must not depend
  /// on the number of threads, because they fix the order of every sum. Empty: one partition, everything is added in
  /// order.
  virtual std::span<const MeasurementPlace> partitions() const { return {}; }
  /// Called after the last batch.
  virtual void endLinearization() = 0;
};

}  // namespace slom
