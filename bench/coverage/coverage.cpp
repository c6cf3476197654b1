// Coverage of 95 % intervals, stated and clustered, in simulated calibrations, pose graphs and regressions. Prints
// docs/coverage.md. On this page, the section on sizes of groups has 1000 simulations, as `250 --sizes` makes them.
//
//   bench_coverage [RUNS] [--sizes]
//     RUNS     number of simulations for each row; 1000 by default; 4 times as many in the section on sizes of groups
//     --sizes  prints only the section on sizes of groups
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include <slom/analyze/clustered.hpp>
#include <slom/analyze/student.hpp>
#include <slom/measurements.hpp>
#include <slom/slom.hpp>

#include "calibration/simulated_rig.hpp"
#include "coverage/group_sizes.hpp"

namespace {

constexpr double kNormal = 1.959964;
constexpr std::array kGroups{10, 20, 50, 200};

/// Composition of the errors of a group.
struct Errors {
  const char* name;
  double shared;  // size of the part shared by the group
  double memory;  // correlation of this part between successive groups
  bool is_ordered = false;
};

/// Coverage of all parameters together, and of the parameter with the lowest coverage.
struct Coverage {
  long stated = 0, clustered = 0, all = 0;
  std::vector<long> by_parameter;  // clustered
  double ratio = 0;                // of variances, clustered over stated
  int runs = 0;

