// The noise of corners and readings, from what the fit leaves of their residuals.
//   square of the factor of a standard deviation = sum of squares of whitened residuals / their expected sum
//   expected sum = rows - sum of the traces of J C J^T, with C the covariance of the variables; from a sample, because each
//                  needs the joint covariance of its variables
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "calibration/streams/splines/problem.hpp"
#include "calibration/streams/splines/reading_on_spline.hpp"

namespace slom::calibration {
namespace {

constexpr std::size_t sample_size = 8;  ///< measurements of each kind, spread evenly

/// Calls each(i) for a sample of 0, ..., count - 1.
void eachOfSample(std::size_t count, auto&& each) {
  const std::size_t step = std::max<std::size_t>(1, count / sample_size);
  for (std::size_t i = step / 2; i < count; i += step) each(i);
}

/// Returns the root of the mean square over the expected one.
class Ratio {
 public:
  void addSquares(const Eigen::VectorXd& whitened) { squares_ += whitened.squaredNorm(), ++count_; }
  void addExpected(double rows, double absorbed) { expected_ += rows - absorbed, ++sample_; }
  double value() const { return std::sqrt(squares_ / count_ / (expected_ / sample_)); }

 private:
  double squares_ = 0, count_ = 0, expected_ = 0, sample_ = 0;
};

/// Columns of a joint covariance.
struct Columns {
  std::vector<Eigen::Index> all{};

  Columns& operator+=(const Columns& more) {
    all.insert(all.end(), more.all.begin(), more.all.end());
    return *this;
  }
  friend Columns operator+(Columns a, const Columns& b) { return a += b; }
};

/// Variables with the columns of each in their joint covariance.
class JoinedColumns {
 public:
  /// Adds variables and returns their columns.
  template <class... T>
  Columns add(const VarID<T>&... ids) {
    Columns columns;
    const auto append = [&](const AnyVarID& id, int dof) {
      variables_.push_back(id);
      for (int i = 0; i < dof; ++i) columns.all.push_back(next_++);
    };
    (append(ids, int(T::DOF)), ...);
    return columns;
  }
  const std::vector<AnyVarID>& variables() const { return variables_; }

 private:
  std::vector<AnyVarID> variables_;
  Eigen::Index next_ = 0;
};

}  // namespace

double SplineProblem::cornersRatio() const {
  Ratio ratio;
  for (const AnyMeasID& view : views_) ratio.addSquares(est_.whitenedResidual(view));
  eachOfSample(views_on_splines_.size(), [&](std::size_t i) {
    const PlacedView& view = views_on_splines_[i];
    const Eigen::MatrixXd J = view.jacobian();
    const double variance = start_.sigma_px * start_.sigma_px;
    ratio.addExpected(6, (J * est_.jointCovariance(view.variables) * J.transpose()).trace() / variance);
  });
  return ratio.value();
}

SplineProblem::Ratios SplineProblem::ratiosOf(const Imu& imu) const {
  Ratio gyro, force;
  for (const Reading& reading : imu.readings) {
    gyro.addSquares(est_.whitenedResidual(reading.gyro.id()));
    force.addSquares(est_.whitenedResidual(reading.force.id()));
  }
  const double gyro_variance = imu.noise.gyro * imu.noise.gyro * imu.rate,
               force_variance = imu.noise.force * imu.noise.force * imu.rate;
  eachOfSample(imu.readings.size(), [&](std::size_t i) {
    const auto [gyro_covariance, force_covariance] = predictedCovariances(imu, imu.readings[i]);
    gyro.addExpected(3, gyro_covariance.trace() / gyro_variance);
    force.addExpected(3, force_covariance.trace() / force_variance);
  });
  return {gyro.value(), force.value()};
}

std::pair<Eigen::Matrix3d, Eigen::Matrix3d> SplineProblem::predictedCovariances(
    const Imu& imu, const Reading& reading) const {
  const double time = reading.sample->time;
  const RigSpline& spline = splines_[reading.stretch];
  const ControlRange pose = controlsAt(spline, time - double(*imu.offset)),
                     bias = controlsAt(imu.gyro_bias, time);
  const auto first = spline.controls().begin() + std::ptrdiff_t(pose.first);
  const auto biasAt = [&](const Bias& one, std::size_t k) { return one.controls()[bias.first + k]; };
  const AxesVariables& axes = imu.axes;
  JoinedColumns joined;
  Columns poses;
  for (std::size_t k = 0; k < pose_order; ++k) poses += joined.add(first[std::ptrdiff_t(k)]);
  const Columns gyro_bias = joined.add(biasAt(imu.gyro_bias, 0), biasAt(imu.gyro_bias, 1)),
                force_bias = joined.add(biasAt(imu.force_bias, 0), biasAt(imu.force_bias, 1)),
                place = joined.add(imu.left2imu, imu.offset), world = joined.add(up_, board_scale_);
  const bool has_axes = axes.exist();
  const Columns of_gyro = has_axes ? joined.add(axes.gyro_axes, axes.gyro_by_force) : Columns(),
                of_force = has_axes ? joined.add(axes.force_axes, axes.force_places) : Columns();
  const Eigen::MatrixXd joint = est_.jointCovariance(joined.variables());  // once, because it takes long
  const auto propagated = [&](const auto& function, const Bias& bias_spline, const Columns& columns,
                              const auto&... ids) {
    const auto on =
        trajectory::detail::onSegments<trajectory::PoseSegment<pose_order>, trajectory::VectorSegment<3, 2>>(
            function, {trajectory::Blending<pose_order>(spline.knots(), pose.segment),
                       trajectory::Blending<2>(bias_spline.knots(), bias.segment)});
    const auto at_time = [&](const auto&... values) { return on(values..., time); };
    return [&]<std::size_t... K>(std::index_sequence<K...>) {
      const Eigen::MatrixXd covariance = joint(columns.all, columns.all);
      return Eigen::Matrix3d(est_.propagate(at_time, covariance, first[K]..., biasAt(bias_spline, 0),
                                            biasAt(bias_spline, 1), imu.left2imu, imu.offset, ids...)
                                 .covariance);
    }(std::make_index_sequence<pose_order>());
  };
  const double gravity = recording_.gravity;
  const Columns on_gyro = poses + gyro_bias + place, on_force = poses + force_bias + place + world;
  if (!has_axes)
    return {propagated(GyroOnSpline(), imu.gyro_bias, on_gyro),
            propagated(ForceOnSpline{gravity}, imu.force_bias, on_force, up_, board_scale_)};
  return {propagated(GyroWithAxesOnSpline{gravity}, imu.gyro_bias, on_gyro + world + of_gyro, up_,
                     board_scale_, axes.gyro_axes, axes.gyro_by_force),
          propagated(ForceWithAxesOnSpline{gravity}, imu.force_bias, on_force + of_force, up_, board_scale_,
                     axes.force_axes, axes.force_places)};
}

SplineValues SplineProblem::withEstimatedNoise() const {
  constexpr double least_density = 1e-7;
  SplineValues next = values();
  next.sigma_px *= limited(cornersRatio());
  for (std::size_t i = 0; i < imus_.size(); ++i) {
    if (imus_[i].stream->noise) continue;
    const Ratios ratios = ratiosOf(imus_[i]);
    ImuNoise& noise = next.imus[i].noise;
    noise.gyro = std::max(least_density, noise.gyro * limited(ratios.gyro));
    noise.force = std::max(least_density, noise.force * limited(ratios.force));
  }
  return next;
}

}  // namespace slom::calibration
