#pragma once
// The filter that a program without a library has: inertial navigation with 15 error states, derivatives by hand, Eigen.

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace by_hand {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Mat15 = Eigen::Matrix<double, 15, 15>;

inline Mat3 cross(const Vec3& v) {
  Mat3 M;
  M << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return M;
}
inline Eigen::Quaterniond exponential(const Vec3& phi) {
  const double angle = phi.norm();
  if (angle < 1e-10) return Eigen::Quaterniond(1, phi[0] / 2, phi[1] / 2, phi[2] / 2).normalized();
  const Vec3 v = phi * (std::sin(angle / 2) / angle);
  return Eigen::Quaterniond(std::cos(angle / 2), v[0], v[1], v[2]);
}
inline Mat3 rightJacobian(const Vec3& phi) {
  const double angle = phi.norm();
  const Mat3 M = cross(phi);
  if (angle < 1e-5) return Mat3::Identity() - M / 2;
  return Mat3::Identity() - (1 - std::cos(angle)) / (angle * angle) * M +
         (angle - std::sin(angle)) / (angle * angle * angle) * M * M;
}

/// Error state: position, rotation in the body, velocity, biases of gyroscope and accelerometer.
struct Filter {
  Vec3 p = Vec3::Zero(), v = Vec3::Zero(), gyro_bias = Vec3::Zero(), force_bias = Vec3::Zero();
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Mat15 P;

  void predict(const Vec3& gyro, const Vec3& force, double dt, const Mat15& Q) {
    const Vec3 half = (gyro - gyro_bias) * (dt / 2), f = force - force_bias;
    const Eigen::Quaterniond half_turn = exponential(half), middle = q * half_turn;
    const Mat3 R = middle.toRotationMatrix(), back = half_turn.toRotationMatrix().transpose(),
               J = rightJacobian(half);
    const Vec3 gained = (R * f - Vec3(0, 0, 9.81)) * dt;
    const Mat3 gained_by_turn = -R * cross(f) * back * dt, gained_by_bias = R * cross(f) * J * (dt * dt / 2);
    Mat15 F = Mat15::Identity();
    F.block<3, 3>(0, 3) = gained_by_turn * (dt / 2);
    F.block<3, 3>(0, 6).diagonal().setConstant(dt);
    F.block<3, 3>(0, 9) = gained_by_bias * (dt / 2);
    F.block<3, 3>(0, 12) = -R * (dt * dt / 2);
    F.block<3, 3>(3, 3) = back * back;
    F.block<3, 3>(3, 9) = -(back + Mat3::Identity()) * J * (dt / 2);
    F.block<3, 3>(6, 3) = gained_by_turn;
    F.block<3, 3>(6, 9) = gained_by_bias;
    F.block<3, 3>(6, 12) = -R * dt;
    p += v * dt + gained * (dt / 2);
    q = (middle * half_turn).normalized();
    v += gained;
    P = F * P * F.transpose() + Q;
  }

  void updatePosition(const Vec3& position, double sigma) {
    Eigen::Matrix<double, 3, 15> H = Eigen::Matrix<double, 3, 15>::Zero();
    H.block<3, 3>(0, 0).setIdentity();
    const Eigen::Matrix<double, 15, 3> PHt = P * H.transpose();
    const Mat3 S = H * PHt + sigma * sigma * Mat3::Identity();
    const Eigen::Matrix<double, 15, 3> K = S.llt().solve(PHt.transpose()).transpose();
    const Eigen::Matrix<double, 15, 1> d = K * (position - p);
    const Mat15 I_KH = Mat15::Identity() - K * H;
    P = (I_KH * P * I_KH.transpose() + sigma * sigma * K * K.transpose()).eval();
    p += d.segment<3>(0);
    const Vec3 turn = d.segment<3>(3);
    q = (q * exponential(turn)).normalized();
    v += d.segment<3>(6);
    gyro_bias += d.segment<3>(9);
    force_bias += d.segment<3>(12);
    const Mat3 J = rightJacobian(turn);
    P.middleRows<3>(3) = (J * P.middleRows<3>(3)).eval();
    P.middleCols<3>(3) = (P.middleCols<3>(3) * J.transpose()).eval();
  }
};

}  // namespace by_hand
