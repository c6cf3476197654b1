// Streams with a few wrong readings: these are found, named and left out, and the rest gives what it gave before. Seeds
// vary.
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calibration/simulated_streams.hpp"
#include "calibration/streams/spikes.hpp"

namespace slom::calibration {
namespace {

using testing::Calibrated;
using testing::quickStream;

/// A way to spoil readings from one on.
struct Spoiled {
  std::string what;
  std::function<void(std::vector<ImuSample>&, std::size_t from)> by;
  bool is_single;  ///< readings that jump, not a stretch
};

std::vector<Spoiled> ways() {
  const auto set = [](std::size_t count, auto value) {
    return [=](std::vector<ImuSample>& samples, std::size_t from) {
      const ImuSample first = samples[from];
      for (std::size_t i = from; i < from + count; ++i) value(samples[i], first);
    };
  };
  return {
      {"force", set(1, [](ImuSample& s, const ImuSample&) { s.force[0] += 30; }), true},
      {"small force", set(1, [](ImuSample& s, const ImuSample&) { s.force[2] -= 3; }), true},
      {"rate", set(1, [](ImuSample& s, const ImuSample&) { s.gyro[1] += 5; }), true},
      {"two readings", set(2, [](ImuSample& s, const ImuSample&) { s.force[2] -= 40, s.gyro[0] += 1; }),
       true},
      {"zeros", set(10, [](ImuSample& s, const ImuSample&) { s.force = s.gyro = vec3(0., 0., 0.); }), false},
      {"hung",
       set(50, [](ImuSample& s, const ImuSample& first) { s.force = first.force, s.gyro = first.gyro; }),
       false},
  };
}

/// Expects the values of `clean`, within a part of their standard deviations.
void expectSame(const ImuStreamResult& found, const ImuStreamResult& clean, const std::string& what) {
  const double few = 1.5;  // standard deviations, for the readings that are missing
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(std::abs(found.left2imu.pos[i] - clean.left2imu.pos[i]), few * clean.translation_std[i])
        << what;
    const vec3 turn = SO3::log(clean.left2imu.orient.inverse() * found.left2imu.orient);
    EXPECT_LT(std::abs(turn[i]), few * clean.rotation_std[i]) << what;
  }
  EXPECT_LT(std::abs(found.time_offset - clean.time_offset), few * clean.time_offset_std) << what;
}

TEST(GrossReadings, AreNamedAndLeftOut) {
  const auto seed = unsigned(::testing::UnitTest::GetInstance()->random_seed()) + 1;
  std::mt19937 random(seed);
  const Calibrated recording(quickStream(seed, 10));
  const ImuStream good = recording.stream();
  const StreamResult clean = recording.with({good});
  ASSERT_TRUE(clean.success()) << seed;
  for (const Spoiled& one : ways()) {
    const std::string what = one.what + ", seed " + std::to_string(seed);
    ImuStream spoiled = good;
    const std::size_t from =
        std::uniform_int_distribution<std::size_t>(300, good.samples.size() - 300)(random);
    one.by(spoiled.samples, from);
    const StreamResult result = recording.with({spoiled});
    ASSERT_TRUE(result.success()) << what << ": " << result.message << result.undetermined;
    expectSame(result.imus[0], clean.imus[0], what);
    const ImuStreamResult& imu = result.imus[0];
    ASSERT_FALSE(result.notes.empty()) << what;
    if (one.is_single) {
      ASSERT_FALSE(imu.spikes.empty()) << what;
      for (const ImuSpike& spike : imu.spikes) {
        EXPECT_GE(spike.sample, from) << what;
        EXPECT_LE(spike.sample, from + 1) << what;
      }
      EXPECT_TRUE(imu.gross.empty()) << what;
      EXPECT_NE(result.notes[0].find("off the readings around, as no motion does: "), std::string::npos)
          << what << ": " << result.notes[0];
    } else {
      ASSERT_FALSE(imu.gross.empty()) << what;
      // If a fault begins at the end of an interval between images, only the next interval contradicts them.
      EXPECT_LT(imu.gross.front().from, good.samples[from].time + 1 / recording.options.camera_rate) << what;
      EXPECT_GT(imu.gross.back().to, good.samples[from].time) << what;
    }
  }
}

/// Sensors that hang for seconds, also on one axis, while a bias jumps besides.
TEST(GrossReadings, HangingSensorsAreNamed) {
  const auto seed = unsigned(::testing::UnitTest::GetInstance()->random_seed()) + 1;
  const Calibrated recording(quickStream(seed, 12));
  const ImuStream good = recording.stream();
  const std::size_t from = 700, to = 1100;
  const auto hung = [&](bool is_one_axis, double jump) {
    ImuStream imu = good;
    for (std::size_t i = from; i < to; ++i) {
      imu.samples[i].gyro[0] = good.samples[from].gyro[0];
      if (!is_one_axis)
        imu.samples[i].gyro = good.samples[from].gyro, imu.samples[i].force = good.samples[from].force;
    }
    for (std::size_t i = 1700; i < imu.samples.size(); ++i) imu.samples[i].force[1] += jump;
    return imu;
  };
  for (const auto& [is_one_axis, jump] : {std::pair(true, 0.), {false, 0.}, {false, 1.}}) {
    const std::string what = fmt::format("seed {}, one axis: {}, jump {}", seed, is_one_axis, jump);
    const StreamResult result = recording.with({hung(is_one_axis, jump)});
    ASSERT_TRUE(result.success()) << what << ": " << result.message << result.undetermined;
    const ImuStreamResult& imu = result.imus[0];
    ASSERT_FALSE(imu.gross.empty()) << what;
    EXPECT_NEAR(imu.gross[0].from, good.samples[from].time, 0.011) << what;
    EXPECT_NEAR(imu.gross[0].to, good.samples[to].time, 0.011) << what;
    EXPECT_TRUE(imu.spikes.empty()) << what;
    EXPECT_NE(result.notes[0].find("readings stay exactly the same from "), std::string::npos)
        << result.notes[0];
    EXPECT_EQ(imu.jumps.size(), jump > 0 ? 1u : 0u) << what;
    for (int i = 0; i < 3; ++i)
      EXPECT_LT(std::abs(imu.left2imu.pos[i] - recording.options.cam0_to_imu.pos[i]),
                5 * std::max(imu.translation_std[i], imu.translation_clustered[i]))
          << what;
  }
}

TEST(GrossReadings, AreLeftOutBeforeSplinesToo) {
  const auto seed = unsigned(::testing::UnitTest::GetInstance()->random_seed()) + 1;
  const Calibrated recording(quickStream(seed, 6));
  StreamSettings splines;
  splines.path = StreamPath::splines;
  const StreamResult clean = recording.with({recording.stream()}, splines);
  ImuStream spoiled = recording.stream();
  spoiled.samples[400].force[0] += 30;
  std::size_t from = 700;  // at rest, readings of 0 are no fault
  while (spoiled.samples[from].gyro.norm() < 0.6) ++from;
  for (std::size_t i = from; i < from + 10; ++i) spoiled.samples[i].gyro = vec3(0., 0., 0.);
  const StreamResult result = recording.with({spoiled}, splines);
  ASSERT_TRUE(result.success()) << seed << result.message << result.undetermined;
  expectSame(result.imus[0], clean.imus[0], "seed " + std::to_string(seed));
  ASSERT_FALSE(result.imus[0].spikes.empty()) << seed;
  EXPECT_EQ(result.imus[0].spikes.front().sample, 400u);
  EXPECT_FALSE(result.imus[0].gross.empty());
}

TEST(GrossReadings, RobustNoneKeepsThem) {
  Calibrated recording(quickStream(1));
  recording.settings.robust = Robust::none;
  ImuStream spoiled = recording.stream();
  spoiled.samples[500].force[0] += 1;
  const StreamResult result = recording.with({spoiled});
  EXPECT_TRUE(result.imus[0].spikes.empty());
  EXPECT_TRUE(result.imus[0].gross.empty());
}

TEST(GrossReadings, MoreThanAHundredthAreKeptAndCounted) {
  const auto seed = unsigned(::testing::UnitTest::GetInstance()->random_seed()) + 1;
  std::mt19937 random(seed);
  const Calibrated recording(quickStream(seed, 6));
  ImuStream spoiled = recording.stream();
  const std::size_t count = spoiled.samples.size() / 40;
  for (std::size_t k = 0; k < count; ++k)
    spoiled.samples[40 * k + std::uniform_int_distribution<std::size_t>(0, 20)(random)].force[1] += 30;
  const StreamResult result = recording.with({spoiled});
  ASSERT_FALSE(result.notes.empty()) << seed;
  EXPECT_NE(result.notes[0].find(fmt::format("{} of {} readings jump", count, spoiled.samples.size())),
            std::string::npos)
      << seed << ": " << result.notes[0];
  EXPECT_TRUE(result.imus[0].spikes.empty()) << seed;
}

void expectNoSpikes(const ImuStream& imu, const std::string& what) {
  const Spikes found = spikesOf(imu);
  EXPECT_TRUE(found.all.empty()) << what;
  EXPECT_EQ(found.kept, 0u) << what;
}

/// Sensors that rest, move or are knocked, with fine and with coarse resolution.
TEST(GrossReadings, AreNotFoundInGoodStreams) {
  const auto seed = unsigned(::testing::UnitTest::GetInstance()->random_seed()) + 1;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (const double step : {0., 0.01, 0.1}) {
    for (const double moving : {0., 1.}) {
      ImuStream imu;
      for (int i = 0; i < 4000; ++i) {
        const double t = i / 200.;
        const double knock =
            i >= 2000 && i < 2040 ? moving * 5 * std::exp(-(i - 2000) / 10.) * normal(random) : 0;
        const auto read = [&](double value, double noise) {
          value += noise * normal(random) + knock;
          return step > 0 ? step * std::round(value / step) : value;
        };
        imu.samples.push_back(
            {t,
             vec3(read(moving * std::sin(12 * t), 0.003), read(moving * std::cos(5 * t), 0.003),
                  read(moving * (t > 10 ? 1 : 0), 0.003)),
             vec3(read(3 * moving * std::sin(30 * t), 0.03), read(0, 0.03), read(9.8, 0.03))});
      }
      expectNoSpikes(imu, fmt::format("{} {} {}", seed, step, moving));
      imu.samples.erase(imu.samples.begin() + 1000, imu.samples.begin() + 1217);
      expectNoSpikes(imu, fmt::format("{}, with a gap", seed));
    }
  }
}

}  // namespace
}  // namespace slom::calibration
