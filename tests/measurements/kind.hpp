/// Checks a measurement kind against a formula written out in long double.
///   residual     of the vectorised and of the scalar path, with and without derivatives, is the formula's
///   derivatives  of both are its central differences in the tangent space
///   packs        agree with scalars for every number of measurements, whether it fills the last pack or not
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
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
struct OneByOne : F {
  static constexpr bool is_vectorized = false;
  auto operator()(const auto&... x) const { return F()(x...); }
};

using LongVector = Eigen::Matrix<Real, -1, 1>;

/// Adds d to the unknown with this number, counted through all parts of x.
template <class... X>
void moveUnknown(std::tuple<X...>& x, int unknown, Real d) {
  const auto move = [&]<class P>(P& part) {
    constexpr int n = mtk::DOF_v<P>;
    if (0 <= unknown && unknown < n) {
      Real step[n] = {};
      step[unknown] = d;
      mtk::boxplus<P>(part, mtk::vectview<const Real, n>(step, n));
    }
    unknown -= n;
  };
  std::apply([&](X&... part) { (move(part), ...); }, x);
}

/// Appends the typical sizes of the components of x, at least 1.
template <class X>
void appendTypicalSizes(std::vector<double>& sizes, const X& x) {
  mtk::tangent_t<X> own;
  mtk::typicalSizes<X>(own, x);
  for (const double size : own) sizes.push_back(std::max(1.0, size));
}

// What follows is for all kinds the same and not a template, so that it is compiled once: kind.cpp.

/// One measurement, evaluated by itself.
struct Alone {
  Eigen::VectorXd r, r_without_derivatives;
  Eigen::MatrixXd J;
  double size = 0;  // size of the terms of the residual: rounding is relative to it
};

/// A formula as a function of one of its unknowns, which is moved by d. unknown = -1: nothing moves.
using FormulaAt = std::function<LongVector(int unknown, Real d)>;

/// Compares a measurement with a formula. `sizes` are those of the datum and of the unknowns. Derivatives of the
/// formula are differences with steps of `step`. The last `angles` entries of the residual are a rotation vector, which
/// may jump at half a turn.
void expectFormula(Alone& measurement, const FormulaAt& formula, const std::vector<double>& sizes_of_datum,
                   const std::vector<double>& sizes_of_unknowns, int angles, Real step);

/// `evaluateMany(count, r, J)` evaluates the first measurements, without derivatives if J is null.
void expectTheSameInPacks(const std::vector<Alone>& measurements,
                          const std::function<void(int count, double* r, double* J)>& evaluateMany);

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

  Estimator owner;  // owns the variables
  std::vector<Packed> packed;
  std::vector<Alone> alone;
  const auto check = [&](const Z& z, const X&... x) {
    const std::tuple<VarID<X>...> ids(owner.insertRV(x)...);
    std::apply([&](const VarID<X>&... id) { packed.emplace_back(F(), id..., measured(z)); }, ids);
    const auto scalar =
        std::apply([&](const VarID<X>&... id) { return Scalar(OneByOne<F>(), id..., measured(z)); }, ids);
    Alone& measurement = alone.emplace_back();
    measurement.r.resize(rows);
    measurement.J.resize(rows, columns);
    ASSERT_EQ(scalar.linearize(rows, measurement.r.data(), measurement.J.data()), rows);
    Residual<rows> again;
    scalar.evaluate(again);
    measurement.r_without_derivatives = again;

    const auto long_z = mtk::lifted<Real>(z);
    const auto long_x = std::tuple(mtk::lifted<Real>(x)...);
    const FormulaAt formula_at = [&](int unknown, Real d) -> LongVector {
      auto moved = long_x;
      if (unknown >= 0) moveUnknown(moved, unknown, d);
      return std::apply([&](const auto&... y) { return formula(long_z, y...); }, moved);
    };
    std::vector<double> sizes_of_datum, sizes_of_unknowns;
    appendTypicalSizes(sizes_of_datum, z);
    (appendTypicalSizes(sizes_of_unknowns, x), ...);
    expectFormula(measurement, formula_at, sizes_of_datum, sizes_of_unknowns, angles, step);
  };
  for (const auto& sample : samples) {
    SCOPED_TRACE("sample " + std::to_string(packed.size()));
    std::apply(check, sample);
    ASSERT_EQ(alone.size(), packed.size());
  }
  expectTheSameInPacks(
      alone, [&](int count, double* r, double* J) { Packed::evaluateMany(packed.data(), count, r, J); });
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
