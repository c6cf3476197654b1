// Range-only SLAM on real data: a mowing robot with wheel odometry measures its distances to radio beacons at unknown
// places. The fit is updated after every fifth pose. Units: metre, radian, second.
//   data   ../shared/data/range_slam (CMU, Plaza 1): odometry, ranges, and the truth to compare with
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/QR>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>

using Point = mtk::vect<2>;
using Pose = mtk::trafo<mtk::SO2<>>;  // world_T_robot

/// Returns the rows of a file of numbers, without the header line.
std::vector<std::vector<double>> readCsv(const std::string& file) {
  std::ifstream in(file);
  std::vector<std::vector<double>> rows;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream numbers(line);
    rows.emplace_back();
    for (std::string number; std::getline(numbers, number, ',');) rows.back().push_back(std::stod(number));
  }
  return rows;
}

/// Locates a beacon from ranges to several places: differences of |x - p|^2 = r^2 are linear in x. Returns false if the
/// places are on a line.
bool locate(const std::vector<std::pair<slom::VarID<Pose>, double>>& ranges, Point& x) {
  Eigen::MatrixXd A(ranges.size(), 3);
  Eigen::VectorXd b(ranges.size());
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const Point p = ranges[i].first->pos;
    A.row(Eigen::Index(i)) << 2 * p[0], 2 * p[1], 1;
    b[Eigen::Index(i)] = p.squaredNorm() - ranges[i].second * ranges[i].second;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
  if (std::abs(qr.matrixQR()(2, 2)) < 1e-2 * std::abs(qr.matrixQR()(0, 0)) / std::sqrt(double(ranges.size())))
    return false;
  x = Point(qr.solve(b).head<2>());
  return true;
}

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: example_range_slam FOLDER, that of plaza1_odometry.csv\n");
    return 2;
  }
  const std::string folder = argv[1];
  const auto odometry = readCsv(folder + "/plaza1_odometry.csv"),
             ranges = readCsv(folder + "/plaza1_ranges.csv");
  const auto truth = readCsv(folder + "/plaza1_groundtruth.csv"),
             beacons = readCsv(folder + "/plaza1_beacons.csv");

  slom::Estimator est;
  // The map begins at the first true pose, so that map and truth can be compared.
  std::vector<slom::VarID<Pose>> poses{
      est.insertRV(Pose(Point(truth[0][1], truth[0][2]), mtk::SO2<>(truth[0][3])), false, "start")};
  const auto scale = est.insertRV(1.0, "scale");  // scale of the ranges: these radios measure too long
  est.insertMeasurement([](const auto& s) { return s - 1; }, scale, slom::StandardDeviation(0.1));
  struct Beacon {
    std::vector<std::pair<slom::VarID<Pose>, double>> ranges;  // kept until the beacon can be located
    slom::VarID<Point> position;
    bool is_located = false;
  };
  std::map<int, Beacon> map;
  const auto insertRange = [&](const slom::VarID<Pose>& pose, const slom::VarID<Point>& beacon,
                               double range) {
    est.insertMeasurement(
        [](const auto& robot, const auto& b, const auto& s) { return s * (b - robot.pos).norm(); }, pose,
        beacon, scale, slom::measured(range), slom::StandardDeviation(0.5), slom::Cauchy(1),
        slom::named("range"));
  };

  std::size_t next_range = 0;
  int unconverged = 0;
  Pose motion;  // motion since the last pose, and its variance
  mtk::vect<3> variance(0, 0, 0);
  for (std::size_t k = 0; k < odometry.size(); ++k) {
    const double time = odometry[k][0], forward = odometry[k][1], turn = odometry[k][2];
    motion =
        motion * Pose(Point(forward * std::cos(turn / 2), forward * std::sin(turn / 2)), mtk::SO2<>(turn));
    variance +=
        mtk::vect<3>(0.002 + 0.02 * std::abs(forward), 0.002, 0.0005 + 0.02 * std::abs(turn)).cwiseAbs2();
    if (next_range == ranges.size() || ranges[next_range][0] > time) continue;
    poses.push_back(est.insertRV(*poses.back() * motion));
    est.insertMeasurement(slom::RelativePose(), poses[poses.size() - 2], poses.back(), slom::measured(motion),
                          slom::Covariance(variance));
    motion = Pose();
    variance.setZero();
    for (; next_range < ranges.size() && ranges[next_range][0] <= time; ++next_range) {
      const double range = ranges[next_range][3];
      Beacon& beacon = map[int(ranges[next_range][2])];
      if (beacon.is_located) {
        insertRange(poses.back(), beacon.position, range);
        continue;
      }
      beacon.ranges.emplace_back(poses.back(), range);
      Point start;
      if (beacon.ranges.size() < 40 || !locate(beacon.ranges, start)) continue;
      beacon.position = est.insertRV(start, "beacon " + std::to_string(ranges[next_range][2]));
      beacon.is_located = true;
      for (const auto& [pose, r] : beacon.ranges) insertRange(pose, beacon.position, r);
    }
    if (poses.size() % 5 != 0) continue;
    const slom::UpdateSummary update = est.update();
    unconverged += update.converged ? 0 : 1;
    const double error = (poses.back()->pos - Point(truth[k + 1][1], truth[k + 1][2])).norm();
    if (poses.size() % 500 == 0) {
      std::printf("pose %4zu: %zu beacons, scale of ranges %.1f, %s of the true place\n", poses.size(),
                  map.size(), *scale, error < 2 ? "within 2 m" : "not within 2 m");
    }
  }
  for (auto& [number, beacon] : map) {
    if (!beacon.is_located) continue;
    double nearest = INFINITY;
    for (const auto& row : beacons)
      nearest = std::min(nearest, (*beacon.position - Point(row[1], row[2])).norm());
    std::printf("beacon %d: %s of a true one\n", number, nearest < 1 ? "within 1 m" : "not within 1 m");
  }
  std::printf("updates that did not converge: %d\n", unconverged);
}
