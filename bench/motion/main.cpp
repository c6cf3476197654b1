// Which representation of a motion when: states at the images with preintegrated readings, B-splines, or a Gaussian
// process?
//
//   bench_motion [--seeds N] [--recording POSES.csv IMU.csv]
//
// First table: a camera and an IMU, simulated N times (10 s, moved by hand). Second table: two cameras with clocks of
// their own and a gyroscope. Errors are divided by their standard deviations (root mean square over seeds and
// components; 1 if the standard deviations hold), and given in units. `between`: the pose in the middle between two
// images. Times are those of the fits, on all threads. The program ends with status 1 if a fit by
// preintegration does not converge, or if its positions between images are off by more than 10 mm (RMS).
//
// With --recording it fits a recording instead: POSES.csv has lines `t_s, x, y, z, qx, qy, qz, qw` with world_T_camera,
// IMU.csv is a file of EuRoC.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <Eigen/Cholesky>

#include "fits.hpp"
#include "recording.hpp"

namespace {

using namespace slom::bench;

/// Root mean squares over fits.
struct Errors {
  double offset = 0, offset_ratio = 0, position = 0, angle = 0, position_ratio = 0, angle_ratio = 0;
  double between = 0, between_angle = 0, seconds = 0, iterations = 0, chi2 = 0;
  int unknowns = 0, fits = 0, failures = 0;

