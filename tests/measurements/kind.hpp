/// Checks a measurement kind against a formula written out in long double.
///   residual     of the vectorised and of the scalar path, with and without derivatives, is the formula's
///   derivatives  of both are its central differences in the tangent space
///   packs        agree with scalars for every number of measurements, whether it fills the last pack or not
#pragma once

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>

namespace slom::testing {

using Real = long double;
using Vec2 = mtk::vect<2>;
using Vec3 = mtk::vect<3>;
using SO2 = mtk::SO2<>;
using SO3 = mtk::SO3<>;
using S2 = mtk::S2<>;
using SE2 = mtk::trafo<SO2>;
using SE3 = mtk::trafo<SO3>;

inline constexpr double kPi = 3.14159265358979323846;

/// The same function without the mark that has it evaluated in packs.
template <class F>
struct OneByOne {
  auto operator()(const auto&... x) const { return F()(x...); }
};

/// The last `count` rows of a residual are a rotation vector. Where it jumps at half a turn: the other one
/// that means the same rotation, if it is closer to that of `base`.
inline void continueRotation(Eigen::Matrix<Real, -1, 1>& residual, const Eigen::Matrix<Real, -1, 1>& base,
                             int count) {
  const Eigen::Matrix<Real, -1, 1> v = residual.tail(count);
  const Real angle = v.norm(), turn = 2 * std::acos(Real(-1));
  if (angle < turn / 4) return;
  const Eigen::Matrix<Real, -1, 1> other = v * (1 - turn / angle);
  if ((other - base.tail(count)).norm() < (v - base.tail(count)).norm()) residual.tail(count) = other;
}

/// Derivatives of the formula by central differences of order 6, in column i of the result for unknown i. The
/// last `angles` rows are a rotation vector.
template <class Formula, class... X>
Eigen::Matrix<Real, -1, -1> differences(const Formula& formula, const std::tuple<X...>& at, Real step,
                                        int angles) {
  const int n = (mtk::DOF_v<X> + ...);
  const Eigen::Matrix<Real, -1, 1> base = std::apply(formula, at);
  Eigen::Matrix<Real, -1, -1> J;
  for (int i = 0; i < n; ++i) {
    Eigen::Matrix<Real, -1, 1> d = Eigen::Matrix<Real, -1, 1>::Zero(n);
    const auto moved = [&](int steps) {
      d[i] = steps * step;
      auto x = at;
      int offset = 0;
      const auto move = [&](auto& part) {
        using P = std::remove_reference_t<decltype(part)>;
        mtk::boxplus<P>(part, mtk::vectview<const Real, mtk::DOF_v<P>>(d.data() + offset, mtk::DOF_v<P>));
        offset += mtk::DOF_v<P>;
      };
      std::apply([&](auto&... part) { (move(part), ...); }, x);
      Eigen::Matrix<Real, -1, 1> residual = std::apply(formula, x);
      continueRotation(residual, base, angles);
      return residual;
    };
    const Eigen::Matrix<Real, -1, 1> column =
        (45 * (moved(1) - moved(-1)) - 9 * (moved(2) - moved(-2)) + (moved(3) - moved(-3))) / (60 * step);
    J.conservativeResize(column.size(), n);
    J.col(i) = column;
  }
  return J;
}

/// Magnitudes of the components of x, at least 1.
template <class X>
mtk::tangent_t<X> largest(const X& x) {
  mtk::tangent_t<X> result;
  mtk::magnitudes<X>(result, x);
  return result.cwiseMax(1.0);
}

/// `samples` are tuples of the datum and the variables; formula(z, variables...) gives the residual in long
/// double; its differences take steps of `step`; its last `angles` entries are a rotation vector, which may
/// jump at half a turn.
template <class F, class Formula, class Z, class... X>
void checkKind(const Formula& formula, const std::vector<std::tuple<Z, X...>>& samples, int angles = 0,
               Real step = 1e-3L) {
  using Packed = CallableMeasurement<F, VarID<X>..., Measured<Z>>;
  using Scalar = CallableMeasurement<OneByOne<F>, VarID<X>..., Measured<Z>>;
  using Numeric = CallableMeasurement<decltype(slom::numeric(F())), VarID<X>..., Measured<Z>>;
  static_assert(Packed::vectorized && Packed::derivatives == DerivativeSource::exact);
  static_assert(!Scalar::vectorized && Scalar::derivatives == DerivativeSource::exact);
  static_assert(!Numeric::vectorized && Numeric::derivatives == DerivativeSource::numeric);
  constexpr int rows = Packed::residual_dim, columns = (mtk::DOF_v<X> + ...);
  using Vector = Eigen::Matrix<double, rows, 1>;
  using Matrix = Eigen::Matrix<double, rows, columns>;

  Estimator owner;  // of the variables
  std::vector<Packed> packed;
  std::vector<Vector> scalar_r;
  std::vector<Matrix> scalar_J;
  std::vector<double> size;  // of the numbers that the residual is a sum of: rounding is relative to it
  for (const auto& sample : samples) {
    SCOPED_TRACE("sample " + std::to_string(packed.size()));
    std::apply(
        [&](const Z& z, const X&... x) {
          const auto ids = std::tuple(owner.insertRV(x)...);
          std::apply(
              [&](const auto&... id) {
                packed.emplace_back(F(), id..., measured(z));
                const Scalar scalar(OneByOne<F>(), id..., measured(z));
                Vector r;
                Matrix J;
                ASSERT_EQ(scalar.linearize(rows, r.data(), J.data()), rows);
                Residual<rows> again;
                scalar.evaluate(again);
                Eigen::VectorXd of_unknowns(columns);
                int next = 0;
                ((of_unknowns.segment<mtk::DOF_v<X>>(next) = largest(x), next += mtk::DOF_v<X>), ...);
                size.push_back(std::max({largest(z).maxCoeff(), r.cwiseAbs().maxCoeff(),
                                         (J.cwiseAbs() * of_unknowns).maxCoeff()}));
                EXPECT_LE((r - again).norm(), 1e-14 * size.back());
                scalar_r.push_back(r);
                scalar_J.push_back(J);

                const auto long_z = mtk::lifted<Real>(z);
                const auto long_x = std::tuple(mtk::lifted<Real>(x)...);
                const auto of_variables = [&](const auto&... y) { return formula(long_z, y...); };
                const Eigen::Matrix<Real, -1, 1> expected = std::apply(of_variables, long_x);
                EXPECT_LE((r - expected.template cast<double>()).norm(), 1e-14 * size.back())
                    << r.transpose() << " in place of " << expected.transpose();
                const Eigen::MatrixXd derivatives =
                    differences(of_variables, long_x, step, angles).template cast<double>();
                EXPECT_LE((J - derivatives).norm(), 1e-9 * derivatives.norm()) << J << "\nin place of\n"
                                                                               << derivatives;
              },
              ids);
        },
        sample);
  }

  for (int count = 1; count <= static_cast<int>(samples.size()); ++count) {
    const double unused = 12345;
    std::vector<double> r(static_cast<std::size_t>(count * rows + 1), unused), r_alone = r;
    std::vector<double> J(static_cast<std::size_t>(count * rows * columns + 1), unused);
    Packed::evaluateMany(packed.data(), count, r.data(), J.data());
    Packed::evaluateMany(packed.data(), count, r_alone.data(), nullptr);
    EXPECT_EQ(r.back(), unused);
    EXPECT_EQ(r_alone.back(), unused);
    EXPECT_EQ(J.back(), unused);
    for (int i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const Eigen::Map<const Vector> ri(r.data() + i * rows), alone(r_alone.data() + i * rows);
      const Eigen::Map<const Matrix> Ji(J.data() + i * rows * columns);
      EXPECT_LE((ri - scalar_r[at]).norm(), 1e-14 * size[at]) << i << " of " << count;
      EXPECT_LE((alone - scalar_r[at]).norm(), 1e-14 * size[at]) << i << " of " << count;
      EXPECT_LE((Ji - scalar_J[at]).norm(), 1e-14 * scalar_J[at].norm()) << i << " of " << count << "\n"
                                                                         << Ji << "\nin place of\n"
                                                                         << scalar_J[at];
    }
  }
}

/// Random values with fixed seeds.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double number(double from = -1, double to = 1) {
    return std::uniform_real_distribution<double>(from, to)(engine_);
  }
  template <class V>
  V vector(double size = 1) {
    V v;
    for (auto& x : v) x = number(-size, size);
    return v;
  }
  Vec3 axis() { return S2(vector<Vec3>()).vector(); }
  template <class R>
  R rotation() {
    if constexpr (R::DIM == 2) {
      return R(number(-kPi, kPi));
    } else {
      return R::exp(Vec3(axis() * number(0.0, kPi)));
    }
  }
  template <class T>
  T pose(double size = 5) {
    return T(rotation<typename T::Rotation>(), vector<typename T::Vector>(size));
  }

 private:
  std::mt19937 engine_;
};

}  // namespace slom::testing
