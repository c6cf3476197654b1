/// The recursions of a cumulative B-spline on SO(3) over plain numbers, with derivatives by the steps and by time.
///   A_j = exp(b_j d_j), j = 1, ..., N - 1;  s_j = b_j' d_j
///   w_j = A_j^T w_{j-1} + s_j                                    angular velocity, in the frame after A_j
///   a_j = A_j^T a_{j-1} + (A_j^T w_{j-1}) x s_j + b_j'' d_j      its derivative by time
///   source  Sommer, Usenko, Schubert, Demmel and Cremers, "Efficient derivative computation for cumulative B-splines
///           on Lie groups", 2020; derivatives by d_j with the right Jacobian of SO(3)
#pragma once

#include <array>

#include "mtk/types/so3.hpp"
#include "slom/trajectory/blending.hpp"

namespace slom::trajectory::detail {

/// Returns a x b.
template <class A, class B>
auto cross(const mtk::vect<3, A>& a, const mtk::vect<3, B>& b) {
  using S = mtk::promote_t<A, B>;
  return mtk::vect<3, S>(S(a[1] * b[2] - a[2] * b[1]), S(a[2] * b[0] - a[0] * b[2]),
                         S(a[0] * b[1] - a[1] * b[0]));
}

template <class V>
using Matrix3 = mtk::detail::Matrix3<V>;

/// Returns alpha I + [v]x.
template <class V>
Matrix3<V> shiftedSkew(const V& alpha, const mtk::vect<3, V>& v) {
  return mtk::detail::axialMatrix<V>(alpha, V(0), V(1), v);
}

/// A 3x3 matrix for each step.
template <int N, class V>
using StepMatrices = std::array<Matrix3<V>, std::size_t{N - 1}>;

/// The rotation A_1 ... A_{N-1} and its derivatives by the steps, as perturbations on its right.
template <int N, class V>
struct TurnDerivatives {
  mtk::SO3<V> turn;
  StepMatrices<N, V> by_step;
};
/// Angular velocity, acceleration and jerk, and derivatives of the first two by the steps. Which of them are computed
/// is said where they are made.
template <int N, class V>
struct RateDerivatives {
  mtk::vect<3, V> velocity, acceleration, jerk;
  StepMatrices<N, V> velocity_by_step, acceleration_by_step;
};

/// The steps d_j between control points.
template <int N, class V>
class RotationRecursion {
 public:
  static constexpr std::size_t steps = std::size_t{N - 1};
  using Steps = std::array<mtk::vect<3, V>, steps>;

  /// Computes the steps.
  explicit RotationRecursion(const std::array<mtk::SO3<V>, std::size_t{N}>& controls) {
    for (std::size_t j = 0; j < steps; ++j) {
      const mtk::SO3<V> step = controls[j].inverse() * controls[j + 1];
      factors_[j] = mtk::SO3<V>::logFactor(step);
      cosines_[j] = step.w();
      steps_[j] = mtk::vect<3, V>(factors_[j] * step.x(), factors_[j] * step.y(), factors_[j] * step.z());
    }
  }

  /// Returns A_1 ... A_{N-1}.
  mtk::SO3<V> turn(const std::array<V, steps>& b) const {
    mtk::SO3<V> R = mtk::SO3<V>::exp(mtk::vect<3, V>(b[0] * steps_[0]));
    for (std::size_t j = 1; j < steps; ++j) R = R * mtk::SO3<V>::exp(mtk::vect<3, V>(b[j] * steps_[j]));
    return R;
  }
  /// Returns it with its derivatives.
  TurnDerivatives<N, V> turnWithDerivatives(const std::array<V, steps>& b) const {
    TurnDerivatives<N, V> result;
    for (std::size_t j = steps; j-- > 0;) {  // turn: the factors after j
      const mtk::vect<3, V> angle = b[j] * steps_[j];
      const Matrix3<V> own = b[j] * mtk::detail::rightJacobian<V>(angle);
      result.by_step[j] = result.turn.inverse().toRotationMatrix() * own;
      result.turn = mtk::SO3<V>::exp(angle) * result.turn;
    }
    return result;
  }

