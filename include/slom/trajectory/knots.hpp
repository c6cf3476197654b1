/// Knots: the times at which the polynomial segments of a spline meet.
///   knot i          any integer i: beyond the given knots, the spacing at that end continues
///   segment i       from knot i (included) to knot i + 1
///   control points  those of segment i in a spline of order N are i, ..., i + N - 1
/// So a spline can grow at both ends, and each time has a segment.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom::trajectory {

/// Strictly increasing times [s, or any other unit of time].
class Knots {
 public:
  /// Creates uniform knots: knot i is start + i * spacing. Throws [slom.bad-knots] unless start is finite and spacing
  /// is finite and positive.
  Knots(double start, double spacing);
  /// Creates non-uniform knots: knot i is times[i]. Throws [slom.bad-knots] unless there are at least 2 finite and
  /// strictly increasing times.
  explicit Knots(std::vector<double> times);

  /// Returns the time of knot i.
  double operator[](std::int64_t i) const;
  /// Returns the segment that contains the time t. Throws [slom.bad-time] if t is not finite or more than 2^52 knots
  /// away.
  std::int64_t segmentAt(double t) const;
  /// Returns the mean of the knots of control point i that are inside its support (Greville's abscissa). If each
  /// control point is a linear function at this time, the spline is this function.
  double timeOfControl(std::int64_t i, int order) const;
  /// Returns whether all spacings are equal by construction.
  bool isUniform() const { return times_.empty(); }

 private:
  /// Returns the segment of a time in equal spacings from `start` on.
  std::int64_t uniformSegment(double t, double start, double spacing) const;

  double start_ = 0, spacing_ = 1;
  std::vector<double> times_;  // empty: uniform
};

}  // namespace slom::trajectory
