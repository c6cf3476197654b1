// Handles to measurements know whether these are still there.
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

namespace {

TEST(MeasID, IsValidUntilItsMeasurementIsRemoved) {
  auto est = std::make_unique<slom::Estimator>();
  const auto x = est->insertRV(1.0, "x");
  const auto insert = [&] { return est->insertMeasurement([](const auto& v) { return v; }, x); };
  decltype(insert()) none;
  EXPECT_FALSE(none.isValid());
  const auto first = insert(), second = insert(), third = insert();
  EXPECT_TRUE(first.isValid() && second.isValid() && third.isValid());
  est->removeMeasurement(second);
  EXPECT_FALSE(second.isValid());
  EXPECT_TRUE(first.isValid() && third.isValid());
  const auto fourth = insert();  // takes the place of the second one
  EXPECT_TRUE(fourth.isValid());
  EXPECT_FALSE(second.isValid());
  EXPECT_FALSE(second == fourth);
  slom::Estimator moved = std::move(*est);
  EXPECT_TRUE(first.isValid());
  est.reset();
  EXPECT_TRUE(first.isValid());
  moved = slom::Estimator();
  EXPECT_FALSE(first.isValid()) << "its estimator is gone";
  EXPECT_TRUE(x.isValid()) << "a variable's last value can still be read";
}

TEST(MeasID, OfAListIsValidLikeOthers) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0, "x");
  const auto id =
      est.insertMeasurement([](std::span<const slom::VariableView> v) { return v[0].as<double>(); }, {x});
  EXPECT_TRUE(id.isValid());
  est.removeMeasurement(id);
  EXPECT_FALSE(id.isValid());
}

}  // namespace
