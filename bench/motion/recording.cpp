#include "recording.hpp"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <sstream>
#include <vector>

#include "fits.hpp"

namespace slom::bench {

namespace {

/// Returns the rows of numbers of a CSV file; lines that do not begin with a number are skipped.
std::vector<std::vector<double>> rows(const std::string& file) {
  std::vector<std::vector<double>> all;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::vector<double> numbers;
    std::stringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) {
      char* end = nullptr;
      const double x = std::strtod(cell.c_str(), &end);
      if (end == cell.c_str()) break;
      numbers.push_back(x);
    }
    if (numbers.size() >= 7) all.push_back(numbers);
  }
  return all;
}

}  // namespace

int fitRecording(const std::string& poses_file, const std::string& imu_file) {
  const auto poses = rows(poses_file), readings = rows(imu_file);
  if (poses.empty() || readings.empty()) {
    std::fprintf(stderr, "bench_motion: %s has %zu rows, %s has %zu; both must have some\n",
                 poses_file.c_str(), poses.size(), imu_file.c_str(), readings.size());
    return 2;
  }
  Recording all;
  const double start = poses.front()[0];
  for (const auto& p : poses) {
    if (p.size() < 8) continue;
    all.images.push_back({p[0] - start, Pose(Vec3(p[1], p[2], p[3]), Rotation(p[7], p[4], p[5], p[6]))});
  }
  for (const auto& r : readings)
    all.readings.push_back({r[0] * 1e-9 - start, Vec3(r[1], r[2], r[3]), Vec3(r[4], r[5], r[6])});
  all.noise = {8e-4, 0.014, 0, 0};  // as found from the residuals; see docs/streams.md
  all.position_sigma = 0.001, all.angle_sigma = 0.001;
  // The published axes of the sensor of EuRoC, roughly: body_T_camera turns about z by 90 degrees.
  all.body_T_camera = Pose(Vec3(), Rotation::exp(Vec3(0, 0, std::numbers::pi / 2)));

  std::printf(
      "| motion | offset [ms] | x, y, z [mm] | rotation vector [rad] | chi2/dof | unknowns | iterations | s |\n"
      "| --- | ---: | --- | --- | ---: | ---: | ---: | ---: |\n");
  const auto row = [&](const char* name, const Fit& fit) {
    const Vec3 p = fit.body_T_camera.pos, r = Rotation::log(fit.body_T_camera.orient);
    std::printf(
        "| %s | %.3f +- %.3f | %.1f, %.1f, %.1f +- %.1f | %.4f, %.4f, %.4f | %.2f | %d | %d | %.1f |%s\n",
        name, 1e3 * fit.offset, 1e3 * fit.offset_sigma, 1e3 * p[0], 1e3 * p[1], 1e3 * p[2],
        1e3 * std::sqrt(fit.covariance.topLeftCorner<3, 3>().trace() / 3), r[0], r[1], r[2], fit.chi2_per_dof,
        fit.unknowns, fit.iterations, fit.seconds, fit.converged ? "" : " did not converge");
    std::fflush(stdout);
  };
  row("preintegration", byPreintegration(all));
  row("spline of order 5, knots each 0.05 s", bySpline(all, 5, 0.05));
  row("spline of order 5, knots each 0.1 s", bySpline(all, 5, 0.1));
  row("spline of order 6, knots each 0.1 s", bySpline(all, 6, 0.1));
  row("noise on jerk, states each 0.05 s", byProcess(all, 0.05, 2000, 2000));
  row("noise on jerk, states each 0.1 s", byProcess(all, 0.1, 2000, 2000));
  return 0;
}

}  // namespace slom::bench
