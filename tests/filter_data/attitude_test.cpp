// The attitude filter on BROAD's trial 06, against VQF (Laidig and Seel 2023): its published code with its defaults, on the
// same file and samples, has total 1.16, heading 0.84, inclination 0.80 degrees without its heading offset.
#include <gtest/gtest.h>

#include <slom/filter.hpp>

#include "broad.hpp"

namespace slom::testing {

template <class S>
BroadScore scoreOf(const std::vector<BroadReading>& readings) {
  filter::AttitudeFilter<S> attitude;
  BroadScore score;
  const auto as = [](const mtk::vect<3>& v) { return mtk::vect<3, S>(S(v[0]), S(v[1]), S(v[2])); };
  for (const BroadReading& r : readings) {
    EXPECT_EQ(attitude.step(as(r.gyro), as(r.force), as(r.field), S(1 / 285.714)), FilterStatus::done)
        << r.time;
    const auto& R = attitude.orientation();
    if (r.is_moving && r.truth) score.add(*r.truth, mtk::SO3<>(R.w(), R.x(), R.y(), R.z()));
  }
  return score;
}

TEST(AttitudeData, ErrorsAreBelowThoseOfVqf) {
  SLOM_SKIP_WITHOUT_SHARED_DATA(kBroadFile);
  if (!io::has_bzip2) GTEST_SKIP() << "built without libbz2";
  const auto readings = readBroad(sharedDataPath(kBroadFile).string());
  const BroadScore score = scoreOf<double>(readings);
  EXPECT_EQ(score.size(), 34882u);
  const double offset = score.headingOffset();
  const OrientationErrors raw = score.rms(), e = score.rms(offset);
  std::printf(
      "heading offset %.2f; total %.3f, heading %.3f, inclination %.3f; with the offset total %.3f, heading %.3f\n",
      offset, e.total, e.heading, e.inclination, raw.total, raw.heading);
  EXPECT_LT(e.total, 1.16);
  EXPECT_LT(e.heading, 0.84);
  EXPECT_LT(e.inclination, 0.80);
  EXPECT_LT(std::abs(offset),
            4.5);  // magnetic north against the markers' frame, 4.2 degrees by the true orientations

  const OrientationErrors single = scoreOf<float>(readings).rms(offset);
  EXPECT_NEAR(single.total, e.total, 0.01);
}

TEST(AttitudeData, AMagnetTurnsTheHeadingLittle) {
  SLOM_SKIP_WITHOUT_SHARED_DATA(kBroadFile);
  if (!io::has_bzip2) GTEST_SKIP() << "built without libbz2";
  auto readings = readBroad(sharedDataPath(kBroadFile).string());
  for (BroadReading& r : readings) {
    if (r.time > 60 && r.time < 90) r.field += mtk::vect<3>(20, -20, 0);
  }
  const OrientationErrors e = scoreOf<double>(readings).rms();
  std::printf("with a magnet of 28 uT for 30 s: total %.2f, inclination %.2f\n", e.total, e.inclination);
  EXPECT_LT(e.total, 12);
  EXPECT_LT(e.inclination, 1.2);
}

}  // namespace slom::testing
