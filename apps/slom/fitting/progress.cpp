#include "fitting/progress.hpp"

#include <limits>

#include <fmt/format.h>

#include "text.hpp"

namespace slom::app {

std::string iterationHeader() {
  return "  iteration            RSS   rel. decrease   step/sigma   gradient   algorithm\n";
}

std::string iterationText(const IterationRecord& r) {
  if (r.iteration == 0) return fmt::format("  {:>9} {:>14.8g}\n", r.iteration, r.rss);
  return fmt::format("  {:>9} {:>14.8g} {:>15.2e} {:>12.1e} {:>10.1e}   {}\n", r.iteration, r.rss,
                     r.relative_decrease, r.step, r.gradient, r.algorithm);
}

namespace {

/// Returns ` + 7 free directions`.
std::string freeDirectionsText(const Outcome& o) {
  if (o.free_directions == 0 && o.has_all_free_directions) return "";
  return fmt::format(" + {}{}", o.has_all_free_directions ? "" : "at least ",
                     plural(std::size_t(o.free_directions), "free direction"));
}

}  // namespace

double Outcome::rssPerDof() const {
  return redundancy() > 0 ? rss / redundancy() : std::numeric_limits<double>::quiet_NaN();
}

Outcome outcomeOf(const RunReport& report) {
  const Summary& s = report.summary;
  return {s.converged,
          s.iterations,
          toString(s.stop_reason),
          s.message,
          s.measurements,
          s.unknowns,
          s.final_rss,
          s.hasLosses(),
          report.free_directions,
          report.has_all_free_directions};
}

std::string outcomeText(const Outcome& o) {
  std::string text =
      fmt::format("\n{} after {}: {}\n  {} measurements - {} unknowns{} = redundancy {}{}\n",
                  o.converged ? "Converged" : "NOT CONVERGED", plural(std::size_t(o.iterations), "iteration"),
                  o.stop_reason, o.measurements, o.unknowns, freeDirectionsText(o),
                  o.has_all_free_directions ? "" : "at least ", o.redundancy());
  const char* const kind = o.is_robust ? "robust RSS" : "RSS";
  text += fmt::format("  {} {:.6g}", kind, o.rss);
  if (o.redundancy() > 0) {
    text += fmt::format(", {}/dof {}{:.4g}", o.is_robust ? kind : "chi2",
                        o.has_all_free_directions ? "" : "at most ", o.rssPerDof());
  }
  text += '\n';
  if (!o.converged) text += fmt::format("  {}\n", o.message);
  return text;
}

}  // namespace slom::app
