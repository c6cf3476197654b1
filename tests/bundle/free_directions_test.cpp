// Free directions and redundancy, against the rank of a dense Jacobian of the format's own formula.
#include "bundle/fit/free_directions.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include <Eigen/SVD>

#include <slom/io/bal.hpp>

#include "bundle/bundle_command.hpp"

namespace slom::app::bundle {
namespace {

using testing::RawScene;

/// Returns unknowns - rank of the Jacobian by central differences, with columns scaled to length 1; -1 if the singular
/// values have no gap.
int nullityOf(RawScene scene) {
  std::vector<double*> unknowns;
  for (auto& camera : scene.cameras) {
    for (double& x : camera) unknowns.push_back(&x);
  }
  for (auto& point : scene.points) {
    for (double& x : point) unknowns.push_back(&x);
  }
  const auto n = Eigen::Index(unknowns.size()), rows = 2 * Eigen::Index(scene.observations.size());
  const auto images = [&] {
    Eigen::VectorXd all(rows);
    Eigen::Index i = 0;
    for (const auto& o : scene.observations) {
      const auto pixel =
          testing::pixelOf(scene.cameras[std::size_t(o.camera)], scene.points[std::size_t(o.point)]);
      all[i++] = pixel[0];
      all[i++] = pixel[1];
    }
    return all;
  };
  Eigen::MatrixXd J(rows, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    double& x = *unknowns[std::size_t(k)];
    const double old = x, h = 1e-6 * std::max(1.0, std::abs(old));
    x = old + h;
    const Eigen::VectorXd after = images();
    x = old - h;
    J.col(k) = (after - images()) / (2 * h);
    x = old;
    J.col(k).normalize();
  }
  const Eigen::VectorXd s = J.bdcSvd().singularValues();
  const auto rank = (s.array() > 1e-8 * s[0]).count();
  const bool has_gap = s[rank - 1] > 1e-6 * s[0];
  return has_gap ? int(n - rank) : -1;
}

/// Returns one to three parts that share nothing. Some cameras have 1 to 6 points, others see most. Some points are
/// seen by one camera only, and one observation is given twice.
RawScene randomScene(std::uint64_t seed, double sigma) {
  std::mt19937_64 random(seed);
  const auto below = [&](int n) { return int(random() % std::uint64_t(n)); };
  RawScene all;
  for (int parts = 1 + below(3); parts > 0; --parts) {
    const RawScene part = testing::simulated(2 + below(3), 6 + below(6), sigma, random());
    std::vector<int> most(part.cameras.size(), int(part.points.size()));
    for (int& number : most) number = below(3) == 0 ? 1 + below(6) : number;
    most[0] = int(part.points.size());  // sees all, so that the part is one
    const int cameras = int(all.cameras.size()), points = int(all.points.size());
    for (auto o : part.observations) {
      if (most[std::size_t(o.camera)]-- <= 0) continue;
      o.camera += cameras;
      o.point += points;
      all.observations.push_back(o);
    }
    all.cameras.insert(all.cameras.end(), part.cameras.begin(), part.cameras.end());
    all.points.insert(all.points.end(), part.points.begin(), part.points.end());
  }
  if (below(3) == 0) all.observations.push_back(all.observations.front());
  return all;
}

Scene parsed(const RawScene& scene) { return io::parseScene("scene.txt", testing::contentOf(scene)); }

TEST(BundleFreeDirections, AreThoseOfTheJacobian) {
  int compared = 0;
  std::set<int> different;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const RawScene scene = randomScene(seed, 0.3);
    const int expected = nullityOf(scene);
    if (expected < 0) continue;
    const FreeDirections free = countFreeDirections(parsed(scene), 1, true);
    EXPECT_EQ(free.count, expected) << "seed " << seed;
    EXPECT_TRUE(free.is_exact) << "seed " << seed;
    different.insert(expected);
    ++compared;
  }
  EXPECT_GT(compared, 12);
  EXPECT_GT(different.size(), 6u);
}

/// Cameras at one place see no depth. Each point is free along its ray, and so is the place of all cameras together;
/// there is no free scale.
TEST(BundleFreeDirections, OfCamerasThatTurnAtOnePlace) {
  RawScene scene = testing::simulated(3, 24, 0, 7);
  for (auto& camera : scene.cameras) {  // X + t with t = R c for one c: here R = 1 but for a turn about z
    camera = {0, 0, 0.2 + camera[1], 0, 0, -6, camera[6], camera[7], camera[8]};
  }
  scene.observations.clear();
  for (int p = 0; p < 24; ++p) {
    for (int c = 0; c < 3; ++c) {
      const auto pixel = testing::pixelOf(scene.cameras[std::size_t(c)], scene.points[std::size_t(p)]);
      scene.observations.push_back({c, p, pixel[0], pixel[1]});
    }
  }
  const FreeDirections free = countFreeDirections(parsed(scene), 1, true);
  const int expected = nullityOf(scene);
  ASSERT_GT(expected, 24);
  EXPECT_EQ(free.count, expected);
  EXPECT_TRUE(free.is_exact);
}

TEST(BundleFreeDirections, WhatIsNotCountedIsALowerLimit) {
  const RawScene scene = testing::simulated(70, 12, 0.3, 3);  // too many cameras to be diagnosed in a hurry
  const FreeDirections quick = countFreeDirections(parsed(scene), 1, false);
  EXPECT_FALSE(quick.is_exact);
  EXPECT_EQ(quick.count, 7);
  const FreeDirections all = countFreeDirections(parsed(scene), 1, true);
  EXPECT_TRUE(all.is_exact);
  EXPECT_EQ(all.count, 7);
}

/// The command reports the count at the fitted values. The redundancy is the number of observed coordinates minus the
/// rank.
TEST(BundleFreeDirections, OfTheCommand) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const RawScene scene = randomScene(seed, 0);
    const int expected = nullityOf(scene);
    if (expected < 0) continue;
    const testing::Json json = testing::fitted(scene).json;
    const int unknowns = int(9 * scene.cameras.size() + 3 * scene.points.size());
    EXPECT_EQ(json["free_directions"], expected) << "seed " << seed;
    EXPECT_EQ(json["free_directions_are_all"], true);
    EXPECT_EQ(json["redundancy"], int(2 * scene.observations.size()) - unknowns + expected);
    EXPECT_GE(json["redundancy"], 0);
  }
}

