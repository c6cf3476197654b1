/// J and r as linearised, measurement by measurement.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "slom/linearize/linearize.hpp"

namespace slom {

class JacobianRows {
 public:
  using Part = Eigen::Map<const Eigen::MatrixXd>;

  /// Prepares for a structure, which must outlive this object.
  void analyze(const BlockStructure& structure);
  void clear();
  void add(const JacobianBatch& batch);
  /// Multiplies residual and Jacobian of measurement m of group g.
  void multiply(std::size_t g, int m, double by);

  /// Returns the number of measurements of group g.
  int size(std::size_t g) const { return static_cast<int>(groups_[g].start.size()); }
  /// Returns the residual of measurement m of group g.
  Eigen::Map<const Eigen::VectorXd> residual(std::size_t g, int m) const;
  /// Calls f(block, J of that block) for each of its optimised blocks. A block may occur twice.
  template <class F>
  void forEachPart(std::size_t g, int m, const F& f) const {
    const Group& group = groups_[g];
    const MeasurementGroup& shape = structure_->groups[g];
    const std::size_t i = static_cast<std::size_t>(m), first = i * static_cast<std::size_t>(shape.arity);
    const int rows = group.row[i + 1] - group.row[i];
    const double* J = group.J.data() + group.start[i];
    for (std::size_t k = first; k < first + static_cast<std::size_t>(shape.arity); ++k) {
      if (shape.blocks[k] >= 0) f(shape.blocks[k], Part(J, rows, group.dof[k]));
      J += static_cast<std::ptrdiff_t>(rows) * group.dof[k];
    }
  }

  int rows() const;
  /// Returns J^T r.
  Eigen::VectorXd gradient() const;
  /// Returns the diagonal of J^T J.
  Eigen::VectorXd diagonal() const;
  /// Returns J V, pool after pool.
  Eigen::MatrixXd times(const Eigen::MatrixXd& V) const;
  /// Sends all rows to `sink`, as they were sent to this object.
  void sendTo(JacobianSink& sink) const;
  /// Returns |J d|^2.
  double squaredNormOfJd(const Eigen::VectorXd& d) const;

 private:
  struct Group {
    std::vector<int> row;  // first residual of each measurement; one more for the end
    std::vector<int> dof;
    std::vector<std::size_t> start;  // first entry of the J of each measurement
    std::vector<double> r, J;
  };
  template <class F>
  void forEach(const F& f) const;
  int offset(int block) const { return structure_->offset[static_cast<std::size_t>(block)]; }

  const BlockStructure* structure_ = nullptr;
  std::vector<Group> groups_;
};

}  // namespace slom
