// The command fits problems of traced measurements, whose functions and types only the program that saved them has.
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <slom/archive.hpp>
#include <slom/measurements/range.hpp>
#include <slom/tape.hpp>

#include "support/command_on_file.hpp"

namespace slom::testing {
namespace {

using Point = mtk::vect<2>;

/// A station with an unknown offset of its readings.
template <class S>
struct Station {
  mtk::vect<2, S> pos;
  S offset{};
};

TEST(ReplayTraced, FitsAsTheProgramThatSavedIt) {
  Estimator est;
  const auto offset_range = [](const auto& station, const auto& point) {
    return (point - station.pos).norm() + station.offset;
  };
  const auto station = est.insertRV(Station<double>{Point(0.5, 0.2), 0.1}, "station");
  const auto tower = est.insertRV(Point(60, 80), "tower");
  est.prior(tower, Point(60, 80), 0.1);
  for (int i = 0; i < 8; ++i) {
    const Point p(50 * std::cos(i), 40 * std::sin(i));
    const auto id = est.insertRV(p, false, "p" + std::to_string(i));
    est.insertMeasurement(traced(offset_range), station, id, measured(p.norm() + 0.3 + 0.01 * (i % 3)),
                          StandardDeviation(0.01), named("offset range"));
    est.insertMeasurement(Range(), id, tower, measured((*tower - p).norm() + 0.02 * (i % 2)),
                          StandardDeviation(0.02));
  }
  Archive archive;
  archive.measurement<Range, VarID<Point>, VarID<Point>, Measured<double>>();
  archive.measurement<Prior, VarID<Point>, Measured<Point>>();
  std::ostringstream text;
  archive.save(est, text);
  const Summary summary = est.optimize();
  ASSERT_TRUE(summary.converged) << summary;

  const CommandOnFile command{"replay", "problem.slom", {}};
  const TemporaryFolder folder;
  const CommandResult result =
      command.runIn(folder, text.str(), {"--json", "DIR/result.json", "--output", "DIR/fitted.slom"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::string report = summary.report();
  EXPECT_NE(result.output.find(report.substr(report.find("  measurement"))), std::string::npos)
      << result.output;
  const auto json = nlohmann::json::parse(readFile(folder / "result.json"));
  EXPECT_NEAR(json["final_rss"].get<double>() / summary.final_rss, 1, 1e-9);
  ASSERT_EQ(json["parameters"].size(), summary.parameters.size());
  for (std::size_t i = 0; i < summary.parameters.size(); ++i)
    EXPECT_EQ(json["parameters"][i]["name"], summary.parameters[i].name);

  std::istringstream fitted(readFile(folder / "fitted.slom"));
  const StoredProblem problem = archive.load(fitted);
  EXPECT_NEAR(problem.estimator.getRSS() / summary.final_rss, 1, 1e-9);
  EXPECT_LT((*problem.variable<Point>("tower") - *tower).norm(), 1e-9);
  EXPECT_NEAR(static_cast<const double*>(problem.variable("station").current())[2], station->offset, 1e-9);
}

}  // namespace
}  // namespace slom::testing
