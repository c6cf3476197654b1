#pragma once
// Random segments of all kinds, orders and knots, and differences in long double to compare with.

#include <array>
#include <utility>
#include <vector>

#include <mtk/rebind.hpp>
#include <mtk/testing/random.hpp>
#include <slom/trajectory.hpp>

namespace slom::testing {

using Long = long double;

/// Calls f.template operator()<N>() for the orders 2 to 6.
template <class F>
void forEachOrder(const F& f) {
  f.template operator()<2>();
  f.template operator()<3>();
  f.template operator()<4>();
  f.template operator()<5>();
  f.template operator()<6>();
}

inline mtk::vect<3> randomVector(mtk::testing::Random& random, double size) {
  return {size * random.normal(), size * random.normal(), size * random.normal()};
}
/// Increasing times whose spacings differ by a factor of up to 10.
inline std::vector<double> randomTimes(mtk::testing::Random& random, int count) {
  std::vector<double> times{random.uniform(-5, 5)};
  while (static_cast<int>(times.size()) < count) times.push_back(times.back() + random.uniform(0.1, 1));
  return times;
}
/// Uniform knots for even seeds, others for odd ones.
inline trajectory::Knots randomKnots(mtk::testing::Random& random, unsigned seed) {
  if (seed % 2 == 0) return trajectory::Knots(random.uniform(-5, 5), random.uniform(0.1, 1));
  return trajectory::Knots(randomTimes(random, 12));
}

// Random values of control points, near each other as those of a trajectory.
inline void randomize(mtk::vect<3>& x, mtk::testing::Random& random) { x = randomVector(random, 1); }
inline void randomize(mtk::SO3<>& x, mtk::testing::Random& random) {
  x = mtk::SO3<>::exp(mtk::vect<3>(0.5, 2, -1)) * mtk::SO3<>::exp(randomVector(random, 0.4));
}
inline void randomize(mtk::trafo<mtk::SO3<>>& x, mtk::testing::Random& random) {
  randomize(x.pos, random);
  randomize(x.orient, random);
}
template <class Control>
std::vector<Control> randomControls(mtk::testing::Random& random, int count) {
  std::vector<Control> controls(static_cast<std::size_t>(count));
  for (Control& control : controls) randomize(control, random);
  return controls;
}

/// The numbers of a control point as long doubles.
template <int N>
mtk::vect<N, Long> precise(const mtk::vect<N>& x) {
  return x.template cast<Long>();
}
inline mtk::SO3<Long> precise(const mtk::SO3<>& R) { return mtk::SO3<Long>(R.w(), R.x(), R.y(), R.z()); }
inline mtk::trafo<mtk::SO3<Long>> precise(const mtk::trafo<mtk::SO3<>>& T) {
  return {precise(T.pos), precise(T.orient)};
}

/// Segment i of the spline with these control points, the first of which is control point 0.
template <class Segment>
Segment segmentOf(const trajectory::Knots& knots, std::int64_t i,
                  const std::vector<typename Segment::Control>& controls) {
  typename Segment::Controls own;
  for (std::size_t j = 0; j < own.size(); ++j) own[j] = controls[static_cast<std::size_t>(i) + j];
  return Segment(trajectory::Blending<Segment::order>(knots, i), own);
}
/// The same with numbers of long double.
template <class Segment>
auto preciseSegment(const trajectory::Knots& knots, std::int64_t i,
                    const std::vector<typename Segment::Control>& controls) {
  using Precise = typename Segment::template Over<Long>;
  typename Precise::Controls own;
  for (std::size_t j = 0; j < own.size(); ++j) own[j] = precise(controls[static_cast<std::size_t>(i) + j]);
  return Precise(trajectory::Blending<Segment::order>(knots, i), own);
}

/// The derivative by t of a curve, right [-] left over 2 h, extrapolated to errors of order h^4.
template <class Curve>
auto derivativeOf(const Curve& curve, Long t) {
  const auto difference = [&](Long h) {
    return (mtk::difference(curve(t + h), curve(t - h)) / (2 * h)).eval();
  };
  constexpr Long h = 2e-5L;
  return ((4 * difference(h) - difference(2 * h)) / 3).eval();
}

}  // namespace slom::testing
