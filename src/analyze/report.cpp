#include "slom/analyze/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>

#include "base/classic_numbers.hpp"
#include "base/words.hpp"
#include "slom/analyze/profile.hpp"

namespace slom {

namespace {

template <class... Args>
std::string format(const char* pattern, Args... args) {
  const ClassicNumbers points;
  const int size = std::snprintf(nullptr, 0, pattern, args...);
  std::string text(static_cast<std::size_t>(std::max(size, 0)) + 1, '\0');
  std::snprintf(text.data(), text.size(), pattern, args...);
  text.pop_back();
  return text;
}

std::string groupTable(const Summary& summary) {
  std::size_t width = 11;
  for (const GroupSummary& group : summary.groups) width = std::max(width, group.name.size());
  const int w = static_cast<int>(width);
  std::string text = format("  %-*s %8s %10s %14s %14s  %s\n", w, "measurement", "count", "residuals",
                            "RSS before", "RSS after", "derivatives");
  for (const GroupSummary& g : summary.groups) {
    text += format("  %-*s %8d %10d %14.6g %14.6g  %s\n", w, g.name.c_str(), g.measurements, g.residuals,
                   g.initial_rss, g.final_rss, g.derivatives.c_str());
  }
  return text + format("  %-*s %8s %10d %14.6g %14.6g\n", w, "all", "", summary.measurements,
                       summary.initial_rss, summary.final_rss);
}

/// Returns a line for each loss of the group, or one line for all if there are many.
std::string lossLines(const GroupSummary& group) {
  constexpr std::size_t kMostLines = 4;
  std::vector<LossSummary> losses = group.losses;
  if (losses.size() > kMostLines) {
    LossSummary all{std::to_string(losses.size()) + " losses"};
    for (const LossSummary& one : losses) {
      all.measurements += one.measurements;
      all.down_weighted += one.down_weighted;
    }
    losses = {all};
  }
  std::string text;
  for (const LossSummary& one : losses) {
    text += format("  %s: %s on %d of %d measurements, %d down-weighted (weight < 1/2)\n", group.name.c_str(),
                   one.loss.c_str(), one.measurements, group.measurements, one.down_weighted);
  }
  return text;
}

std::string valueText(const ParameterSummary& parameter) {
  return !parameter.text.empty() || std::isnan(parameter.value) ? parameter.text
                                                                : format("%.8g", parameter.value);
}

std::string parameterRows(const Summary& summary) {
  std::size_t width = 9, value_width = 14;
  for (const ParameterSummary& parameter : summary.parameters) {
    width = std::max(width, parameter.name.size());
    value_width = std::max(value_width, valueText(parameter).size());
  }
  const int w = static_cast<int>(width), v = static_cast<int>(value_width);
  const bool is_clustered =
      std::any_of(summary.parameters.begin(), summary.parameters.end(),
                  [](const auto& parameter) { return !std::isnan(parameter.clustered); });
  std::string text = format("  %-*s %*s %20s%s\n", w, "parameter", v, "value", "standard deviation",
                            is_clustered ? format(" %12s %8s", "clustered", "dof").c_str() : "");
  for (const ParameterSummary& parameter : summary.parameters) {
    text += format("  %-*s %*s %20.3g", w, parameter.name.c_str(), v, valueText(parameter).c_str(),
                   parameter.standard_deviation);
    if (is_clustered) text += format(" %12.3g %8.3g", parameter.clustered, parameter.clustered_dof);
    text += "\n";
  }
  return text;
}

std::string parameterTable(const Summary& summary) {
  std::string text = parameterRows(summary);
  if (summary.has_rotations) {
    text +=
        "  note: rotations are rotation vectors [rad]; their standard deviations describe small turns about "
        "the axes of the rotated frame\n";
  }
  for (const std::string& note : summary.undetermined) text += "  note: " + note + "\n";
  for (const std::string& note : summary.clustered_notes) text += "  note: " + note + "\n";
  for (const CorrelationSummary& pair : summary.correlations) {
    text += format("  correlation of %s and %s: %.4f\n", pair.a.c_str(), pair.b.c_str(), pair.correlation);
  }
  if (summary.correlations_not_shown > 0)
    text +=
        "  " + counted(summary.correlations_not_shown, "further correlation") + " from 0.95 on, not shown\n";
  return text;
}

/// Returns the chi-squares of single groups.
std::string groupChiSquares(const Summary& summary) {
  std::string text;
  if (summary.groups.size() < 2 || summary.hasLosses()) return text;
  for (const GroupSummary& group : summary.groups) {
    if (group.redundancy > 0.5 && group.losses.empty()) {
      text += format("  %s: chi-square / dof = %.6g / %.4g = %.6g\n", group.name.c_str(), group.final_rss,
                     group.redundancy, group.final_rss / group.redundancy);
    }
  }
  return text;
}

/// Describes the standard deviations of measurements. If none was stated, 1 stands in, and the text says what the
/// residuals imply.
std::string sigmaWords(const Summary& summary) {
  const double factor = std::sqrt(summary.chi2PerDof());
  const bool states_none = summary.stated_noise == StatedNoise::none;
  if (summary.sigma_is_estimated)
    return format(states_none ? "standard deviations are estimated: %.4g for each residual"
                              : "standard deviations are estimated: those stated, times %.4g",
                  factor);
  if (states_none)
    return "no standard deviation was stated, 1 is assumed" +
           (summary.hasLosses() || !summary.converged
                ? std::string()
                : format("; the residuals show %.3g; setSigma(slom::Sigma::estimated) adopts this value",
                         factor));
  return summary.stated_noise == StatedNoise::some
             ? "standard deviations are taken as stated, and as 1 if none was stated"
             : "standard deviations are taken as stated";
}

std::string freeDirections(const Summary& summary) {
  return summary.free_directions == 0 ? "" : " + " + counted(summary.free_directions, "free direction");
}

}  // namespace

std::string Summary::report() const { return slom::report(*this); }

std::string report(const Summary& summary) {
  std::string text = (summary.converged ? "Converged: " : "NOT converged: ") + summary.message + "\n";
  text += format("  %d iterations of %s; %s\n", summary.iterations, summary.algorithm.c_str(),
                 summary.solver.c_str());
  text += format("  %d residuals - %d unknowns (%d variables)%s = redundancy %d\n", summary.measurements,
                 summary.unknowns, summary.variables, freeDirections(summary).c_str(), summary.redundancy);
  if (summary.stages > 0) text += format("  graduated non-convexity, stages begun: %d\n", summary.stages);
  text += groupTable(summary);
  for (const GroupSummary& group : summary.groups) text += lossLines(group);
  if (summary.redundancy > 0) {
    text += format("  %s / dof = %.6g; ", summary.hasLosses() ? "robust RSS" : "chi-square",
                   summary.chi2PerDof());
    text += sigmaWords(summary) + "\n";
  }
  text += groupChiSquares(summary);
  if (!summary.parameters.empty()) {
    text += parameterTable(summary);
  } else {
    for (const std::string& reason : summary.undetermined)
      text += "  no standard deviations: " + reason + "\n";
  }
  if (summary.parameters_not_shown > 0)
    text += "  " + counted(summary.parameters_not_shown, "parameter") + " not shown\n";
  if (summary.is_free_network)
    text += "  free network: of all values with this RSS, these are the nearest to the start values\n";
  for (const std::string& bound : summary.active_bounds)
    text += "  " + bound + "; standard deviations hold if it stays there\n";
  for (const std::string& warning : summary.warnings) text += "  warning: " + warning + "\n";
  return text;
}

std::ostream& operator<<(std::ostream& os, const Summary& summary) { return os << report(summary); }

std::ostream& operator<<(std::ostream& os, const ProfileInterval& interval) {
  return os << number(interval.value, 8) << " in [" << number(interval.lower, 8) << ", "
            << number(interval.upper, 8) << "]";
}

Observer progressTable(std::ostream& os) {
  return [&os](const IterationRecord& line) {
    if (line.iteration == 0) {
      os << format("%4s %16s %11s %10s %10s %10s  %s\n", "iter", "RSS", "decrease", "gradient", "step",
                   "damping", "algorithm");
      os << format("%4d %16.9g %11s %10.2e\n", 0, line.rss, "", line.gradient);
      return;
    }
    os << format("%4d %16.9g %11.2e %10.2e %10.2e %10.2e  %s", line.iteration, line.rss,
                 line.relative_decrease, line.gradient, line.step, line.damping, line.algorithm.c_str())
       << (line.trials > 1 ? format(", %d trials", line.trials) : "")
       << (line.graduation > 1 ? format(", mu = %.3g\n", line.graduation) : "\n");
  };
}

}  // namespace slom
