/// The Jacobian of the whole problem as it was linearised, for analyses that look at it measurement by measurement.
#pragma once

#include "slom/optimize/system.hpp"
#include "solve/block/jacobian_rows.hpp"

namespace slom {

class StoredJacobian final : public JacobianSink {
 public:
  /// Linearises at the current values, as the fit does: measurements with a loss are reweighted.
  StoredJacobian(Problem& problem, Linearizer& linearizer, const BlockStructure& structure);

  void beginLinearization() override { rows_.clear(); }
  void add(const JacobianBatch& batch) override { rows_.add(batch); }
  void endLinearization() override {}

  const JacobianRows& rows() const { return rows_; }
  /// J V
  Eigen::MatrixXd times(const Eigen::MatrixXd& V) const;

 private:
  const BlockStructure& structure_;
  JacobianRows rows_;
};

}  // namespace slom
