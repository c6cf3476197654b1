// [-] of the variable stores and its derivative, against central differences in long double.
#include <array>
#include <memory>

#include <gtest/gtest.h>

#include <mtk/build_manifold.hpp>
#include <slom/slom.hpp>

namespace slom::testing {
namespace {

using Eigen::MatrixXd;
using Real = long double;
using SO3 = mtk::SO3<>;
using S2 = mtk::S2<>;
using SE3 = mtk::trafo<SO3>;
using Vec3 = mtk::vect<3>;

MTK_BUILD_MANIFOLD(Sensor, ((SE3, pose))((mtk::vect<2>, gain))((S2, axis))((mtk::SO2<>, angle)))

/// A rotation that is moved on the left, and whose [-] takes only doubles.
struct LeftRotation {
  using scalar = double;
  static constexpr int DOF = 3;
  SO3 q;
  void boxplus(mtk::vectview<const double, 3> d, double scale = 1) { q = SO3::exp(d, scale) * q; }
  void boxminus(mtk::vectview<double, 3> out, const LeftRotation& y) const {
    out = SO3::log(q * y.q.inverse());
  }
};

template <class T>
MatrixXd derivative(const T& x, const T& y) {
  const std::unique_ptr<VariableStoreBase> store(makeVariableStore<T>());
  MatrixXd D = MatrixXd::Constant(mtk::dof(x), mtk::dof(x), std::nan(""));
  store->boxminusDerivative(&x, &y, D.data());
  return D;
}

/// (x [+] h e_c) [-] y and (x [+] -h e_c) [-] y over 2 h.
template <class T>
MatrixXd differences(const T& x, const T& y) {
  using Long = mtk::rebind_t<T, Real>;
  const int n = mtk::dof(x);
  const Real h = 1e-6L;
  const Long from = mtk::lifted<Real>(x), origin = mtk::lifted<Real>(y);
  MatrixXd D(n, n);
  for (int c = 0; c < n; ++c) {
    mtk::PlainVector<Real, mtk::DOF_v<T>> step(n), back(n);
    step.setZero();
    step[c] = h;
    back = -step;
    const auto plus = mtk::difference(mtk::moved(from, step), origin),
               minus = mtk::difference(mtk::moved(from, back), origin);
    for (int i = 0; i < n; ++i) D(i, c) = static_cast<double>((plus[i] - minus[i]) / (2 * h));
  }
  return D;
}

template <class T>
void expectDerivative(const T& x, const T& y, double tolerance = 1e-11) {
  const MatrixXd got = derivative(x, y), want = differences(x, y);
  EXPECT_LT((got - want).cwiseAbs().maxCoeff(), tolerance) << got << "\nin place of\n" << want;
}

SO3 turned(double angle) { return SO3::exp(Vec3(angle * Vec3(0.6, -0.48, 0.64))); }

TEST(Boxminus, OfStoresIsTheManifolds) {
  const std::unique_ptr<VariableStoreBase> store(makeVariableStore<SE3>());
  const SE3 x(turned(0.3), Vec3(1, 2, 3)), y(turned(-1), Vec3(4, 4, 4));
  mtk::tangent_t<SE3> out;
  store->boxminus(out.data(), &x, &y);
  EXPECT_EQ(out, mtk::difference(x, y));
}

TEST(BoxminusDerivative, IsTheIdentityForVectorsAndAngles) {
  EXPECT_EQ(derivative(3.0, 4.0), MatrixXd::Identity(1, 1));
  EXPECT_EQ(derivative(Vec3(1, 2, 3), Vec3(0, 0, 5)), MatrixXd::Identity(3, 3));
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(5, 0, 1);
  EXPECT_EQ(derivative<Eigen::VectorXd>(x, 2 * x), MatrixXd::Identity(5, 5));
  EXPECT_EQ(derivative(mtk::SO2<>(3), mtk::SO2<>(-3)), MatrixXd::Identity(1, 1));
}

TEST(BoxminusDerivative, OfRotationsAtAllAngles) {
  constexpr double pi = 3.14159265358979323846;
  EXPECT_LT((derivative(turned(1), turned(1)) - MatrixXd::Identity(3, 3)).norm(), 1e-15);
  for (const double angle :
       {1e-300, 1e-12, 1e-8, 1e-5, 1e-3, 0.1, 0.2999, 0.3001, 1.0, 2.0, 3.0, pi - 1e-3, pi - 1e-5}) {
    SCOPED_TRACE(angle);
    const SO3 y = turned(0.7) * SO3::exp(Vec3(0.2, 1, -0.3));
    expectDerivative(SO3(y * turned(angle)), y, angle > 3 ? 1e-9 : 1e-11);
    expectDerivative(SO3(y * turned(-angle)), y, angle > 3 ? 1e-9 : 1e-11);
  }
}

TEST(BoxminusDerivative, OfDirections) {
  const S2 y(0.3, -0.4, 1);
  EXPECT_LT((derivative(y, y) - MatrixXd::Identity(2, 2)).norm(), 1e-15);
  for (const S2& x : {S2(0.3, -0.4, 1 + 1e-9), S2(0.2, 0, 1), S2(1, 1, -1), S2(-0.3, 1.5, -1)})
    expectDerivative(x, y, 1e-8);
}

TEST(BoxminusDerivative, OfCompoundsAndArrays) {
  const Sensor x(SE3(turned(2), Vec3(1, 2, 3)), mtk::vect<2>(1, 2), S2(1, 2, 3), mtk::SO2<>(2));
  const Sensor y(SE3(turned(0.5), Vec3(3, 2, 1)), mtk::vect<2>(0, 2), S2(1, 0, 1), mtk::SO2<>(-2));
  expectDerivative(x, y);
  using Two = std::array<SO3, 2>;
  expectDerivative(Two{turned(1), turned(2)}, Two{turned(-1), turned(0)});
}

TEST(BoxminusDerivative, OfOwnTypesByDifferences) {
  // On the left: the inverse left Jacobian is the transpose of the right one.
  for (const double angle : {0.0, 1e-6, 0.5, 2.5}) {
    const LeftRotation x{turned(angle)}, y{turned(0)};
    EXPECT_LT((derivative(x, y) - derivative(x.q, y.q).transpose()).norm(), 1e-10) << angle;
  }
}

}  // namespace
}  // namespace slom::testing
