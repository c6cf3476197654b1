/// H = J^T J in blocks and g = J^T r, added up from linearised measurements.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "block_lower.hpp"
#include "slom/linearize/jacobian_sink.hpp"
#include "slom/linearize/structure.hpp"
#include "solve/dense/kernels.hpp"

namespace slom {

class NormalEquations {
 public:
  /// `position`: of each block in the order of elimination. The graph has an edge for each pair of blocks that meet in a
  /// measurement, and may have more: these blocks are 0. The structure must outlive this.
  void layOut(const BlockStructure& structure, const BlockGraph& graph, const std::vector<int>& position);
  void setZero();
  /// Threads share the work by columns of H, so that each entry is summed in the order of the measurements.
  void add(std::span<const JacobianBatch> batches);

  const BlockLower& H() const { return H_; }
  /// By unknown, in the order of the structure; so are the others.
  const Eigen::VectorXd& gradient() const { return gradient_; }
  void diagonal(Eigen::VectorXd& result) const;
  /// d^T H d
  double squaredImage(const Eigen::VectorXd& d) const;
  /// Of a block of the structure, in the order of elimination.
  int position(int block) const { return place_[static_cast<std::size_t>(block)].column; }
  /// First unknown of each position.
  const std::vector<int>& offset() const { return offset_; }

 private:
  /// Where a block of the structure adds to.
  struct Place {
    int column = -1;
    double* diagonal = nullptr;  ///< block of H
    double* gradient = nullptr;
  };
  /// A block of H that two blocks of a measurement add to.
  struct Destination {
    int block : 31;
    unsigned is_first : 1;  ///< nothing was added to it before
  };
  void findDestinations();
  bool addPair(const dense::Kernels& kernel, int rows, const int* blocks, const int* dof, Destination destination, const double* J,
               const double* r, int first, int last);
  void addColumns(const JacobianBatch& batch, int first, int last);

  void prefetch(const int* blocks, Destination destination, int first, int last) const;
  double* begun(Destination destination, int size);

  const BlockStructure* structure_ = nullptr;
  BlockLower H_;
  std::vector<Place> place_;  // by block of the structure
  std::vector<int> offset_;
  std::vector<std::vector<Destination>> destination_;  // of each group: measurement x pairs (k < l)
  std::vector<double> work_;  // by position: products that go to its column and those before it
  Eigen::VectorXd gradient_;
};

}  // namespace slom