  /// Computes the first `Rates` of velocity, acceleration and jerk, and derivatives of the first `Derived` of velocity
  /// and acceleration.
  template <int Rates, int Derived, class T>
  RateDerivatives<N, V> rates(const Blending<N>& blending, const T& t) const {
    const auto b = blending.at(t), b1 = blending.template at<1>(t), b2 = blending.template at<2>(t),
               b3 = blending.template at<3>(t);
    RateDerivatives<N, V> result{b1[0] * steps_[0], b2[0] * steps_[0], b3[0] * steps_[0], {}, {}};
    if constexpr (Derived >= 1) result.velocity_by_step[0] = b1[0] * Matrix3<V>::Identity();
    if constexpr (Derived >= 2) result.acceleration_by_step[0] = b2[0] * Matrix3<V>::Identity();
    for (std::size_t j = 1; j < steps; ++j) {
      const mtk::vect<3, V>& d = steps_[j];
      const mtk::vect<3, V> angle = b[j] * d, s = b1[j] * d, second = b2[j] * d;
      const Matrix3<V> back = mtk::SO3<V>::exp(angle).inverse().toRotationMatrix();
      const mtk::vect<3, V> c = back * result.velocity, e = back * result.acceleration;
      const mtk::vect<3, V> c_rate = e + cross(c, s);
      if constexpr (Derived >= 1) derive<Derived>(result, j, back, angle, b[j], b1[j], b2[j], c, e, s);
      result.velocity = c + s;
      if constexpr (Rates >= 3) {
        const mtk::vect<3, V> f = back * result.jerk;
        result.jerk = f + cross(e + c_rate, s) + cross(c, second) + b3[j] * d;
      }
      if constexpr (Rates >= 2) result.acceleration = c_rate + second;
    }
    return result;
  }

  /// Returns the derivative with respect to control point k, perturbed on the right, from the derivatives with respect
  /// to the steps.
  Matrix3<V> byControl(const StepMatrices<N, V>& by_step, std::size_t k) const {
    Matrix3<V> result = Matrix3<V>::Zero();
    if (k > 0) result += by_step[k - 1] * inverseJacobian(k - 1);
    if (k < steps) result -= by_step[k] * inverseJacobian(k).transpose();  // that on the left
    return result;
  }

 private:
  /// Carries derivatives over step j and adds those by this step. c, e: velocity and acceleration after A_j^T.
  template <int Derived>
  void derive(RateDerivatives<N, V>& result, std::size_t j, const Matrix3<V>& back,
              const mtk::vect<3, V>& angle, const V& b, const V& b1, const V& b2, const mtk::vect<3, V>& c,
              const mtk::vect<3, V>& e, const mtk::vect<3, V>& s) const {
    const Matrix3<V> by_angle = b * mtk::detail::rightJacobian<V>(angle);
    const Matrix3<V> moved = shiftedSkew<V>(V(0), c) * by_angle, skew = shiftedSkew<V>(V(0), s);
    for (std::size_t i = 0; i < j; ++i) {
      result.velocity_by_step[i] = back * result.velocity_by_step[i];
      if constexpr (Derived >= 2) {
        result.acceleration_by_step[i] =
            back * result.acceleration_by_step[i] - skew * result.velocity_by_step[i];
      }
    }
    result.velocity_by_step[j] = moved + b1 * Matrix3<V>::Identity();
    if constexpr (Derived >= 2) {
      result.acceleration_by_step[j] =
          shiftedSkew<V>(V(0), e) * by_angle - skew * moved + shiftedSkew<V>(b2, mtk::vect<3, V>(b1 * c));
    }
  }
  Matrix3<V> inverseJacobian(std::size_t j) const {
    return mtk::detail::inverseRightJacobian<V>(steps_[j], factors_[j], cosines_[j]);
  }

  Steps steps_;
  std::array<V, steps> factors_, cosines_;  ///< of the logarithm of each step, and its quaternion's real part
};

}  // namespace slom::trajectory::detail
