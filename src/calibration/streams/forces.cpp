#include "calibration/streams/forces.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "calibration/streams/check.hpp"

namespace slom::calibration {
namespace {

/// At an image: the mean reading, the acceleration of the reference camera, and the rotation of the world, both in the
/// axes of the IMU.
struct ForceAtImage {
  Eigen::Vector3d reading, acceleration;
  Eigen::Matrix3d world2imu;
};

/// Returns the mean reading within a reach of a time; false: there are none.
bool meanForce(const std::vector<ImuSample>& samples, double time, double reach, Eigen::Vector3d& mean) {
  const auto before = [](const ImuSample& s, double t) { return s.time < t; };
  const auto first = std::lower_bound(samples.begin(), samples.end(), time - reach, before);
  const auto last = std::lower_bound(first, samples.end(), time + reach, before);
  if (first == last) return false;
  mean.setZero();
  for (auto s = first; s != last; ++s) mean += s->force / double(last - first);
  return true;
}

/// Returns what second differences of positions, over about 0.1 s to either side, say about accelerations.
std::vector<ForceAtImage> forcesAtImages(const ImuStream& imu, const std::vector<RigAtImage>& images,
                                         const RatesStart& start) {
  constexpr double least = 0.1, most = 0.3;  // s
  std::vector<ForceAtImage> forces;
  std::size_t a = 0, b = 0;
  for (const RigAtImage& at : images) {
    while (at.time - images[a + 1].time >= least) ++a;
    while (b + 1 < images.size() && images[b].time - at.time < least) ++b;
    const double back = at.time - images[a].time, ahead = images[b].time - at.time;
    if (back < least || back > most || ahead < least || ahead > most) continue;
    ForceAtImage force;
    // Differences weight accelerations as a triangle; the mean has the same spread.
    if (!meanForce(imu.samples, at.time + start.offset, (back + ahead) / 2 * std::sqrt(0.5), force.reading))
      continue;
    const Eigen::Vector3d acceleration = ((images[b].left2world.pos - at.left2world.pos) / ahead -
                                          (at.left2world.pos - images[a].left2world.pos) / back) *
                                         (2 / (back + ahead));
    force.world2imu = (start.left2imu * at.left2world.orient.inverse()).toRotationMatrix();
    force.acceleration = force.world2imu * acceleration;
    forces.push_back(force);
  }
  return forces;
}

/// Returns how far readings in other axes are from the motion, as root mean square, with the gravity and bias that fit
/// best [m/s^2].
double misfitOfForces(const std::vector<ForceAtImage>& forces, const Eigen::Matrix3d& axes) {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  Matrix6 N = Matrix6::Zero();
  N.diagonal().tail<3>().setConstant(1e-3 *
                                     double(forces.size()));  // of the bias, which may look like gravity
  Vector6 right = Vector6::Zero();
  double squares = 0;
  for (const ForceAtImage& force : forces) {
    Eigen::Matrix<double, 3, 6> J;
    J << -force.world2imu, Eigen::Matrix3d::Identity();
    const Eigen::Vector3d y = axes * force.reading - force.acceleration;
    N += J.transpose() * J;
    right += J.transpose() * y;
    squares += y.squaredNorm();
  }
  const Vector6 x = N.ldlt().solve(right);
  return std::sqrt(std::max(0., squares - x.dot(right)) / double(forces.size()));
}

/// Returns the axes as text: (x, -z, y).
std::string textOf(const Eigen::Matrix3d& axes) {
  std::string text;
  for (int row = 0; row < 3; ++row) {
    Eigen::Index column = 0;
    axes.row(row).cwiseAbs().maxCoeff(&column);
    text += (row > 0 ? ", " : "") + std::string(axes(row, column) < 0 ? "-" : "") + "xyz"[column];
  }
  return "(" + text + ")";
}

/// Calls f(axes) for all axes that differ from the given ones by their order and their signs.
void forEachAxes(const auto& f) {
  int order[3] = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
      for (int row = 0; row < 3; ++row) axes(row, order[row]) = (signs >> row & 1) ? -1 : 1;
      f(axes);
    }
  } while (std::next_permutation(order, order + 3));
}

}  // namespace

std::string remedyOfHand(const ImuStream& imu, const std::vector<RigAtImage>& images, RatesStart start,
                         const Eigen::Matrix3d& mirrored) {
  const Eigen::Matrix3d mirror = -Eigen::Matrix3d::Identity();
  double least = INFINITY, of_both = INFINITY;
  Eigen::Matrix3d best = mirror;
  forEachAxes([&](const Eigen::Matrix3d& axes) {
    if (axes.determinant() > 0) return;
    start.left2imu = SO3(Eigen::Matrix3d(axes * mirrored));
    const std::vector<ForceAtImage> forces = forcesAtImages(imu, images, start);
    if (forces.empty()) return;
    const double rms = misfitOfForces(forces, Eigen::Matrix3d::Identity());
    if (rms < least) least = rms, best = axes;
    of_both = std::min(of_both, misfitOfForces(forces, axes));
  });
  if (least < of_both / 2)
    return fmt::format("give {} as their axes, and leave the forces as they are", textOf(best));
  return "change the sign of one axis, or exchange two, in angular velocity and force";
}

void requireForcesOfMotion(const ImuStream& imu, const std::vector<RigAtImage>& images,
                           const RatesStart& start) {
  constexpr std::size_t fewest = 10;
  const std::vector<ForceAtImage> forces = forcesAtImages(imu, images, start);
  if (forces.size() < fewest) return;
  const double given = misfitOfForces(forces, Eigen::Matrix3d::Identity());
  double least = given;
  Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
  forEachAxes([&](const Eigen::Matrix3d& axes) {
    const double rms = misfitOfForces(forces, axes);
    if (rms < least) least = rms, best = axes;
  });
  if (least > given / 2) return;
  badStream(
      imu,
      fmt::format(
          "the specific forces fit the motion of the cameras if {} are their axes: {:.2g} m/s^2 off instead of "
          "{:.2g}",
          textOf(best), least, given),
      "give forces and angular velocities in the same axes, and forces that point upwards at rest");
}

}  // namespace slom::calibration
