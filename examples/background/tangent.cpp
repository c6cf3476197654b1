// The tangent space: a robot that loses its heading, and the side on which rotations are perturbed.
#include <cmath>

#include <mtk/testing/random.hpp>
#include <slom/measurements.hpp>
#include <slom/slom.hpp>

#include "pages.hpp"
#include "plot.hpp"
#include "text.hpp"

namespace {

using Pose = mtk::trafo<mtk::SO2<>>;  // maps points from the robot's frame to the world
using Vec3 = Eigen::Vector3d;

constexpr int kSteps = 10;
const Vec3 kStepSigma(0.02, 0.02, 0.08);  // of each step of 1 m: along, across [m], heading [rad]

/// A drive along x. Every step is measured; no landmark is seen.
struct Drive {
  slom::Estimator est;
  std::vector<slom::VarID<Pose>> poses;
  Drive() {
    const Pose step(mtk::vect<2>(1, 0));
    poses.push_back(est.insertRV(Pose(), false, "start"));
    for (int i = 0; i < kSteps; ++i) {
      poses.push_back(est.insertRV(*poses.back() * step, "pose"));
      est.insertMeasurement(slom::RelativePose(), poses[std::size_t(i)], poses.back(), slom::measured(step),
                            slom::StandardDeviation(kStepSigma));
    }
    est.optimize();
  }
};

/// Returns the ends of simulated drives with such errors.
std::vector<Pose> ends(int count) {
  mtk::testing::Random noise(11);
  std::vector<Pose> result;
  for (int i = 0; i < count; ++i) {
    Pose pose;
    for (int k = 0; k < kSteps; ++k) {
      Vec3 error;
      for (double& e : error) e = noise.normal();
      pose = pose * mtk::moved(Pose(mtk::vect<2>(1, 0)), Vec3(kStepSigma.cwiseProduct(error)));
    }
    result.push_back(pose);
  }
  return result;
}

void printTangent(std::ostream& os) {
  const Drive drive;
  const Vec3 sigma = drive.est.standardDeviation(drive.poses.back());
  const std::vector<Pose> samples = ends(2000);
  Vec3 mean(0, 0, 0), square(0, 0, 0);
  for (const Pose& end : samples) {
    const Vec3 d = mtk::difference(end, *drive.poses.back());
    mean += d / double(samples.size());
    square += d.cwiseProduct(d) / double(samples.size());
  }
  const Vec3 spread = (square - mean.cwiseProduct(mean)).cwiseSqrt();
  os << "after 10 m                   x [m]   y [m]  heading [rad]\n";
  os << format("standard deviation, fit     %6.3f  %6.3f  %6.3f\n", sigma.x(), sigma.y(), sigma.z());
  os << format("spread of 2000 drives       %6.3f  %6.3f  %6.3f\n", spread.x(), spread.y(), spread.z());
  os << format("mean of 2000 drives         %6.3f  %6.3f  %6.3f\n\n", mean.x(), mean.y(), mean.z());

  slom::Estimator est;
  const mtk::SO3<> upright = mtk::SO3<>::exp(Vec3(1.5707963267949, 0, 0));
  const auto R = est.insertRV(upright, "R");
  est.insertMeasurement(slom::Prior(), R, slom::measured(upright),
                        slom::StandardDeviation(Vec3(0.01, 0.02, 0.03)));
  est.optimize();
  const Eigen::Matrix3d right = est.covariance(R), M = R->toRotationMatrix(),
                        left = M * right * M.transpose();
  const Vec3 in_body = right.diagonal().cwiseSqrt(), in_world = left.diagonal().cwiseSqrt();
  os << format("R exp(d), axes of the body:  %.3f %.3f %.3f rad\n", in_body.x(), in_body.y(), in_body.z());
  os << format("exp(d) R, axes of the world: %.3f %.3f %.3f rad\n", in_world.x(), in_world.y(), in_world.z());
}

std::string drawTangent() {
  const Drive drive;
  Plot plot(740, 440);
  plot.diagram({70, 20, 650, 360, 0, 13, -3.6, 3.6});
  plot.ticks(2, 2, "x [m]", "y [m]");
  for (const Pose& end : ends(600)) plot.dot(end.pos, "#9db4c8", 2);
  Points way;
  for (const auto& pose : drive.poses) way.push_back(pose->pos);
  plot.curve(way, kBlack, 1.5);
  for (const Vec2& p : way) plot.dot(p, kBlack, 3);
  for (const std::size_t i : {4u, 7u, 10u})
    plot.ellipse(drive.poses[i]->pos, drive.est.covariance(drive.poses[i]).topLeftCorner<2, 2>(), 5.991,
                 kGreen);
  plot.text({8.8, -3.2}, "ends of 600 drives", kGrey, 0, 0, "end");
  plot.text({10.3, 0.3}, "95 %, by the fit", kGreen, 10, 0);
  return plot.svg();
}

}  // namespace

const Page kTangent{"tangent", &printTangent, &drawTangent};
