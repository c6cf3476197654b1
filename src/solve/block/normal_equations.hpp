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
  /// measurement, and may have more: these blocks are 0. The structure must outlive this.
  void layOut(const BlockStructure& structure, const BlockGraph& graph, const std::vector<int>& position);
  /// Again for the structure, in which other measurements have come to the same graph.
  void layOutMeasurements();
  void setZero();
  void add(const JacobianBatch& batch);
  /// After all batches: adds what parts of the measurements have summed on their own.
  void addUp();
  /// See JacobianSink. What several parts add to, the first of them adds to H and g, the others to numbers of their own.
  std::span<const MeasurementPlace> parts() const { return parts_; }

  const BlockLower& H() const { return H_; }
  /// By unknown, in the order of the structure; so are the others.
  const Eigen::VectorXd& gradient() const { return gradient_; }
  /// Of H.
  const Eigen::VectorXd& diagonal() const { return diagonal_; }
  /// d^T H d
  double squaredNormOfJd(const Eigen::VectorXd& d) const;
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
  /// Numbers of a part's own that are added to a block of H, and, where that is on the diagonal, to its entries of g.
  struct Own {
    int block, column;
    std::size_t start;
  };
  void chooseParts();
  void findDestinations();
  bool addPair(const dense::Kernels& kernel, int rows, const int* places, const int* dof,
               Destination destination, const double* J, const double* r);
  void prefetch(const int* places, Destination destination) const;
  const int* placesOf(int group) const;
  const double* values(int block) const;
  double* values(int block) { return const_cast<double*>(std::as_const(*this).values(block)); }
  double* begun(Destination destination, int size);

  const BlockStructure* structure_ = nullptr;
  BlockLower H_;
  std::vector<Place> place_;  // by block of the structure; after them those of parts
  std::vector<int> offset_;
  std::vector<std::vector<Destination>> destination_;  // of each group: measurement x pairs (k < l)
  std::vector<MeasurementPlace> parts_;                // where they begin; empty: there is but one
  std::vector<Own> own_;  // in the order of the parts; in destinations after the blocks of H
  std::vector<std::vector<int>>
      place_of_;  // of each group: measurement x arity, where any part has places of its own
  dense::BigArray own_values_;
  std::size_t own_size_ = 0;
  Eigen::VectorXd gradient_, diagonal_;
};

}  // namespace slom
