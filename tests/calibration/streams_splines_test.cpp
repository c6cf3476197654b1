// Cameras and an IMU in motion, fitted by splines, on simulated recordings.
//
// SLOM_SPLINE_RIGS=30 takes that many rigs instead of 3.
#include <cmath>
#include <cstdlib>
#include <functional>

#include <gtest/gtest.h>

#include "calibration/errors_of_axes.hpp"
#include "calibration/simulated_streams.hpp"
#include "slom/analyze/chi_square.hpp"
#include "slom/calibration/stream_agreement.hpp"
#include "support/fresh_seed.hpp"

namespace slom::calibration {
namespace {

using testing::Calibrated;
using testing::quickStream;
using testing::streamOf;

StreamSettings bySplines() {
  StreamSettings settings;
  settings.path = StreamPath::splines;
  return settings;
}

/// Returns the errors of an IMU, each divided by its stated standard deviation: translation, rotation, offset.
Eigen::Matrix<double, 7, 1> errorsOf(const ImuStreamResult& imu, const app::StereoImuStreamOptions& truth) {
  Eigen::Matrix<double, 7, 1> z;
  z << (imu.left2imu.pos - truth.cam0_to_imu.pos).cwiseQuotient(imu.translation_std),
      SO3::log(truth.cam0_to_imu.orient.inverse() * imu.left2imu.orient).cwiseQuotient(imu.rotation_std),
      (imu.time_offset - truth.time_offset) / imu.time_offset_std;
  return z;
}

/// Expects errors that one of 10^5 good fits exceeds.
void expectErrorsAsStated(const StreamResult& result, const app::StereoImuStreamOptions& truth) {
  ASSERT_TRUE(result.success()) << result.message << result.undetermined;
  const Eigen::Matrix<double, 7, 1> z = errorsOf(result.imus[0], truth);
  EXPECT_LT(z.squaredNorm(), chiSquareCritical(1e-5, 7)) << z.transpose();
}

TEST(StreamsBySplines, ErrorsAreThoseThatAreStated) {
  const unsigned seed = slom::testing::freshSeed();
  const char* const given = std::getenv("SLOM_SPLINE_RIGS");
  const int rigs = given ? std::atoi(given) : 3;
  Eigen::Matrix<double, 7, 1> squares = Eigen::Matrix<double, 7, 1>::Zero();
  for (int rig = 0; rig < rigs; ++rig) {
    SCOPED_TRACE("seed " + std::to_string(seed + unsigned(rig)));
    const Calibrated calibrated(quickStream(seed + std::uint64_t(rig)));
    const StreamResult result = calibrated.with({calibrated.stream()}, bySplines());
    ASSERT_TRUE(result.success()) << result.message << result.undetermined;
    EXPECT_EQ(result.path, StreamPath::splines);
    squares += errorsOf(result.imus[0], calibrated.options).cwiseAbs2();
  }
  std::printf("mean squares of %d rigs: translation %.2f %.2f %.2f, rotation %.2f %.2f %.2f, offset %.2f\n",
              rigs, squares[0] / rigs, squares[1] / rigs, squares[2] / rigs, squares[3] / rigs,
              squares[4] / rigs, squares[5] / rigs, squares[6] / rigs);
  EXPECT_LT(squares.sum(), chiSquareCritical(1e-5, 7 * rigs));
  EXPECT_GT(squares.sum(), chiSquareCritical(1 - 1e-5, 7 * rigs));
}

TEST(StreamsBySplines, AgreesWithPreintegration) {
  const Calibrated rig(quickStream(21), 2);
  const StreamResult integrated = rig.with({rig.stream()}), splines = rig.with({rig.stream()}, bySplines());
  ASSERT_TRUE(integrated.success() && splines.success());
  const StreamAgreement agreement = agreementOf(integrated, splines);
  ASSERT_EQ(agreement.imus.size(), 1u);
  EXPECT_EQ(agreement.contradiction, "");
  EXPECT_LT(agreement.largest, 3) << agreement.largest_name;
  EXPECT_LT(agreement.imus[0].translation.norm(), 2e-3);
  EXPECT_LT(std::abs(agreement.imus[0].time_offset), 1e-4);
  // Both see the same noise and say the same of it.
  const ImuStreamResult &a = integrated.imus[0], &b = splines.imus[0];
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(std::log(a.translation_std[i] / b.translation_std[i]), 0, 0.5);
  EXPECT_NEAR(b.gyro_ratio, 1, 0.15);
  EXPECT_NEAR(b.force_ratio, 1, 0.15);
}

TEST(StreamsBySplines, ADifferenceIsNamed) {
  const Calibrated rig(quickStream(22));
  const StreamResult first = rig.with({rig.stream()});
  StreamResult second = first;
  const ImuStreamResult& imu = first.imus[0];
  second.imus[0].left2imu.pos[1] += 5 * std::max(imu.translation_std[1], imu.translation_clustered[1]);
  const StreamAgreement agreement = agreementOf(first, second);
  EXPECT_EQ(agreement.largest_name, "imu0.translation.y");
  EXPECT_NEAR(agreement.largest, 5, 1e-9);
  EXPECT_EQ(
      agreement.contradiction,
      "The two fits differ in imu0.translation.y by 5 standard deviations. Usual causes: knots that are too far "
      "apart for the motion, vibration, or blurred images.");
  EXPECT_EQ(agreementOf(first, first).contradiction, "");
  EXPECT_EQ(agreementOf(first, first).largest, 0);
}

TEST(StreamsBySplines, NoiseIsFoundIfItIsNotGiven) {
  const Calibrated rig(quickStream(slom::testing::freshSeed(), 10), 2);
  ImuStream imu = rig.stream();
  imu.noise.reset();
  const StreamResult result = rig.with({imu}, bySplines());
  ASSERT_TRUE(result.success()) << result.message;
  EXPECT_NEAR(result.imus[0].noise.gyro / rig.options.noise.gyro, 1, 0.1);
  EXPECT_NEAR(result.imus[0].noise.force / rig.options.noise.force, 1, 0.1);
  EXPECT_NEAR(result.sigma_px / rig.options.sigma_px, 1, 0.25);
}

TEST(StreamsBySplines, OffsetsAreFollowed) {
  app::StereoImuStreamOptions options = quickStream(23);
  for (const double offset : {-2., 0.02, 1e9}) {
    options.time_offset = offset;
    const Calibrated rig(options);
    SCOPED_TRACE(offset);
    expectErrorsAsStated(rig.with({rig.stream()}, bySplines()), options);
  }
}

/// Where readings are missing, images have poses of their own; the rest is two splines.
TEST(StreamsBySplines, ReadingsMayBeMissing) {
  const Calibrated rig(quickStream(24, 10));
  ImuStream imu = rig.stream();
  std::erase_if(imu.samples, [](const ImuSample& s) { return s.time > 4 && s.time < 5.2; });
  const StreamResult result = rig.with({imu}, bySplines());
  expectErrorsAsStated(result, rig.options);
  ASSERT_EQ(result.notes.size(), 1u);
  EXPECT_EQ(result.notes[0].substr(0, 31), "imu0: readings are missing once");
}

/// A spline crosses a second without images by the readings, and three seconds not at all.
TEST(StreamsBySplines, ImagesMayBeMissing) {
  for (const double gap : {1., 3.}) {
    SCOPED_TRACE(gap);
    Calibrated rig(quickStream(25, 10));
    const std::int64_t first = *rig.data.cameras[0].views.front().time_ns;
    std::erase_if(rig.data.cameras[0].views, [&](const View& view) {
      const double time = double(*view.time_ns - first) * 1e-9;
      return time > 4 && time < 4 + gap;
    });
    rig.camera = calibrate(rig.data, rig.settings);
    expectErrorsAsStated(rig.with({rig.stream()}, bySplines()), rig.options);
  }
}

TEST(StreamsBySplines, SeveralImusAreFittedTogether) {
  app::StereoImuStreamOptions options = quickStream(26);
  const Calibrated rig(options);
  options.cam0_to_imu = SE3(SO3::exp(vec3(-1., 0.4, 0.2)), vec3(-0.1, 0.03, 0.02));
  options.time_offset = -0.3;
  options.imu_rate = 125;
  ImuStream other = streamOf(app::simulateStereoImuStream(options), "imu1");  // on the same path
  other.noise = options.noise;
  const StreamResult both = rig.with({rig.stream(), other}, bySplines());
  expectErrorsAsStated(both, rig.options);
  ASSERT_EQ(both.imus.size(), 2u);
  EXPECT_LT(errorsOf(both.imus[1], options).squaredNorm(), chiSquareCritical(1e-5, 7))
      << errorsOf(both.imus[1], options).transpose();
}

/// The means of the biases have standard deviations, by either way.
TEST(StreamsBySplines, ErrorsOfBiasesAreThoseThatAreStated) {
  const unsigned seed = slom::testing::freshSeed();
  const char* const given = std::getenv("SLOM_SPLINE_RIGS");
  const int rigs = given ? std::atoi(given) : 2;
  for (const StreamPath path : {StreamPath::preintegration, StreamPath::splines}) {
    StreamSettings settings;
    settings.path = path;
    double gyro = 0, force = 0;
    for (int rig = 0; rig < rigs; ++rig) {
      const Calibrated calibrated(quickStream(seed + std::uint64_t(rig), 12));
      const StreamResult result = calibrated.with({calibrated.stream()}, settings);
      ASSERT_TRUE(result.success()) << result.message << result.undetermined;
      const ImuStreamResult& imu = result.imus[0];
      const auto& truth = calibrated.simulated;
      gyro += (imu.gyro_bias - truth.gyro_bias).cwiseQuotient(imu.gyro_bias_std).squaredNorm();
      force += (imu.force_bias - truth.force_bias).cwiseQuotient(imu.force_bias_std).squaredNorm();
      for (int i = 0; i < 3; ++i) {
        EXPECT_GT(imu.gyro_bias_clustered[i], 0.1 * imu.gyro_bias_std[i]);
        EXPECT_GT(imu.force_bias_clustered[i], 0.1 * imu.force_bias_std[i]);
      }
    }
    std::printf("%s: mean squares of %d rigs: gyro bias %.2f, acc bias %.2f\n", toString(path), rigs,
                gyro / (3 * rigs), force / (3 * rigs));
    for (const double squares : {gyro, force}) {
      EXPECT_LT(squares, chiSquareCritical(1e-5, 3 * rigs)) << toString(path);
      EXPECT_GT(squares, chiSquareCritical(1 - 1e-5, 3 * rigs)) << toString(path);
    }
  }
}

/// Errors of the axes are found within their standard deviations, and pose and clock stay right.
TEST(StreamsBySplines, ErrorsOfAxesAreFound) {
  const unsigned seed = slom::testing::freshSeed();
  const char* const given = std::getenv("SLOM_SPLINE_RIGS");
  const unsigned rigs = given ? unsigned(std::atoi(given)) : 1;
  for (unsigned rig = 0; rig < rigs; ++rig) {
    SCOPED_TRACE("seed " + std::to_string(seed + rig));
    mtk::testing::Random random(seed + rig);
    app::StereoImuStreamOptions options = quickStream(seed + rig, 12);
    options.noise.gyro = 1e-4;
    const Calibrated calibrated(options, 2);
    ImuModel<> truth = testing::randomErrors(random);
    for (double& x : truth.force_places) x = random.uniform(-0.03, 0.03);
    ImuStream imu = calibrated.stream();
    imu.samples = testing::withErrors(imu.samples, truth);
    StreamSettings settings = bySplines();
    settings.axes = ImuAxes::scale_misalignment_size_effect;
    const StreamResult result = calibrated.with({imu}, settings);
    expectErrorsAsStated(result, options);
    const ImuStreamResult& one = result.imus[0];
    const std::vector<double> expected = testing::numbersOf(truth),
                              found = testing::numbersOf(one.axes.model);
    ASSERT_EQ(one.axes.std.size(), expected.size());
    ASSERT_EQ(one.axes.std_clustered.size(), expected.size());
    double squares = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const double z = (found[i] - expected[i]) / one.axes.std[i];
      squares += z * z;
      EXPECT_LT(std::abs(z), 5.5) << i << ": " << found[i] << " instead of " << expected[i];
      EXPECT_GT(one.axes.std_clustered[i], 0) << i;
    }
    std::printf("mean square of %zu errors of axes: %.2f\n", expected.size(),
                squares / double(expected.size()));
    EXPECT_LT(squares, chiSquareCritical(1e-5, double(expected.size())));
    if (rig > 0) continue;
    settings.path = StreamPath::preintegration;
    const StreamAgreement agreement = agreementOf(calibrated.with({imu}, settings), result);
    EXPECT_EQ(agreement.contradiction, "");
    EXPECT_LT(agreement.largest, 3) << agreement.largest_name;
    EXPECT_EQ(agreement.imus[0].axes.size(), expected.size());
  }
}

/// Without errors of the axes, the sensor is ideal within standard deviations; clocks and shutters may be free besides.
TEST(StreamsBySplines, ErrorsOfAxesAreFoundWithMovingCameras) {
  app::StereoImuStreamOptions options = quickStream(slom::testing::freshSeed(), 12);
  options.camera_phase = 0.02;
  options.line_delay = 3e-5;
  Settings camera;
  camera.sigma_px = options.sigma_px;
  camera.rolling_shutter = true;
  StreamSettings settings = bySplines();
  settings.camera_offsets = true;
  settings.axes = ImuAxes::scale_misalignment;
  const app::StereoImuStreamData simulated = app::simulateStereoImuStream(options);
  ImuStream imu = streamOf(simulated);
  imu.noise = options.noise;
  const StreamResult result =
      calibrateMovingCameras(testing::datasetOf(options, simulated, 2), camera, {imu}, settings).result;
  expectErrorsAsStated(result, options);
  const ImuAxesResult& axes = result.imus[0].axes;
  ASSERT_EQ(axes.std.size(), 24u);
  const std::vector<double> found = testing::numbersOf(axes.model);
  for (std::size_t i = 0; i < axes.std.size(); ++i) EXPECT_LT(std::abs(found[i]), 5.5 * axes.std[i]) << i;
}

TEST(StreamsBySplines, LensesMayBeHeld) {
  Calibrated rig(quickStream(27), 2);
  for (const CameraResult& camera : rig.camera.cameras) {
    for (const Parameter& p : camera.parameters)
      rig.settings.lens.push_back({camera.name, p.name, p.value, p.value});
  }
  rig.camera = calibrate(rig.data, rig.settings);
  const StreamResult result = rig.with({rig.stream()}, bySplines());
  ASSERT_TRUE(result.success()) << result.message << result.undetermined;
  EXPECT_EQ(agreementOf(rig.with({rig.stream()}), result).contradiction, "");
}

/// Expects a DataError with this text.
void expectRefused(const std::function<void()>& call, const std::string& text) {
  try {
    call();
    ADD_FAILURE() << "nothing was thrown instead of: " << text;
  } catch (const DataError& error) {
    EXPECT_STREQ(error.what(), text.c_str());
  }
}

TEST(StreamsBySplines, KnotsNeedASpacing) {
  const Calibrated rig(quickStream(28));
  StreamSettings settings = bySplines();
  const auto fit = [&] { rig.with({rig.stream()}, settings); };
  settings.knot_spacing = 0;
  expectRefused(fit, "[slom.calibration.bad-settings] StreamSettings::knot_spacing is 0; give 0.001 to 10 s");
  for (const double spacing : {-1., 11., std::nan("")}) {
    settings.knot_spacing = spacing;
    EXPECT_THROW(fit(), DataError) << spacing;
  }
}

TEST(StreamsBySplines, OtherImusAreNotCompared) {
  StreamResult one, other;
  one.imus.emplace_back().name = "imu0";
  other.imus.emplace_back().name = "imu1";
  expectRefused(
      [&] { agreementOf(one, other); },
      "[slom.calibration.bad-stream] the two results have other IMUs; compare fits of the same streams");
}

}  // namespace
}  // namespace slom::calibration
