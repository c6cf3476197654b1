// Online SLAM in the plane: a robot drives round a square again and again. After each step, it has the optimum of all
// measurements so far. The time for that is proportional to what the step changes. Units: metre, radian.
#include <cmath>
#include <cstdio>
#include <map>
#include <vector>

#include <mtk/testing/random.hpp>
#include <slom/measurements.hpp>
#include <slom/slom.hpp>

using Point = mtk::vect<2>;
using Pose = mtk::trafo<mtk::SO2<>>;  // world_T_robot

int main() {
  constexpr int kSide = 25, kSteps = 12 * kSide;
  constexpr double kSight = 4, kSigma = 0.05, kSigmaAngle = 0.003;
  mtk::testing::Random random(3);
  const auto noise = [&](double sigma) { return sigma * random.normal(); };
  const auto noisy = [&](Point p) {
    for (double& x : p) x += noise(kSigma);
    return p;
  };
  std::vector<Point> trees;
  for (int i = 0; i < 60; ++i)
    trees.push_back(Point{random.uniform(-4, kSide + 4), random.uniform(-4, kSide + 4)});

  slom::Estimator est;
  Pose truth;
  slom::VarID<Pose> pose = est.insertRV(truth, false, "start");
  std::map<int, slom::VarID<Point>> landmarks;  // the trees seen so far
  double largest_error = 0;
  for (int k = 1; k <= kSteps; ++k) {
    const Pose motion(Point(1, 0), mtk::SO2<>(k % kSide == 0 ? M_PI / 2 : 0));
    truth = truth * motion;
    const Point moved = noisy(motion.pos);
    const Pose odometry(moved, mtk::SO2<>(motion.orient.angle() + noise(kSigmaAngle)));
    const slom::VarID<Pose> next = est.insertRV(*pose * odometry, "pose " + std::to_string(k));
    est.insertMeasurement(slom::RelativePose(), pose, next, slom::measured(odometry),
                          slom::StandardDeviation(mtk::vect<3>(kSigma, kSigma, kSigmaAngle)));
    pose = next;
    for (int t = 0; t < int(trees.size()); ++t) {
      const Point seen = truth.inverse() * trees[std::size_t(t)];
      if (seen.norm() > kSight) continue;
      const Point measured = noisy(seen);
      if (!landmarks.count(t))
        landmarks.emplace(t, est.insertRV(Point(*pose * measured), "tree " + std::to_string(t)));
      est.insertMeasurement(slom::Landmark(), pose, landmarks.at(t), slom::measured(measured),
                            slom::StandardDeviation(kSigma));
    }

    const slom::UpdateSummary update = est.update();
    if (!update.converged) std::printf("pose %d: %s\n", k, update.message.c_str());
    largest_error = std::max(largest_error, (pose->pos - truth.pos).norm());
    if (k % (2 * kSide) == 0)
      std::printf("pose %3d: %2d trees, %4d residuals\n", k, int(landmarks.size()), est.getM());
  }
  std::printf("always within 2 m of the true place: %s\n", largest_error < 2 ? "yes" : "no");
  const double online = est.getRSS();
  const slom::Summary batch = est.optimize();
  std::printf("RSS / RSS of the batch fit - 1 is below 1e-6: %s\n",
              online / batch.final_rss - 1 < 1e-6 ? "yes" : "no");
}
