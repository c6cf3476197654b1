/// H = J^T J in blocks and g = J^T r, added up from linearised measurements.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "block_lower.hpp"
#include "slom/linearize/jacobian_sink.hpp"
#include "slom/linearize/structure.hpp"
#include "solve/dense/kernels.hpp"

namespace slom {

class NormalEquations {
 public:
  /// Lays out H. `position`: by block, its place in the order of elimination. The graph has an edge for each pair of
  /// blocks that meet in a measurement, and may have more; the blocks of these are 0. The structure must outlive this
  /// object.
  void layOut(const BlockStructure& structure, const BlockGraph& graph, const std::vector<int>& position);
  /// Repeats layOut after the measurements of the structure have changed, but not its graph.
  void layOutMeasurements();
  void setZero();
  void add(const JacobianBatch& batch);
  /// Adds the private accumulators of the partitions to H and g. Call it after all batches.
  void addUp();
  /// Returns the partitions of the measurements, see JacobianSink::partitions. If several of them add to a block, the
  /// first adds to H and g, the others to private accumulators.
  std::span<const MeasurementPlace> partitions() const { return partitions_; }

  const BlockLower& H() const { return H_; }
  /// Returns g = J^T r. All vectors are indexed by unknown in the order of the structure.
  const Eigen::VectorXd& gradient() const { return gradient_; }
  /// Returns the diagonal of H.
  const Eigen::VectorXd& diagonal() const { return diagonal_; }
  /// Returns d^T H d.
  double squaredNormOfJd(const Eigen::VectorXd& d) const;
  /// Returns the position of a block of the structure in the order of elimination.
  int position(int block) const { return place_[static_cast<std::size_t>(block)].column; }
  /// Returns the first unknown of each position.
  const std::vector<int>& offset() const { return offset_; }

 private:
  /// Destination of a block of the structure on the diagonal.
  struct Place {
    int column = -1;
    double* diagonal = nullptr;  ///< block of H
    double* gradient = nullptr;
  };
  /// A block of H that two blocks of a measurement add to.
  struct Destination {
    int block : 31;
    unsigned is_first : 1;  ///< nothing was added before
  };
  /// A private accumulator of a partition, to be added to a block of H and, for a diagonal block, to its entries of g.
  struct Accumulator {
    int block, column;
    std::size_t start;  ///< first of its entries
  };
  void findDestinations();
  void placeAccumulators();
  void clearUntouched(const std::vector<signed char>& partition);
  struct Pairs;
  struct Stack;
  bool append(const dense::Kernels& kernel, int rows, const int* places, const int* dof,
              Destination destination, const double* J, const double* r, Pairs& pairs);
  static void addAll(const dense::Kernels& kernel, Pairs& pairs);
  void addEach(const dense::Kernels& kernel, int arity, int rows, const int* places, const int* dof,
               const Destination* destination, const double* J, const double* r);
  void addStack(const dense::Kernels& kernel, const Stack& stack, int count, const int* places,
                const int* dof, const Destination* destination, const double* J, const double* r);
  const int* placesOf(int group) const;
  const double* values(int block) const;
  double* values(int block) { return const_cast<double*>(std::as_const(*this).values(block)); }
  double* begun(Destination destination, int size);

  const BlockStructure* structure_ = nullptr;
  BlockLower H_;
  std::vector<Place> place_;  // by block of the structure; then those of accumulators
  std::vector<int> offset_;
  std::vector<std::vector<Destination>> destination_;  // by group: measurement x pairs (k < l)
  std::vector<MeasurementPlace> partitions_;           // first measurement of each; empty: there is only one
  std::vector<Accumulator>
      accumulators_;  // in the order of the partitions; destinations number them after H's blocks
  /// Indices into place_, by group: measurement x arity. Empty if there are no accumulators: then places are blocks.
  std::vector<std::vector<int>> place_of_;
  dense::BigArray accumulator_values_;
  std::size_t accumulator_size_ = 0;
  Eigen::VectorXd gradient_, diagonal_;
};

}  // namespace slom
