#include "slom/plot.hpp"

#include <algorithm>
#include <cstdio>
#include <map>

#include "analyze/chart.hpp"
#include "base/index.hpp"
#include "base/words.hpp"
#include "slom/analyze/chi_square.hpp"
#include "slom/analyze/outliers.hpp"

namespace slom {

namespace {

constexpr double kWidth = 760, kLeft = 84, kRight = 20, kNormal95 = 1.959963984540054;
constexpr int kCurvePoints = 240;
constexpr std::size_t kMostPoints = 20'000;  // of a panel; browsers are slow with more

void require(bool holds, const std::string& id, const std::string& what) {
  if (!holds) throw Error(id, what, "plot");
}

void requireData(const std::vector<double>& x, const std::vector<double>& y,
                 const std::vector<double>& sigma) {
  require(!x.empty() && x.size() == y.size(), "slom.bad-plot",
          "plot got " + counted(static_cast<int>(x.size()), "value") + " of x and " +
              std::to_string(y.size()) + " of y; pass one y for each x");
  require(sigma.size() <= 1 || sigma.size() == y.size(), "slom.bad-plot",
          "plot got " + counted(static_cast<int>(sigma.size()), "standard deviation") + " for " +
              counted(static_cast<int>(y.size()), "value") + "; pass one for each, one for all, or none");
  for (std::size_t i = 0; i < x.size(); ++i) {
    require(std::isfinite(x[i]) && std::isfinite(y[i]), "slom.bad-plot",
            "point " + std::to_string(i) + " of the plot is (" + number(x[i], 6) + ", " + number(y[i], 6) +
                "); pass finite numbers");
  }
  for (const double s : sigma) {
    require(std::isfinite(s) && s > 0, "slom.bad-plot",
            "a standard deviation of the plot is " + number(s, 6) + "; pass positive, finite numbers");
  }
}

/// A curve at many x.
struct Curve {
  std::vector<double> x, y, low, high;
};

Curve sampled(const std::function<CurvePoint(double)>& curve, const ChartRange& range) {
  Curve result;
  for (int k = 0; k <= kCurvePoints; ++k) {
    const double x = range.low + (range.high - range.low) * k / kCurvePoints;
    const CurvePoint point = curve(x);
    if (!std::isfinite(point.y) || !std::isfinite(point.standard_deviation)) continue;
    result.x.push_back(x);
    result.y.push_back(point.y);
    result.low.push_back(point.y - kNormal95 * point.standard_deviation);
    result.high.push_back(point.y + kNormal95 * point.standard_deviation);
  }
  return result;
}

/// The measurements of a group: residuals in standard deviations, by number of insertion.
struct Panel {
  std::string name;
  std::vector<double> number, residual;
  std::vector<std::string> measurement;
};

/// Returns the factor of standard deviations; 1 if it is unknown.
double factorOrOne(const Estimator& est) {
  try {
    const double factor = detail::sigmaFactor(est);
    return factor > 0 ? factor : 1;
  } catch (const Error&) {
    return 1;
  }
}

std::vector<Panel> panelsOf(const Estimator& est) {
  std::map<int, Panel> panels;  // by group
  const Eigen::VectorXd all = est.residuals() / factorOrOne(est);
  Eigen::Index row = 0;
  for (const auto& pool : est.table().pools()) {
    Panel& panel = panels[pool->group()];
    panel.name = pool->name();
    for (int i = 0; i < pool->size(); ++i) {
      for (int k = 0; k < pool->rows(i); ++k) {
        panel.number.push_back(static_cast<double>(pool->serial(i)));
        panel.residual.push_back(all[row++]);
        panel.measurement.push_back(pool->measurementName(i));
      }
    }
  }
  std::vector<Panel> result;
  for (auto& [group, panel] : panels) {
    if (!panel.number.empty()) result.push_back(std::move(panel));
  }
  return result;
}

/// Returns the names of suspects; none if the fit has no covariances.
std::vector<std::string> suspectsOf(const Estimator& est) {
  std::vector<std::string> names;
  try {
    for (const MeasurementCheck& check : outliers(est).ranking()) {
      if (check.is_suspect) names.push_back(check.measurement);
    }
  } catch (const Error&) {  // without covariances, the size of residuals cannot be judged
  }
  return names;
}

std::string panelText(const Panel& panel, const std::vector<std::string>& suspects, double top,
                      double height) {
  std::vector<double> shown = panel.residual;
  shown.insert(shown.end(), {-3, 3});
  const auto [first, last] = std::ranges::minmax(panel.number);
  Chart chart(
      {kLeft, top, kWidth - kLeft - kRight, height, {first - 1, last + 1}, ChartRange::of(shown), true});
  chart.title(panel.name);
  chart.axes("number of the measurement", "residual / standard deviation");
  chart.level(0, false);
  for (const double limit : {-kNormal95, kNormal95}) chart.level(limit, true);
  const std::size_t step = 1 + panel.number.size() / kMostPoints;
  std::string labelled;
  for (std::size_t i = 0; i < panel.number.size(); ++i) {
    const bool is_suspect = std::ranges::find(suspects, panel.measurement[i]) != suspects.end();
    if ((!is_suspect && i % step != 0) || !std::isfinite(panel.residual[i])) continue;
    chart.point(panel.number[i], panel.residual[i], panel.measurement[i] + ": " + number(panel.residual[i]),
                is_suspect);
    if (is_suspect && labelled != panel.measurement[i])
      chart.label(panel.number[i], panel.residual[i], panel.measurement[i]);
    labelled = is_suspect ? panel.measurement[i] : labelled;
  }
  return chart.svg();
}

}  // namespace

double detail::sigmaFactor(const Estimator& est) {
  return est.sigma() == Sigma::estimated ? std::sqrt(outliers(est, {.worst = 0}).variance_factor) : 1;
}

Plot detail::plotData(const std::vector<double>& x, const std::vector<double>& y,
                      const std::vector<double>& sigma, const std::function<CurvePoint(double)>& curve,
                      const PlotText& text) {
  requireData(x, y, sigma);
  const auto sigmaOf = [&](std::size_t i) {
    return sigma.empty() ? 0 : sigma.size() == 1 ? sigma[0] : sigma[i];
  };
  const ChartRange across = ChartRange::of(x);
  const Curve line = sampled(curve, across);
  std::vector<double> heights, residuals, residual_heights{0};
  for (std::size_t i = 0; i < x.size(); ++i) {
    heights.insert(heights.end(), {y[i] - sigmaOf(i), y[i] + sigmaOf(i)});
    residuals.push_back(y[i] - curve(x[i]).y);
    residual_heights.insert(residual_heights.end(), {residuals[i] - sigmaOf(i), residuals[i] + sigmaOf(i)});
  }
  heights.insert(heights.end(), line.y.begin(), line.y.end());
  const double width = kWidth - kLeft - kRight;
  Chart upper({kLeft, 36, width, 320, across, ChartRange::of(heights)});
  Chart lower({kLeft, 376, width, 130, across, ChartRange::of(residual_heights)});
  if (!text.title.empty()) upper.title(text.title);
  upper.axes(text.x, text.y, false);
  upper.band(line.x, line.low, line.high);
  upper.line(line.x, line.y);
  lower.axes(text.x, "residual");
  lower.level(0, false);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (sigmaOf(i) > 0) upper.bar(x[i], y[i], sigmaOf(i));
    if (sigmaOf(i) > 0) lower.bar(x[i], residuals[i], sigmaOf(i));
    upper.point(x[i], y[i]);
    lower.point(x[i], residuals[i]);
  }
  return {svgFile(kWidth, 556, upper.svg() + lower.svg())};
}

Plot plotResiduals(const Estimator& est) {
  const std::vector<Panel> panels = panelsOf(est);
  require(!panels.empty(), "slom.no-measurements",
          "plotResiduals got an estimator without measurements; insert some first");
  const std::vector<std::string> suspects = suspectsOf(est);
  const double height = 190, each = height + 86;
  std::string all;
  for (std::size_t p = 0; p < panels.size(); ++p)
    all += panelText(panels[p], suspects, 36 + each * static_cast<double>(p), height);
  return {svgFile(kWidth, each * static_cast<double>(panels.size()) + 10, all)};
}

void Plot::save(const std::string& file) const {
  const std::string unfinished = file + ".unfinished";
  std::FILE* const out = std::fopen(unfinished.c_str(), "wb");
  bool is_written = out != nullptr && std::fwrite(svg.data(), 1, svg.size(), out) == svg.size();
  is_written = out != nullptr && std::fclose(out) == 0 && is_written;
  is_written = is_written && std::rename(unfinished.c_str(), file.c_str()) == 0;
  if (!is_written && out != nullptr) std::remove(unfinished.c_str());
  require(is_written, "slom.cannot-write",
          "the plot could not be written to " + file + "; check that its folder exists and is writable");
}

}  // namespace slom