  void add(const Fit& fit, const Truth& truth, double duration) {
    ++fits;
    failures += fit.converged ? 0 : 1;
    unknowns = fit.unknowns;
    seconds += fit.seconds;
    iterations += fit.iterations;
    chi2 += fit.chi2_per_dof;
    const double d = fit.offset - truth.offset;
    offset += d * d;
    offset_ratio += d * d / (fit.offset_sigma * fit.offset_sigma);
    const Eigen::Matrix<double, 6, 1> e = mtk::difference(truth.body_T_camera, fit.body_T_camera);
    const Eigen::Matrix3d P = fit.covariance.topLeftCorner<3, 3>(),
                          R = fit.covariance.bottomRightCorner<3, 3>();
    position += e.head<3>().squaredNorm();
    angle += e.tail<3>().squaredNorm();
    position_ratio += e.head<3>().dot(P.llt().solve(e.head<3>())) / 3;
    angle_ratio += e.tail<3>().dot(R.llt().solve(e.tail<3>())) / 3;
    double sum = 0, turned = 0;
    int count = 0;
    for (double t = 0.525; t < duration - 0.5; t += 0.05) {
      const Pose true_pose(truth.motion.position(t), truth.motion.orientation(t));
      const Eigen::Matrix<double, 6, 1> off = mtk::difference(fit.poseAt(t), true_pose);
      sum += off.head<3>().squaredNorm();
      turned += off.tail<3>().squaredNorm();
      ++count;
    }
    between += sum / count;
    between_angle += turned / count;
  }
  double mean(double sum) const { return sum / fits; }
  double root(double sum) const { return std::sqrt(sum / fits); }
};

constexpr const char* kHeader =
    "| motion | offset [ms] | / sd | position [mm] | / sd | rotation [mrad] | / sd | between [mm] | [mrad] | chi2/dof | unknowns | "
    "iterations | s |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n";

/// Prints a row; returns whether the fits are good.
template <class F>
bool row(const std::string& name, int seeds, const F& fit) {
  constexpr double duration = 10;
  Errors errors;
  for (int seed = 0; seed < seeds; ++seed) {
    const Truth truth{Motion(std::uint64_t(seed)),
                      Pose(Vec3(0.05, -0.03, 0.02), Rotation::exp(Vec3(0.3, -0.2, 0.1)))};
    errors.add(fit(truth, duration, std::uint64_t(seed)), truth, duration);
  }
  std::printf("| %s | %.4f | %.2f | %.2f | %.2f | %.3f | %.2f | %.2f | %.2f | %.2f | %d | %.1f | %.2f |",
              name.c_str(), 1e3 * errors.root(errors.offset), errors.root(errors.offset_ratio),
              1e3 * errors.root(errors.position), errors.root(errors.position_ratio),
              1e3 * errors.root(errors.angle), errors.root(errors.angle_ratio),
              1e3 * errors.root(errors.between), 1e3 * errors.root(errors.between_angle),
              errors.mean(errors.chi2), errors.unknowns, errors.mean(errors.iterations),
              errors.mean(errors.seconds));
  if (errors.failures > 0) std::printf(" %d of %d did not converge", errors.failures, errors.fits);
  std::printf("\n");
  std::fflush(stdout);
  return errors.failures == 0 && errors.root(errors.between) < 0.01;
}

std::string text(const char* format, double a, double b) {
  char line[100];
  std::snprintf(line, sizeof line, format, a, b);
  return line;
}

/// Power spectral densities of white noise on jerk and on acceleration that are as large as the motion: its mean square
/// times the spacing of the states.
struct Densities {
  static constexpr double kJerk = 60, kAngularJerk = 60;  // RMS of a component [m/s^3, rad/s^3]
  static constexpr double kAcceleration = 4.5, kAngularAcceleration = 7;  // [m/s^2, rad/s^2]
};

bool cameraAndImu(int seeds) {
  std::printf("\n## A camera and an IMU\n\n%s", kHeader);
  bool good = row("preintegration", seeds, [](const Truth& truth, double duration, std::uint64_t seed) {
    return byPreintegration(simulate(truth, duration, seed));
  });
  for (const int order : {4, 5, 6}) {
    for (const double spacing : {0.05, 0.1, 0.2}) {
      row(text("spline of order %.0f, knots each %.2f s", order, spacing), seeds,
          [=](const Truth& truth, double duration, std::uint64_t seed) {
            return bySpline(simulate(truth, duration, seed), order, spacing);
          });
    }
  }
  for (const double spacing : {0.05, 0.1, 0.2}) {
    for (const double factor : {100.0, 1.0, 0.01}) {
      row(text("noise on jerk, states each %.2f s, density x %.2g", spacing, factor), seeds,
          [=](const Truth& truth, double duration, std::uint64_t seed) {
            const double linear = factor * Densities::kJerk * Densities::kJerk * spacing,
                         angular = factor * Densities::kAngularJerk * Densities::kAngularJerk * spacing;
            return byProcess(simulate(truth, duration, seed), spacing, linear, angular);
          });
    }
  }
  return good;
}

void asynchronous(int seeds) {
  std::printf("\n## Two cameras with clocks of their own, and a gyroscope\n\n%s", kHeader);
  for (const double spacing : {0.05, 0.1, 0.2}) {
    row(text("spline of order %.0f, knots each %.2f s", 5, spacing), seeds,
        [=](const Truth& truth, double duration, std::uint64_t seed) {
          return bySpline(simulateAsynchronous(truth, duration, seed), 5, spacing);
        });
  }
  for (const bool on_jerk : {false, true}) {
    for (const double spacing : {0.05, 0.1, 0.2}) {
      row(text(on_jerk ? "noise on jerk, states each %.2f s" : "noise on acceleration, states each %.2f s",
               spacing, 0),
          seeds, [=](const Truth& truth, double duration, std::uint64_t seed) {
            const double linear = on_jerk ? Densities::kJerk : Densities::kAcceleration,
                         angular = on_jerk ? Densities::kAngularJerk : Densities::kAngularAcceleration;
            return byProcess(simulateAsynchronous(truth, duration, seed), on_jerk, spacing,
                             linear * linear * spacing, angular * angular * spacing);
          });
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  int seeds = 10;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--seeds") == 0 && i + 1 < argc) {
      seeds = std::atoi(argv[++i]);
    } else if (std::strcmp(argv[i], "--recording") == 0 && i + 2 < argc) {
      return fitRecording(argv[i + 1], argv[i + 2]);
    } else {
      std::fprintf(stderr, "bench_motion [--seeds N] [--recording POSES.csv IMU.csv]\n");
      return 2;
    }
  }
  const bool good = cameraAndImu(seeds);
  asynchronous(seeds);
  return good ? 0 : 1;
}
