// A plain program for a pose graph reaches the published chi-square of g2o files. Their information matrices are in the
// frame of the measurement.
#include <fstream>
#include <map>
#include <sstream>

#include "measurements/kind.hpp"
#include "support/paths.hpp"

namespace slom::testing {
namespace {

/// The upper triangle row by row.
template <int N>
Eigen::Matrix<double, N, N> readInformation(std::istream& is) {
  Eigen::Matrix<double, N, N> information;
  for (int i = 0; i < N; ++i) {
    for (int j = i; j < N; ++j) {
      is >> information(i, j);
      information(j, i) = information(i, j);
    }
  }
  return information;
}
SE2 readPlanePose(std::istream& is) {
  double x = 0, y = 0, angle = 0;
  is >> x >> y >> angle;
  return {SO2(angle), Vec2(x, y)};
}
SE3 readSpacePose(std::istream& is) {
  double x = 0, y = 0, z = 0, qx = 0, qy = 0, qz = 0, qw = 1;
  is >> x >> y >> z >> qx >> qy >> qz >> qw;
  return {SO3(qw, qx, qy, qz), Vec3(x, y, z)};
}

/// Fits the file with the first pose fixed. Starts from its vertices; without vertices, from the edges between i and i
/// + 1.
template <class Pose>
double fittedRss(const std::filesystem::path& path, const std::string& vertex, const std::string& edge,
                 Pose (*read)(std::istream&)) {
  Estimator est;
  std::map<int, VarID<Pose>> poses;
  const auto insert = [&](int id, const Pose& pose) {
    if (!poses.contains(id)) poses[id] = est.insertRV(pose, !poses.empty());
  };
  const auto forEachLine = [&](const auto& f) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
      std::istringstream is(line);
      std::string tag;
      int i = 0, j = 0;
      is >> tag >> i;
      if (tag == edge) is >> j;
      f(is, tag, i, j);
    }
  };
  forEachLine([&](std::istream& is, const std::string& tag, int i, int) {
    if (tag == vertex) insert(i, read(is));
  });
  if (poses.empty()) {
    insert(0, Pose());
    forEachLine([&](std::istream& is, const std::string& tag, int i, int j) {
      if (tag == edge && j == i + 1) insert(j, *poses.at(i) * read(is));
    });
  }
  forEachLine([&](std::istream& is, const std::string& tag, int i, int j) {
    if (tag != edge) return;
    const Pose z = read(is);
    est.insertMeasurement(RelativePose(), poses.at(i), poses.at(j), measured(z),
                          InvCovariance(readInformation<Pose::DOF>(is)));
  });
  const Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged) << summary;
  return summary.final_rss;
}

/// As docs/manifolds.md writes it out.
TEST(PoseGraph, TheErrorWrittenOutIsRelativePose) {
  using Pose = SE3;
  Random random(7);
  Estimator est;
  const auto a = est.insertRV(random.pose<Pose>(), false), b = est.insertRV(random.pose<Pose>());
  const Pose z = mtk::moved(a->inverse() * *b, random.vector<mtk::tangent_t<Pose>>(0.3));
  Eigen::Matrix<double, 6, 6> L =
      Eigen::Matrix<double, 6, 6>::Random() + 3 * Eigen::Matrix<double, 6, 6>::Identity();
  const Eigen::Matrix<double, 6, 6> information = L * L.transpose();
  const auto kind = est.insertMeasurement(RelativePose(), a, b, measured(z), InvCovariance(information));
  const double rss = est.getRSS(kind);
  EXPECT_GT(rss, 0.1);
  est.removeMeasurement(kind);
  const auto error = [](const auto& a, const auto& b, const auto& z) {
    return z.inverse() * (a.inverse() * b);
  };
  est.insertMeasurement(error, a, b, z, slom::measured(Pose()), slom::InvCovariance(information));
  EXPECT_NEAR(est.getRSS(), rss, 1e-12 * rss);
}

TEST(PoseGraph, TheObviousProgramFitsManhattan) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("posegraph/manhattan.g2o");
  const double rss =
      fittedRss<SE2>(sharedDataPath("posegraph/manhattan.g2o"), "VERTEX_SE2", "EDGE_SE2", readPlanePose);
  EXPECT_NEAR(rss, 3549.036796, 1e-5);  // as the command, g2o and Ceres
}
TEST(PoseGraph, TheObviousProgramFitsAParkingGarage) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("posegraph/parking-garage.g2o");
  const double rss = fittedRss<SE3>(sharedDataPath("posegraph/parking-garage.g2o"), "VERTEX_SE3:QUAT",
                                    "EDGE_SE3:QUAT", readSpacePose);
  EXPECT_NEAR(rss, 1.26838440, 1e-7);
}

}  // namespace
}  // namespace slom::testing