  void add(std::size_t parameter, double error, double stated_std, double clustered_std, double dof) {
    by_parameter.resize(std::max(by_parameter.size(), parameter + 1));
    stated += std::abs(error) <= kNormal * stated_std;
    const bool holds = std::abs(error) <= slom::studentCritical(0.05, dof) * clustered_std;
    clustered += holds;
    by_parameter[parameter] += holds;
    ratio += std::pow(clustered_std / stated_std, 2);
    ++all;
  }
  void print(const char* what, int groups) const {
    long least = runs, most = 0;
    for (const long count : by_parameter) least = std::min(least, count), most = std::max(most, count);
    std::printf("| %s | %d | %.1f %% | **%.1f %%** | %.1f to %.1f %% | %.2f |\n", what, groups,
                100.0 * stated / all, 100.0 * clustered / all, 100.0 * least / runs, 100.0 * most / runs,
                std::sqrt(ratio / all));
  }
};

/// Simulates one camera. Each image appears a little larger or smaller than the lens implies.
Coverage calibrations(int images, const Errors& errors, int runs) {
  namespace calib = slom::calibration;
  calib::testing::RigOptions options;
  options.cameras = 1;
  options.images = images;
  options.columns = 6;
  options.rows = 5;
  options.square_m = 0.07;
  calib::Settings settings;
  settings.robust = calib::Robust::none;
  std::mt19937_64 random(17);
  std::normal_distribution<> normal;
  Coverage coverage;
  for (int run = 0; run < runs; ++run) {
    const auto truth = calib::testing::simulateTruth(options, random);
    calib::Dataset data = calib::testing::simulateMeasurements(truth, options, random);
    data.imu.reset();
    double error = normal(random);
    for (calib::View& view : data.cameras[0].views) {
      for (calib::Corner& corner : view.corners)
        corner.pixel +=
            0.012 * errors.shared * error * calib::vec2(corner.pixel.x() - 330, corner.pixel.y() - 245);
      error = errors.memory * error + std::sqrt(1 - errors.memory * errors.memory) * normal(random);
    }
    const calib::Result result = calib::calibrate(data, settings);
    if (!result.success()) continue;
    ++coverage.runs;
    for (std::size_t i = 0; i < 4; ++i) {
      const calib::Parameter& p = result.cameras[0].parameters[i];
      coverage.add(i, p.value - truth.cameras[0][int(i)], p.std, p.std_clustered, p.dof);
    }
  }
  return coverage;
}

/// Simulates a round of places that is driven `rounds` times. In each round, odometry has its own scale and drifts
/// sideways.
Coverage poseGraphs(int rounds, const Errors& errors, int runs) {
  using Pose = mtk::trafo<mtk::SO2<>>;
  constexpr int places = 12;
  constexpr double length = 1, sigma_length = 0.02, sigma_angle = 0.01;
  std::mt19937_64 random(5);
  std::normal_distribution<> normal;
  std::vector<Pose> truth;
  for (int k = 0; k < places; ++k) {
    const double angle = 2 * M_PI * k / places;
    const double radius = length / (2 * std::sin(M_PI / places));
    truth.push_back(
        Pose(mtk::SO2<>(angle), mtk::vect<2>(radius * std::sin(angle), radius * (1 - std::cos(angle)))));
  }
  Coverage coverage;
  for (int run = 0; run < runs; ++run) {
    slom::Estimator est;
    est.setThreads(1);
    std::vector<slom::VarID<Pose>> poses;
    for (int k = 0; k < places; ++k) poses.push_back(est.insertRV(truth[std::size_t(k)], k > 0));
    std::array<double, 2> common{normal(random), normal(random)};
    for (int round = 0; round < rounds; ++round) {
      for (int k = 0; k + 1 < places; ++k) {
        const Pose& a = truth[std::size_t(k)];
        Pose step = a.inverse() * truth[std::size_t(k + 1)];
        const mtk::vect<3> noise(sigma_length * (normal(random) + errors.shared * common[0]),
                                 sigma_length * normal(random),
                                 sigma_angle * (normal(random) + errors.shared * common[1]));
        step = step * Pose(mtk::SO2<>(noise[2]), mtk::vect<2>(noise[0], noise[1]));
        const double both = std::sqrt(1 + errors.shared * errors.shared);
        est.insertMeasurement(
            slom::RelativePoseInFrameOfA(), poses[std::size_t(k)], poses[std::size_t(k + 1)],
            slom::measured(step),
            slom::StandardDeviation(mtk::vect<3>(sigma_length * both, sigma_length, sigma_angle * both)),
            slom::group(round));
      }
      for (double& c : common)
        c = errors.memory * c + std::sqrt(1 - errors.memory * errors.memory) * normal(random);
    }
    if (!est.optimize().converged) continue;
    const slom::Clustered clustered = slom::clustered(est, {.ordered = errors.is_ordered});
    ++coverage.runs;
    for (const std::size_t k : {std::size_t(places / 2), std::size_t(places - 1)}) {
      Eigen::Vector3d error;
      truth[k].boxminus(mtk::vectview<double, 3>(error.data()), *poses[k]);  // errors of either sign
      const Eigen::Vector3d stated = est.standardDeviation(poses[k]),
                            std = clustered.standardDeviation(poses[k]),
                            dof = clustered.degreesOfFreedom(poses[k]);
      for (int i = 0; i < 3; ++i)
        coverage.add(3 * (k == places - 1) + std::size_t(i), error[i], stated[i], std[i], dof[i]);
    }
  }
  return coverage;
}

void print(const char* title, const char* groups, Coverage (*simulate)(int, const Errors&, int), int runs) {
  std::printf(
      "\n## %s\n\n| errors | %s | stated holds | clustered holds | by parameter | clustered over stated |\n| --- | ---: | ---: | ---: | ---: | ---: |\n",
      title, groups);
  std::vector<Errors> all{{"independent", 0, 0}, {"shared within a group", 1, 0}};
  if (simulate == &poseGraphs) all.push_back({"shared within a group, taken in order", 1, 0, true});
  all.push_back({"shared, successive groups alike", 1, 0.6, true});
  for (const Errors& errors : all) {
    for (const int count : kGroups) {
      simulate(count, errors, runs).print(errors.name, count);
      std::fflush(stdout);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  int runs = 1000;
  bool only_sizes = false;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "--sizes") {
      only_sizes = true;
    } else {
      runs = std::max(1, std::atoi(argv[i]));
    }
  }
  if (only_sizes) {
    slom::bench::printGroupSizes(4 * runs);
    return 0;
  }
  std::printf(
      "# How often intervals hold\n\n"
      "This page gives the percentage of simulations in which an interval of 95 %% contains the true value. The intervals use stated or clustered standard deviations; clustered ones use Student's "
      "distribution with their degrees of freedom. `bench_coverage` wrote the page. For calibrations and pose graphs, each row has %d simulations, so each percentage has a standard deviation of %.1f %%. "
      "The section on [sizes of groups](#sizes-of-groups) has its own number of simulations.\n\n"
      "* \"By parameter\" gives the lowest and the highest percentage of single parameters.\n"
      "* \"Clustered over stated\" is the root mean square of the ratio of standard deviations. It is 1 if errors are independent.\n"
      "* \"Successive groups alike\": the shared error of a group has a correlation of 0.6 with the shared error of the next group. So the groups have about as much information as a quarter of them would have if they were independent.\n",
      runs, 100 * std::sqrt(0.05 * 0.95 / runs));
  print("Calibrations", "images", calibrations, runs);
  std::printf(
      "\nThe simulation has one camera and a board of 30 corners. Each image appears larger or smaller than the lens says, by about 1 %% (one standard deviation). The parameters are fx, fy, cx, cy. Groups are "
      "images. From 16 images on, the data decide how many successive images are taken together.\n");
  print("Pose graphs", "rounds", poseGraphs, runs);
  std::printf(
      "\nA robot drives a round of 12 places again and again. In each round, odometry has a scale and a sideways drift of its own. The parameters are x, y and heading of two places. Groups are rounds. "
      "`ordered` is set if successive rounds are alike, and in the rows \"taken in order\" although they are not.\n");
  slom::bench::printGroupSizes(4 * runs);
}
