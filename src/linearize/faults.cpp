// Errors for measurements whose residuals or derivatives are not finite, or too large.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/index.hpp"
#include "base/words.hpp"
#include "slom/linearize/linearize.hpp"

namespace slom {

void Linearizer::raiseOverflow(const Problem& problem) {
  MeasurementPool* worst_pool = nullptr;
  int worst = 0;
  double largest = -1;
  std::vector<double> r, J;
  for (const auto& pool : problem.pools()) {
    for (int i = 0; i < pool->size(); ++i) {
      r.resize(at(pool->rows(i)));
      J.resize(at(pool->rows(i)) * at(pool->columns(i)));
      problem.naming(*pool, [&] { pool->linearize(i, i + 1, r.data(), J.data()); });
      double size = 0;
      for (const double value : r) size = std::max(size, std::abs(value));
      for (const double value : J) size = std::max(size, std::abs(value));
      if (size > largest) {
        largest = size;
        worst_pool = pool.get();
        worst = i;
      }
    }
  }
  if (worst_pool == nullptr) throw Error("slom.overflow", "the RSS is too large for a number");
  const int rows = worst_pool->rows(worst);
  r.resize(at(rows));
  worst_pool->evaluate(worst, worst + 1, r.data());
  double residual = 0;
  for (int i = 0; i < rows; ++i) residual = std::max(residual, std::abs(r[at(i)]));
  throw Error("slom.overflow",
              "measurement " + worst_pool->measurementName(worst) + " has a residual of " +
                  number(residual, 6) + " standard deviations or a derivative of " + number(largest, 6) +
                  " at " + problem.valuesText(worst_pool->variables(worst), worst_pool->arity()) +
                  ", too large for sums of squares; check its data, its uncertainty and the start values",
              worst_pool->measurementName(worst));
}

void Linearizer::raiseNotFinite(const Problem& problem, int group, int measurement) {
  MeasurementPool& pool = *problem.pools()[at(group)];
  std::vector<double> r(at(pool.rows(measurement)));
  const bool residual_is_bad = pool.evaluate(measurement, measurement + 1, r.data()) >= 0;
  throw Error("slom.not-finite",
              std::string(residual_is_bad ? "the residual" : "a derivative") + " of measurement " +
                  pool.measurementName(measurement) + " is not finite at " +
                  problem.valuesText(pool.variables(measurement), pool.arity()) +
                  "; check its data, the function where it divides, takes roots or logarithms or "
                  "leaves an entry of its result unset, and the start values",
              pool.measurementName(measurement));
}

}  // namespace slom
