/// VectorSegment: one segment of a B-spline in R^D, such as a position or the biases of an IMU.
///   x(t) = c_0 + sum_j b_j(t) (c_j - c_{j-1})    j = 1, ..., N - 1
/// b_j: the cumulative weights (slom/trajectory/blending.hpp).
#pragma once

#include <array>

#include "mtk/types/vect.hpp"
#include "slom/trajectory/blending.hpp"

namespace slom::trajectory {

/// The N control points of a segment in R^D, of numbers S. Times may be of another number type than S.
template <int D, int N, class S = double>
class VectorSegment {
 public:
  static constexpr int order = N;
  using Control = mtk::vect<D, S>;
  using Controls = std::array<Control, std::size_t{N}>;
  /// This segment over another number type.
  template <class T>
  using Over = VectorSegment<D, N, T>;

  /// Joins control points and weights.
  VectorSegment(const Blending<N>& blending, const Controls& controls)
      : blending_(blending), first_(controls[0]) {
    for (std::size_t j = 0; j < blending_.steps; ++j) steps_[j] = controls[j + 1] - controls[j];
  }

  /// Returns the weights of the segment.
  const Blending<N>& blending() const { return blending_; }
  /// Returns x(t).
  template <class Time>
  auto at(const Time& t) const {
    return first_ + combined<0>(t);
  }
  /// Returns dx/dt.
  template <class Time>
  auto velocityAt(const Time& t) const {
    return combined<1>(t);
  }
  /// Returns d2x/dt2.
  template <class Time>
  auto accelerationAt(const Time& t) const {
    return combined<2>(t);
  }

 private:
  /// Returns the sum of the steps times the derivatives of their weights.
  template <int Derivative, class Time>
  auto combined(const Time& t) const {
    const auto b = blending_.template at<Derivative>(t);
    auto sum = b[0] * steps_[0];
    for (std::size_t j = 1; j < blending_.steps; ++j) sum = sum + b[j] * steps_[j];
    return sum;
  }

  Blending<N> blending_;
  Control first_;
  std::array<Control, std::size_t{N - 1}> steps_;
};

}  // namespace slom::trajectory
