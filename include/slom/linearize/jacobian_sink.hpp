/// What linearised measurements go to.
#pragma once

#include <span>

namespace slom {

/// Whitened residuals and Jacobians of the measurements [first, first + count) of one group, reweighted by their losses.
struct JacobianBatch {
  int group = 0;
  int first = 0;
  int count = 0;
  const int* rows = nullptr;      ///< count entries: length of each residual
  const int* dof = nullptr;       ///< count x arity: columns of each variable
  const double* r = nullptr;      ///< residuals, one after the other
  const double* J = nullptr;      ///< for each measurement rows x (sum of its dof), column-major, one after the other;
                                  ///< columns of fixed variables hold nothing meaningful
};

/// Receives the linearised measurements, in order, one batch at a time. Solvers implement it.
class JacobianSink {
 public:
  virtual ~JacobianSink() = default;
  virtual void beginLinearization() = 0;
  virtual void add(const JacobianBatch& batch) = 0;
  /// Several batches at once, which may be added by several threads.
  virtual void addAll(std::span<const JacobianBatch> batches) {
    for (const JacobianBatch& batch : batches) add(batch);
  }
  virtual void endLinearization() = 0;
};

}  // namespace slom
