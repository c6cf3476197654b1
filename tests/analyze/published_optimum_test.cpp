// The optimum that the authors of the paper published for their monocular calibration: chi-square 4035.559724,
// f = 1872.60353 (../shared/data/mono, not part of the project).
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

#include "support/paths.hpp"

namespace {

typedef mtk::vect<2> vec2;
typedef mtk::vect<3> vec3;
typedef mtk::trafo<mtk::SO3<>> SE3;

struct QuotientCamera : mtk::vect<4> {
  static constexpr std::array<std::string_view, 4> component_names{"f", "cx", "cy", "k"};
};

/// u = f s x + cx with s = 1 / (1 + k r^2).
vec2 predictionError(const QuotientCamera& cam, const SE3& cam2world, const vec3& world, const vec2& pixel) {
  const vec3 p = cam2world.inverse() * world;
  const vec2 xy = p.head<2>() / p[2];
  return cam[0] / (1 + cam[3] * xy.squaredNorm()) * xy + cam.segment<2>(1) - pixel;
}

/// A line of a CSV file with its commas made blanks.
std::istringstream blankSeparated(std::string line) {
  std::replace(line.begin(), line.end(), ',', ' ');
  return std::istringstream(line);
}

TEST(PublishedOptimum, OfTheMonocularCalibrationIsReached) {
  const std::string folder = SLOM_SHARED_DATA_DIR "/mono/";
  std::ifstream guess(folder + "initial_guess.csv"), corners(folder + "corners.csv");
  if (!guess || !corners) GTEST_SKIP() << "needs " << folder;

  for (const bool dense : {false, true}) {
    guess.clear(), guess.seekg(0), corners.clear(), corners.seekg(0);
    slom::Estimator est;
    if (dense) est.changeSolver(std::make_unique<slom::DenseQR>());
    slom::VarID<QuotientCamera> cam;
    std::vector<slom::VarID<SE3>> cam2world;
    std::string line, name;
    std::getline(guess, line);
    while (std::getline(guess, line)) {
      auto in = blankSeparated(line);
      in >> name;
      if (name == "intrinsic") {
        QuotientCamera start;
        in >> start;
        cam = est.insertRV(start, "cam");
      } else {
        Eigen::Matrix3d R;
        vec3 t;
        for (int i = 0; i < 9; ++i) in >> R(i / 3, i % 3);
        in >> t;
        cam2world.push_back(est.insertRV(SE3(mtk::SO3<>(R), t), name));
      }
    }
    std::getline(corners, line);
    while (std::getline(corners, line)) {
      std::size_t image, corner;
      vec3 world;
      vec2 pixel;
      blankSeparated(line) >> image >> corner >> world >> pixel;
      est.insertMeasurement(predictionError, cam, cam2world.at(image - 1), world, pixel,
                            slom::StandardDeviation(0.25));
    }
    slom::Options options;
    options.deviation_tolerance = 1e-3;  // what was published has no more digits
    const slom::Summary summary = est.optimize(options);
    EXPECT_TRUE(summary.converged);
    EXPECT_EQ(summary.measurements, 3326);
    EXPECT_EQ(summary.unknowns, 112);
    EXPECT_NEAR(summary.final_rss, 4035.559724, 1e-6);
    EXPECT_NEAR((*cam)[0], 1872.60353, 1e-5);
    EXPECT_LT(summary.iterations, 12);
  }
}

}  // namespace
