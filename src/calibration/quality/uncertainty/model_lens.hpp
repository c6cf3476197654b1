// The lens of one camera model.
#pragma once

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "calibration/models/camera.hpp"
#include "calibration/quality/uncertainty/lens.hpp"

namespace slom::calibration {

/// The sum of u u^T + v v^T over rows u, v of Jacobians, its lower triangle by blocks of four rows. Sizes and
/// loops are known to the compiler: hundreds of candidates for the next best view have a hundred points each.
template <int N>
class SumOfSquares {
  static constexpr int blocks = (N + 3) / 4;
  using Column = std::array<Eigen::Array4d, blocks>;

 public:
  class Row {
   public:
    Row() { blocks_.fill(Eigen::Array4d::Zero()); }
    double* data() { return blocks_.front().data(); }

   private:
    friend class SumOfSquares;
    Column blocks_;
  };

  SumOfSquares() { columns_.fill(Row().blocks_); }
  void add(const Row& u, const Row& v) {
    addColumns(u.blocks_, v.blocks_, std::make_integer_sequence<int, N>(),
               std::make_integer_sequence<int, blocks>());
  }
  Eigen::Matrix<double, N, N> square() const {
    Eigen::Matrix<double, N, N> square;
    for (int j = 0; j < N; ++j) {
      for (int i = j; i < N; ++i) square(i, j) = square(j, i) = columns_[j][i / 4][i % 4];
    }
    return square;
  }

 private:
  template <int... j, int... block>
  void addColumns(const Column& u, const Column& v, std::integer_sequence<int, j...>,
                  std::integer_sequence<int, block...> all) {
    (addColumn<j>(u, v, all), ...);
  }
  template <int j, int... block>
  void addColumn(const Column& u, const Column& v, std::integer_sequence<int, block...>) {
    const double a = u[j / 4][j % 4], b = v[j / 4][j % 4];
    (addBlock<j, block>(u, v, a, b), ...);
  }
  template <int j, int block>
  void addBlock(const Column& u, const Column& v, double a, double b) {
    if constexpr (block >= j / 4) columns_[j][block] += a * u[block] + b * v[block];
  }

  std::array<Column, N> columns_;
};

template <class Camera>
class ModelLens : public Lens {
 public:
  explicit ModelLens(const Camera& camera) : camera_(camera) {
    scale_ = derivativesOf(camera_, Eigen::Vector3d(0, 0, 1)).by_point.norm() / std::sqrt(2.0);
    if constexpr (Camera::start_lens == StartLens::equidistant) least_z_ = -0.99;
  }

  int parameters() const override { return n; }

  vec2 project(const vec3& point) const override { return vec2(camera_.project(point)); }

  Projection differentiate(const vec3& point) const override {
    const auto d = derivativesOf(camera_, point);
    return {{vec2(d.pixel), d.by_point}, d.by_parameters};
  }

  PointProjection differentiateByPoint(const vec3& point) const override {
    const auto d = derivativesOf(camera_, point);
    return {vec2(d.pixel), d.by_point};
  }

  Square square(const SE3& left2camera, const SE3& left2world, const std::vector<vec3>& points,
                const std::vector<double>& sigmas) const override {
    const Eigen::Matrix3d R = left2camera.orient.toRotationMatrix();
    const Eigen::Matrix3d world2left = left2world.orient.toRotationMatrix().transpose();
    const Eigen::Vector3d origin = left2world.pos, offset = left2camera.pos;
    SumOfSquares<n + 6> sum;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double weight = sigmas.empty() ? 1 : 1 / sigmas[k];
      const Eigen::Vector3d in_left = world2left * (Eigen::Vector3d(points[k]) - origin);
      const auto d = derivativesOf(camera_, Eigen::Vector3d(R * in_left) + offset);
      typename SumOfSquares<n + 6>::Row rows[2];
      for (int row = 0; row < 2; ++row) {
        const Eigen::Vector3d by_point = weight * d.by_point.row(row), by_left = R.transpose() * by_point,
                              by_turn = in_left.cross(by_left);
        double* const J = rows[row].data();
        for (int i = 0; i < n; ++i) J[i] = weight * d.by_parameters(row, i);
        for (int i = 0; i < 3; ++i) J[n + i] = by_point[i], J[n + 3 + i] = by_turn[i];
      }
      sum.add(rows[0], rows[1]);
    }
    return sum.square();
  }

 private:
  static constexpr int n = Camera::DOF;
  Camera camera_;
};

}  // namespace slom::calibration
