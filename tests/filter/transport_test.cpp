// The covariance in the tangent space of the new mean, and the manifolds with an invariant error.
#include <numbers>

#include <gtest/gtest.h>

#include <mtk/testing/axioms.hpp>
#include <slom/filter.hpp>
#include <slom/filter/invariant.hpp>

#include "random_matrices.hpp"
#include "support/fresh_seed.hpp"

namespace slom::testing {

using SO3 = mtk::SO3<>;
using Vec3 = mtk::vect<3>;
using Matrix3 = Eigen::Matrix3d;

Matrix3 cross(const Vec3& v) {
  Matrix3 M;
  M << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return M;
}
/// Returns the right Jacobian of SO(3), Barfoot 2017, equation 7.87.
Matrix3 rightJacobian(const Vec3& phi) {
  const double t = phi.norm();
  const Matrix3 M = cross(phi);
  if (t < 1e-4) return Matrix3::Identity() - M / 2 + M * M / 6;
  return Matrix3::Identity() - (1 - std::cos(t)) / (t * t) * M + (t - std::sin(t)) / (t * t * t) * M * M;
}

/// Returns the transport of an error in the tangent space of x [+] d, as a matrix.
template <class State>
Eigen::Matrix<double, mtk::DOF_v<State>, mtk::DOF_v<State>> transportMatrix(const State& x,
                                                                            const mtk::tangent_t<State>& d) {
  constexpr int n = mtk::DOF_v<State>;
  Eigen::Matrix<double, n, n> J = Eigen::Matrix<double, n, n>::Identity();
  detail::forEachTransport(x, mtk::moved<State>(x, d), d, [&](int at, const auto& block) {
    J.block(at, at, block.rows(), block.cols()) = block;
  });
  return J;
}

TEST(Transport, OfARotationIsTheRightJacobian) {
  RandomMatrices random(freshSeed());
  for (const double angle :
       {0., 1e-12, 1e-9, 1e-6, 1e-3, 0.5, 2., 3., std::numbers::pi - 1e-7, std::numbers::pi}) {
    const Vec3 d(random.vector<3>().normalized() * angle);
    const SO3 R = SO3::exp(random.vector<3>(2));
    EXPECT_LT((transportMatrix<SO3>(R, d) - rightJacobian(d)).norm(), angle > 3.1 ? 1e-7 : 1e-8) << angle;
  }
}

template <class State>
void expectDifferences(const State& x, const mtk::tangent_t<State>& d, RandomMatrices& random) {
  const auto J = transportMatrix<State>(x, d);
  const State mean = mtk::moved<State>(x, d);
  const mtk::tangent_t<State> e = 1e-5 * random.matrix<mtk::DOF_v<State>, 1>();
  const mtk::tangent_t<State> plus = d + e, minus = d - e;
  const mtk::tangent_t<State> moved = (mtk::difference(mtk::moved<State>(x, plus), mean) -
                                       mtk::difference(mtk::moved<State>(x, minus), mean)) /
                                      2;
  EXPECT_LT((J * e - moved).norm(), 1e-9 * (1 + J.norm())) << d.transpose();
}

template <class S>
struct MixedOf {
  mtk::trafo<mtk::SO3<S>> pose;
  mtk::S2<S> direction;
  std::array<mtk::vect<2, S>, 2> points;
};
struct PlainMixed {
  mtk::S2<> direction;
  SO3 orient;
};

TEST(Transport, IsTheDerivativeOfTheDifferenceToTheNewMean) {
  RandomMatrices random(freshSeed());
  for (int i = 0; i < 50; ++i) {
    MixedOf<double> x;
    x.pose = mtk::trafo<SO3>(SO3::exp(random.vector<3>()), random.vector<3>());
    x.direction = mtk::S2<>(random.vector<3>());
    expectDifferences<MixedOf<double>>(x, 0.5 * random.matrix<mtk::DOF_v<MixedOf<double>>, 1>(), random);
    PlainMixed y{mtk::S2<>(random.vector<3>()), SO3::exp(random.vector<3>())};
    expectDifferences<PlainMixed>(y, 0.5 * random.matrix<mtk::DOF_v<PlainMixed>, 1>(), random);
    expectDifferences<mtk::S2<>>(x.direction, 0.9 * random.matrix<2, 1>(), random);
  }
}

TEST(Transport, LeavesInvariantErrors) {
  RandomMatrices random(freshSeed());
  using Motion = RightInvariant<SO3, 2>;
  EXPECT_EQ((transportMatrix<Motion>(Motion(), random.matrix<9, 1>())),
            (Eigen::Matrix<double, 9, 9>::Identity()));
}

TEST(InvariantMotion, SatisfiesTheAxiomsOfManifolds) {
  RandomMatrices random(freshSeed());
  const auto check = [&]<class M>(std::type_identity<M>) {
    constexpr int n = M::DOF;
    for (int i = 0; i < 200; ++i) {
      const double size = i % 4 == 0 ? 1e-6 : 0.6;
      const M x = mtk::moved<M>(M(), mtk::tangent_t<M>(random.matrix<n, 1>()));
      const mtk::tangent_t<M> d = size * random.matrix<n, 1>();
      if (d.template tail<n - M::DIM* int(std::tuple_size_v<decltype(M::vectors)>)>().norm() > 3)
        continue;  // [-] is the shortest way
      const M y = mtk::moved<M>(x, d);
      EXPECT_LT((mtk::difference(y, x) - d).norm(), 1e-12) << d.transpose();
      EXPECT_LT(mtk::difference(mtk::moved<M>(x, mtk::difference(y, x)), y).norm(), 1e-12);
      EXPECT_LT(mtk::difference(x, x).norm(), 1e-14);
    }
  };
  check(std::type_identity<RightInvariant<SO3, 2>>());
  check(std::type_identity<LeftInvariant<SO3, 2>>());
  check(std::type_identity<RightInvariant<mtk::SO2<>, 3>>());
  check(std::type_identity<LeftInvariant<mtk::SO2<>, 3>>());
}

/// Strap-down integration: a group-affine motion. Its derivative by an invariant error does not depend on the state.
TEST(InvariantMotion, DerivativesOfGroupAffineMotionsAreThoseOfAnyState) {
  RandomMatrices random(freshSeed());
  const Vec3 turn = random.vector<3>(0.3), force = random.vector<3>(5), g(0, 0, -9.81);
  const double dt = 0.1;
  const auto motion = [&](const auto& x) {
    using State = std::remove_cvref_t<decltype(x)>;
    using S = mtk::scalar_t<State>;
    using V = mtk::vect<3, S>;
    State y;
    const V a(x.orient * force + g);
    y.vectors[1] = V(x.vectors[1] + x.vectors[0] * dt + a * (dt * dt / 2));
    y.vectors[0] = V(x.vectors[0] + a * dt);
    y.orient = x.orient * mtk::SO3<S>(SO3::exp(turn));
    return y;
  };
  const auto derivative = [&]<class M>(std::type_identity<M>) {
    const M x = mtk::moved<M>(M(), mtk::tangent_t<M>(random.matrix<9, 1>()));
    Eigen::Matrix<double, 9, 9> F;
    detail::linearizeMotion(F, motion, motion(x), std::tuple<const M&>(x));
    return F;
  };
  const auto expectSame = [&](auto type) {
    const Eigen::Matrix<double, 9, 9> F = derivative(type);
    for (int i = 0; i < 20; ++i) EXPECT_LT((derivative(type) - F).norm(), 1e-11);
  };
  expectSame(std::type_identity<RightInvariant<SO3, 2>>());
  expectSame(std::type_identity<LeftInvariant<SO3, 2>>());
}

}  // namespace slom::testing
