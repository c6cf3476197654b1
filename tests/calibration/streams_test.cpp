// Cameras and an IMU in motion, on simulated recordings: estimates are unbiased, and their standard deviations honest.
//
// SLOM_STREAM_RIGS=100 takes that many rigs instead of 12.
#include <cstdlib>

#include <gtest/gtest.h>

#include <mtk/testing/random.hpp>

#include "calibration/errors_of_axes.hpp"
#include "calibration/simulated_streams.hpp"
#include "slom/analyze/chi_square.hpp"
#include "support/fresh_seed.hpp"

namespace slom::calibration {
namespace {

using testing::Calibrated;
using testing::quickStream;
using testing::streamOf;

/// Squares of errors, each divided by its variance.
struct Squares {
  double translation = 0, rotation = 0, offset = 0, gravity = 0;
  Eigen::Matrix<double, 7, 1> sum = Eigen::Matrix<double, 7, 1>::Zero();  ///< of the errors themselves

  void add(const Calibrated& rig, const StreamResult& result) {
    const ImuStreamResult& imu = result.imus.front();
    const SE3& truth = rig.options.cam0_to_imu;
    const vec3 turn = SO3::log(truth.orient.inverse() * imu.left2imu.orient);
    Eigen::Matrix<double, 7, 1> z;
    z << (imu.left2imu.pos - truth.pos).cwiseQuotient(imu.translation_std),
        turn.cwiseQuotient(imu.rotation_std),
        (imu.time_offset - rig.options.time_offset) / imu.time_offset_std;
    sum += z;
    translation += z.head<3>().squaredNorm();
    rotation += z.segment<3>(3).squaredNorm();
    offset += z[6] * z[6];
    const double angle =
        std::acos(std::min(1., result.gravity.normalized().dot(rig.simulated.gravity.normalized())));
    gravity += std::pow(angle / result.gravity_direction_std, 2);
  }
};

/// Expects the sum of `count` squares within what chi-square leaves in all but one of 10^5 tests.
void expectChiSquare(double squares, double count, const std::string& what) {
  constexpr double rare = 1e-5;
  EXPECT_GT(squares, chiSquareCritical(1 - rare, count)) << what << ": " << count << " squares";
  EXPECT_LT(squares, chiSquareCritical(rare, count)) << what << ": " << count << " squares";
}

int rigs() {
  const char* const given = std::getenv("SLOM_STREAM_RIGS");
  return given ? std::atoi(given) : 12;
}

TEST(Streams, ErrorsAreThoseThatAreStated) {
  const unsigned seed = slom::testing::freshSeed();
  Squares squares;
  for (int rig = 0; rig < rigs(); ++rig) {
    SCOPED_TRACE("rig " + std::to_string(rig));
    const Calibrated calibrated(quickStream(seed + std::uint64_t(rig)));
    const StreamResult result = calibrated.with({calibrated.stream()});
    ASSERT_TRUE(result.success()) << result.message << result.undetermined;
    squares.add(calibrated, result);
  }
  const double n = rigs();
  std::printf(
      "mean squares of %g rigs: translation %.2f, rotation %.2f, offset %.2f, gravity %.2f of 3, 3, 1, 1 to 2\n",
      n, squares.translation / n, squares.rotation / n, squares.offset / n, squares.gravity / n);
  expectChiSquare(squares.translation, 3 * n, "translation");
  expectChiSquare(squares.rotation, 3 * n, "rotation");
  expectChiSquare(squares.offset, n, "time offset");
  // gravity_direction_std covers the less certain of two directions: the squares have a mean of 1 to 2.
  EXPECT_GT(squares.gravity, chiSquareCritical(1 - 1e-5, n));
  EXPECT_LT(squares.gravity, chiSquareCritical(1e-5, 2 * n));
  for (int i = 0; i < 7; ++i)
    EXPECT_LT(std::abs(squares.sum[i]), 4.5 * std::sqrt(n)) << "component " << i << " is biased";
}

/// Without given noise, it is found to some percent, and errors are as large as stated, too.
TEST(Streams, NoiseIsFoundIfItIsNotGiven) {
  const Calibrated rig(quickStream(slom::testing::freshSeed(), 12), 2);
  ImuStream imu = rig.stream();
  imu.noise.reset();
  const StreamResult result = rig.with({imu});
  ASSERT_TRUE(result.success());
  EXPECT_FALSE(result.imus[0].noise_is_given);
  // Over 30 recordings, the estimates spread by 0.093 and 0.077 around 0.98 and 0.97. Beyond 4.5 times that: once in 10^5.
  EXPECT_NEAR(result.imus[0].noise.gyro / rig.options.noise.gyro, 1, 0.42);
  EXPECT_NEAR(result.imus[0].noise.force / rig.options.noise.force, 1, 0.38);
  EXPECT_NEAR(result.sigma_px / rig.options.sigma_px, 1, 0.25);
}

TEST(Streams, OffsetsAreFollowed) {
  app::StereoImuStreamOptions options = quickStream(7);
  options.seconds = 12;
  for (const double offset : {-2., -0.02, -0.005, 0.005, 0.02, 2., 1e9, -1.5e9}) {
    options.time_offset = offset;
    const Calibrated rig(options);
    const StreamResult result = rig.with({rig.stream()});
    ASSERT_TRUE(result.success()) << offset;
    EXPECT_NEAR(result.imus[0].time_offset, offset, 1e-4) << result.imus[0].time_offset_std;
    EXPECT_LT(result.imus[0].time_offset_std, 5e-5) << offset;
  }
}

/// The search begins near the given offset; one that is wrong by more than a few images finds nothing.
TEST(Streams, TheSearchCanBeginNearAnOffset) {
  const Calibrated rig(quickStream(8));
  StreamSettings settings;
  settings.time_offset = 0.1;
  EXPECT_NEAR(rig.with({rig.stream()}, settings).imus[0].time_offset, rig.options.time_offset, 1e-4);
}

TEST(Streams, TwoHalvesAgree) {
  app::StereoImuStreamOptions options = quickStream(9, 14);
  const Calibrated rig(options);
  ImuStream first = rig.stream(), second = rig.stream();
  first.samples.erase(first.samples.begin() + std::ptrdiff_t(first.samples.size() / 2), first.samples.end());
  second.samples.erase(second.samples.begin(),
                       second.samples.begin() + std::ptrdiff_t(second.samples.size() / 2));
  const StreamResult a = rig.with({first}), b = rig.with({second});
  ASSERT_TRUE(a.success() && b.success());
  const ImuStreamResult &x = a.imus[0], &y = b.imus[0];
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(std::abs(x.left2imu.pos[i] - y.left2imu.pos[i]),
              5 * std::hypot(x.translation_std[i], y.translation_std[i]));
  }
  EXPECT_LT(SO3::log(x.left2imu.orient.inverse() * y.left2imu.orient).norm(),
            5 * std::hypot(x.rotation_std.norm(), y.rotation_std.norm()));
  EXPECT_LT(std::abs(x.time_offset - y.time_offset), 5 * std::hypot(x.time_offset_std, y.time_offset_std));
}

TEST(Streams, SeveralImusAreFittedTogether) {
  app::StereoImuStreamOptions options = quickStream(10);
  const Calibrated rig(options, 2);
  options.cam0_to_imu = SE3(SO3::exp(vec3(-1., 0.4, 0.2)), vec3(-0.1, 0.03, 0.02));
  options.time_offset = -0.3;
  options.imu_rate = 125;
  ImuStream other = streamOf(app::simulateStereoImuStream(options), "imu1");  // on the same path
  other.noise = options.noise;
  const StreamResult both = rig.with({rig.stream(), other});
  ASSERT_TRUE(both.success());
  ASSERT_EQ(both.imus.size(), 2u);
  EXPECT_EQ(both.imus[1].name, "imu1");
  const auto expectNear = [](const ImuStreamResult& imu, const app::StereoImuStreamOptions& truth) {
    EXPECT_LT((imu.left2imu.pos - truth.cam0_to_imu.pos).norm(), 4 * imu.translation_std.norm()) << imu.name;
    EXPECT_LT(SO3::log(imu.left2imu.orient.inverse() * truth.cam0_to_imu.orient).norm(),
              4 * imu.rotation_std.norm())
        << imu.name;
    EXPECT_LT(imu.translation_std.norm(), 2e-3) << imu.name;
    EXPECT_NEAR(imu.time_offset, truth.time_offset, 5 * imu.time_offset_std) << imu.name;
  };
  expectNear(both.imus[0], rig.options);
  expectNear(both.imus[1], options);
  // A second IMU adds to what is known of the first by way of the poses.
  const vec3 alone = rig.with({rig.stream()}).imus[0].rotation_std;
  EXPECT_LE(both.imus[0].rotation_std.norm(), 1.01 * alone.norm());
}

/// Errors of the axes are found within their standard deviations, and pose and clock stay right.
TEST(Streams, ErrorsOfAxesAreFound) {
  const unsigned seed = slom::testing::freshSeed();
  mtk::testing::Random random(seed);
  app::StereoImuStreamOptions options = quickStream(seed, 20);
  options.noise.gyro = 1e-4;
  const Calibrated rig(options, 2);
  ImuModel<> truth = testing::randomErrors(random);
  for (const ImuAxes axes : {ImuAxes::scale_misalignment, ImuAxes::scale_misalignment_size_effect}) {
    if (axes == ImuAxes::scale_misalignment_size_effect) {
      for (double& x : truth.force_places) x = random.uniform(-0.03, 0.03);
    }
    ImuStream imu = rig.stream();
    imu.samples = testing::withErrors(imu.samples, truth);
    StreamSettings settings;
    settings.axes = axes;
    const StreamResult result = rig.with({imu}, settings);
    ASSERT_TRUE(result.success()) << result.undetermined << result.message;
    const ImuStreamResult& one = result.imus[0];
    const std::vector<double> expected = testing::numbersOf(truth),
                              found = testing::numbersOf(one.axes.model);
    ASSERT_EQ(one.axes.std.size(), axes == ImuAxes::scale_misalignment ? 24u : 30u);
    double squares = 0;
    for (std::size_t i = 0; i < one.axes.std.size(); ++i) {
      const double z = (found[i] - expected[i]) / one.axes.std[i];
      squares += z * z / double(one.axes.std.size());
      EXPECT_LT(std::abs(z), 5.5) << i << ": " << found[i] << " instead of " << expected[i];
    }
    EXPECT_LT(squares, 4);
    for (std::size_t i = 0; i < 15; ++i) EXPECT_LT(one.axes.std[i], 0.01) << i;
    EXPECT_NEAR(one.time_offset, options.time_offset, 6 * one.time_offset_std);
    for (int i = 0; i < 3; ++i)
      EXPECT_LT(std::abs(one.left2imu.pos[i] - options.cam0_to_imu.pos[i]), 6 * one.translation_std[i]) << i;
  }
}

/// A gap, or readings at the sensor's limit, are noted, and the result stays right.
TEST(Streams, GapsAreNoted) {
  const Calibrated rig(quickStream(11, 12));
  ImuStream imu = rig.stream();
  std::erase_if(imu.samples, [](const ImuSample& s) { return s.time > 5 && s.time < 6; });
  const StreamResult result = rig.with({imu});
  ASSERT_TRUE(result.success());
  ASSERT_EQ(result.notes.size(), 1u);
  EXPECT_EQ(
      result.notes[0],
      "imu0: readings are missing once, for up to 1 s, 5.000 s after the first reading; pairs of images around "
      "the gap are not used.");
  EXPECT_NEAR(result.imus[0].time_offset, rig.options.time_offset, 5 * result.imus[0].time_offset_std);
  EXPECT_LT((result.imus[0].left2imu.pos - rig.options.cam0_to_imu.pos).norm(),
            5 * result.imus[0].translation_std.norm());
  EXPECT_LT(result.imus[0].translation_std.norm(), 2e-3);
}

TEST(Streams, SaturatedAxesAreNoted) {
  const Calibrated rig(quickStream(12));
  ImuStream imu = rig.stream();
  std::size_t count = 0;
  for (ImuSample& sample : imu.samples) {
    if (std::abs(sample.gyro[1]) > 0.6) sample.gyro[1] = std::copysign(0.6, sample.gyro[1]), ++count;
  }
  ASSERT_GT(count, 10u);
  const StreamResult result = rig.with({imu});
  ASSERT_FALSE(result.notes.empty());
  EXPECT_TRUE(result.notes[0].ends_with(
      " readings of the gyroscope's y axis in imu0 stay at its largest magnitude, as if the sensor were saturated: use a "
      "larger range, or move less quickly."))
      << result.notes[0];
}

}  // namespace
}  // namespace slom::calibration
