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
  /// `position`: of each block in the order of elimination. The graph has an edge for each pair of blocks that meet in a
  /// measurement, and may have more, whose blocks are 0. The structure must outlive this object.
  void layOut(const BlockStructure& structure, const BlockGraph& graph, const std::vector<int>& position);
  /// Repeats layOut after the measurements of the structure have changed, but not its graph.
  void layOutMeasurements();
  void setZero();
  void add(const JacobianBatch& batch);
  /// After all batches: adds the private accumulators of the partitions to H and g.
  void addUp();
  /// See JacobianSink::partitions: the partitions of the measurements. Where several of them add to a block, the first one adds to H and g, the
  /// others to private accumulators.
  std::span<const MeasurementPlace> partitions() const { return partitions_; }

  const BlockLower& H() const { return H_; }
  /// g = J^T r. As the other vectors, indexed by unknown in the order of the structure.
  const Eigen::VectorXd& gradient() const { return gradient_; }
  /// The diagonal of H.
  const Eigen::VectorXd& diagonal() const { return diagonal_; }
  /// d^T H d
  double squaredNormOfJd(const Eigen::VectorXd& d) const;
  /// The position of a block of the structure in the order of elimination.
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
  /// A private accumulator of a partition: it is added to a block of H and, where that is on the diagonal, to its entries of g.
  struct Accumulator {
    int block, column;
    std::size_t start;  ///< first of its entries
  };
  void findDestinations();
  void placeAccumulators();
  void clearUntouched(const std::vector<signed char>& partition);
  struct Pairs;
  bool append(const dense::Kernels& kernel, int rows, const int* places, const int* dof,
              Destination destination, const double* J, const double* r, Pairs& pairs);
  static void addAll(const dense::Kernels& kernel, Pairs& pairs);
  void addEach(const dense::Kernels& kernel, int arity, int rows, const int* places, const int* dof,
               const Destination* destination, const double* J, const double* r);
  const int* placesOf(int group) const;
  const double* values(int block) const;
  double* values(int block) { return const_cast<double*>(std::as_const(*this).values(block)); }
  double* begun(Destination destination, int size);

  const BlockStructure* structure_ = nullptr;
  BlockLower H_;
  std::vector<Place> place_;  // place of each block of the structure; after these, those of accumulators
  std::vector<int> offset_;
  std::vector<std::vector<Destination>> destination_;  // for each group: measurement x pairs (k < l)
  std::vector<MeasurementPlace> partitions_;           // where they begin; empty: there is only one
  std::vector<Accumulator>
      accumulators_;  // in the order of the partitions; destinations number them after the blocks of H
  /// Indices into place_, for each group: measurement x arity. Empty where there are no accumulators: then places are blocks.
  std::vector<std::vector<int>> place_of_;
  dense::BigArray accumulator_values_;
  std::size_t accumulator_size_ = 0;
  Eigen::VectorXd gradient_, diagonal_;
};

}  // namespace slom
