/// H = J^T J in blocks and g = J^T r, added up from linearised measurements.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "block_lower.hpp"
#include "slom/linearize/linearize.hpp"

namespace slom {

class NormalEquations {
 public:
  /// `position`: of each block in the order of elimination. The structure must outlive this.
  void layOut(const BlockStructure& structure, const BlockGraph& graph, const std::vector<int>& position);
  void setZero();
  /// Threads share the work by columns of H, so that each entry is summed in the order of the measurements.
  void add(std::span<const JacobianBatch> batches);

  const BlockLower& H() const { return H_; }
  /// By unknown, in the order of the structure; so are the others.
  const Eigen::VectorXd& gradient() const { return gradient_; }
  Eigen::VectorXd diagonal() const;
  /// d^T H d
  double squaredImage(const Eigen::VectorXd& d) const;
  /// Of a block of the structure, in the order of elimination.
  int position(int block) const { return position_[static_cast<std::size_t>(block)]; }
  /// First unknown of each position.
  const std::vector<int>& offset() const { return offset_; }

 private:
  void findDestinations();
  void addColumns(const JacobianBatch& batch, int first, int last);

  const BlockStructure* structure_ = nullptr;
  BlockLower H_;
  std::vector<int> position_, offset_;
  std::vector<std::vector<int>> destination_;  // block of H; of each group: measurement x pairs (k < l)
  std::vector<double> work_;                   // by position: products that go to its column and those before it
  Eigen::VectorXd gradient_;
};

}  // namespace slom
