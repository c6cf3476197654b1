#include "calibration/fit/measurements.hpp"

#include <type_traits>

namespace slom::calibration {
namespace {

template <class T>
using ScalarOf = typename std::decay_t<T>::scalar;

constexpr auto gravity_in_reading = [](const auto& left2world, const auto& left2imu, const auto& acc_bias,
                                       const auto& gravity, const vec3& acc) {
  using S = ScalarOf<decltype(left2world)>;
  const mtk::vect<3, S> acc_in_imu(acc.template cast<S>() - acc_bias);
  mtk::vect<3, S> difference = left2world.orient * (left2imu.inverse() * acc_in_imu);
  difference[2] -= gravity;
  return difference;
};

}  // namespace

vec3 gravityResidual(const SE3& left2world, const SO3& left2imu, const vec3& acc_bias, double gravity,
                     const vec3& acc) {
  return gravity_in_reading(left2world, left2imu, acc_bias, mtk::Scalar<>(gravity), acc);
}

void insertReading(Estimator& estimator, const VarID<SE3>& left2world, const VarID<SO3>& left2imu,
                   const VarID<vec3>& acc_bias, const VarID<mtk::Scalar<>>& gravity, const vec3& acc,
                   double sigma_acc) {
  estimator.insertMeasurement(gravity_in_reading, left2world, left2imu, acc_bias, gravity, acc,
                              StandardDeviation(sigma_acc));
}

}  // namespace slom::calibration
