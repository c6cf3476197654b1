#include "fit/run.hpp"

#include <limits>

namespace slom::bench {

double Run::secondsUntil(double best, double tolerance) const {
  for (const TracePoint& point : trace) {
    if (point.rss <= best * (1 + tolerance)) return point.seconds;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace slom::bench
