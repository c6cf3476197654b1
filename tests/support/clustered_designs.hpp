/// Simulated regressions with errors shared within groups of equal or unequal sizes, for the coverage of clustered
/// intervals. A test and bench_coverage use them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <slom/analyze/clustered.hpp>
#include <slom/slom.hpp>

namespace slom::testing::clusters {

/// Sizes of the groups: 10 each; 400 for the first and 3 for the others; 2 + exp(2 + 1.2 n), n normal, drawn anew each
/// time.
enum class Sizes { equal, one_large, lognormal };

struct Design {
  int ways = 1;  ///< 2: each measurement is in a row, of these sizes, and in a random one of as many columns
  Sizes sizes = Sizes::equal;
  int groups = 10;
  bool is_ordered = false;  ///< clustered as if successive rows were alike, which they are not
};

inline std::vector<int> drawSizes(const Design& design, std::mt19937_64& random) {
  const bool is_equal = design.sizes == Sizes::equal;
  std::vector<int> sizes(static_cast<std::size_t>(design.groups), is_equal ? 10 : 3);
  if (design.sizes == Sizes::one_large) sizes[0] = 400;
  std::normal_distribution<> normal;
  if (design.sizes == Sizes::lognormal) {
    for (int& size : sizes) size = 2 + static_cast<int>(std::exp(2 + 1.2 * normal(random)));
  }
  return sizes;
}

/// 1, the slope over x, and the slope over z, which two-way designs have.
inline Eigen::VectorXd truthOf(const Design& design) {
  Eigen::VectorXd truth(design.ways + 1);
  truth[0] = 1;
  truth[1] = 2;
  if (design.ways == 2) truth[2] = -1;
  return truth;
}

/// Inserts 1 + 2 x - z with three errors: 0.2 shared by a row, 0.2 shared by a column, and 0.1, the stated one. x is
/// uniform within 1 around 0.3 times the number of the row, z likewise for the column. Returns the values, which start
/// at 0.
inline VarID<Eigen::VectorXd> simulate(Estimator& est, const Design& design, std::mt19937_64& random) {
  std::normal_distribution<> normal;
  std::uniform_real_distribution<> around(-1, 1);
  const auto p = est.insertRV(Eigen::VectorXd(Eigen::VectorXd::Zero(design.ways + 1)), "p");
  std::vector<double> of_columns(static_cast<std::size_t>(design.groups));
  for (double& shared : of_columns) shared = 0.2 * normal(random);
  const std::vector<int> sizes = drawSizes(design, random);
  for (int row = 0; row < design.groups; ++row) {
    const double of_row = 0.2 * normal(random);
    for (int i = 0; i < sizes[static_cast<std::size_t>(row)]; ++i) {
      const double x = around(random) + 0.3 * row, error = of_row + 0.1 * normal(random);
      if (design.ways == 1) {
        est.insertMeasurement([](const auto& v, double at, double y) { return v[0] + v[1] * at - y; }, p, x,
                              1 + 2 * x + error, StandardDeviation(0.1), group("row", row));
        continue;
      }
      const int column = std::uniform_int_distribution<>(0, design.groups - 1)(random);
      const double z = around(random) + 0.3 * column;
      est.insertMeasurement([](const auto& v, double at, double also_at,
                               double y) { return v[0] + v[1] * at + v[2] * also_at - y; },
                            p, x, z, 1 + 2 * x - z + error + of_columns[static_cast<std::size_t>(column)],
                            StandardDeviation(0.1), group("row", row), group("column", column));
    }
  }
  return p;
}

/// How often 95 % intervals hold.
struct Tally {
  int runs = 0;
  int named =
      0;  ///< runs in which a note says that there are few groups, or that single ones carry some values
  int unnamed = 0;                        ///< the others
  std::vector<int> holds, holds_unnamed;  ///< by component
  std::vector<double> squared_errors, variances;

  void add(const Design& design, const Clustered& clustered, const VarID<Eigen::VectorXd>& p) {
    const Eigen::VectorXd error = *p - truthOf(design), half = clustered.interval(p, 0.95),
                          deviation = clustered.standardDeviation(p);
    const auto size = static_cast<std::size_t>(error.size());
    for (auto* counts : {&holds, &holds_unnamed}) counts->resize(size);
    for (auto* sums : {&squared_errors, &variances}) sums->resize(size);
    bool is_named = false;
    for (const std::string& note : clustered.notes(p)) {
      is_named = is_named || note.find("one group (in brackets) determines most of a value") == 0 ||
                 (note.find("there are only") == 0 && note.find(" in order") == std::string::npos);
    }
    ++runs;
    ++(is_named ? named : unnamed);
    for (std::size_t i = 0; i < size; ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      const int does_hold = std::abs(error[at]) <= half[at] ? 1 : 0;
      holds[i] += does_hold;
      if (!is_named) holds_unnamed[i] += does_hold;
      squared_errors[i] += error[at] * error[at];
      variances[i] += deviation[at] * deviation[at];
    }
  }

  /// Returns the component whose intervals hold least often.
  std::size_t worst() const {
    return static_cast<std::size_t>(std::min_element(holds.begin(), holds.end()) - holds.begin());
  }
  /// Returns the root mean square of the printed standard deviations over that of the errors.
  double printedOverTrue(std::size_t component) const {
    return std::sqrt(variances[component] / squared_errors[component]);
  }
};

/// The options of the clustered covariance of a design.
inline ClusterOptions optionsOf(const Design& design, ClusterCorrection correction) {
  ClusterOptions options;
  options.by = design.ways == 1 ? std::vector<ClusterBy>{"row"} : std::vector<ClusterBy>{"row", "column"};
  options.correction = correction;
  options.ordered = design.is_ordered;
  return options;
}

}  // namespace slom::testing::clusters