TEST(BundleFreeDirections, WhatIsFreeIsSaid) {
  RawScene two = testing::simulated(3, 20, 0, 1);
  const RawScene other = testing::simulated(3, 20, 0, 2);
  for (auto o : other.observations) {
    if (o.camera == 2 && o.point >= 3) continue;
    two.observations.push_back({o.camera + 3, o.point + 20, o.u, o.v});
  }
  two.cameras.insert(two.cameras.end(), other.cameras.begin(), other.cameras.end());
  two.points.insert(two.points.end(), other.points.begin(), other.points.end());
  const testing::TemporaryFolder folder;
  const auto result = testing::command.runIn(folder, testing::contentOf(two), {"--json", "DIR/result.json"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const std::vector<std::string> warnings = {
      "the scene has 2 parts that share no point, with the cameras 0, 3: their relative place, rotation and "
      "scale are unknown, so 7 more directions are free; add observations of common points, or fit each part "
      "alone",
      "1 camera (number 5) sees fewer than 5 points, too few for the 9 unknowns of a camera: only damping "
      "holds the rest, up to 3 free directions; add observations, or remove it"};
  EXPECT_NE(result.output.find(
                "  gauge: 14 directions are free (place, rotation and scale of each of 2 parts), held only "
                "by damping\n  warning: " +
                warnings[0] + "\n  warning: " + warnings[1] + "\n"),
            std::string::npos)
      << result.output;
  const auto json = testing::Json::parse(slom::testing::readFile(folder / "result.json"));
  EXPECT_EQ(json["warnings"], testing::Json(warnings));
  EXPECT_EQ(json["free_directions"], 14 + 3);
}

}  // namespace
}  // namespace slom::app::bundle
