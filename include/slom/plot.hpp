/// Pictures of fits as SVG: data with the fitted curve, and residuals.
///
///     const auto decay = [](const auto& a, const auto& rate, double t) { return a * exp(-rate * t); };
///     ...                                                               // insert, measure, optimize
///     slom::plot(est, t, y, 0.02, decay, a, rate).save("decay.svg");    // decay(a, rate, t[i]) fits y[i]
///     slom::plotResiduals(est).save("residuals.svg");                   // of any fit
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "slom/estimator.hpp"

namespace slom {

/// A picture.
struct Plot {
  std::string svg;  ///< text of the SVG file; browsers show it, Markdown and HTML include it

  /// Writes the file. Throws [slom.cannot-write].
  void save(const std::string& file) const;
};

/// Title and axis labels of a plot of data.
struct PlotText {
  std::string title = "", x = "x", y = "y";
};

/// A point of a curve with its standard deviation from the fit.
struct CurvePoint {
  double y = 0, standard_deviation = 0;
};

namespace detail {
/// Returns the factor of the stated standard deviations: 1, or with Sigma::estimated the factor that the residuals
/// show.
double sigmaFactor(const Estimator& est);
/// Draws data and curve. `sigma` has one number for each y, or one for all. If `sigma` is empty, there are no bars, and
/// the residuals are in units of y.
Plot plotData(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& sigma,
              const std::function<CurvePoint(double)>& curve, const PlotText& text);
}  // namespace detail

/// Draws data y at x with their standard deviations, the curve f(variables, x) with its 95 % band at each x, and below
/// the residuals y - f. `sigma` has one number for each y, or one for all, or none. With Sigma::estimated, the bars are
/// scaled as the residuals show. f takes the values, as measurement functions get them, and a double, and returns a
/// number. Its derivatives are found as for measurements, by differences for a function of doubles. Throws
/// [slom.bad-plot] for vectors of other lengths and for data that are not finite, and as covariance does.
template <class F, class... T>
Plot plot(const Estimator& est, const std::vector<double>& x, const std::vector<double>& y,
          const std::vector<double>& sigma, const F& f, const VarID<T>&... ids) {
  return plot(est, PlotText{}, x, y, sigma, f, ids...);
}
template <class F, class... T>
Plot plot(const Estimator& est, const PlotText& text, const std::vector<double>& x,
          const std::vector<double>& y, const std::vector<double>& sigma, const F& f,
          const VarID<T>&... ids) {
  const Eigen::MatrixXd C = est.jointCovariance(ids...);
  const auto point = [&](double at) {
    const auto of_values = [&](const auto&... values) -> decltype(f(values..., at)) {
      return f(values..., at);
    };
    const auto curve = [&] {
      if constexpr (detail::is_numeric<F>) {
        return detail::NumericFunction<decltype(of_values), decltype(f.how)>{of_values, f.how};
      } else {
        return of_values;
      }
    }();
    const auto value = est.propagate(curve, C, ids...);
    return CurvePoint{value.value, std::sqrt(value.covariance(0, 0))};
  };
  std::vector<double> bars = sigma;
  const double factor = detail::sigmaFactor(est);
  for (double& bar : bars) bar *= factor;
  return detail::plotData(x, y, bars, point, text);
}
/// Draws data that have one common standard deviation, with or without a text.
template <class F, class... T>
Plot plot(const Estimator& est, const PlotText& text, const std::vector<double>& x,
          const std::vector<double>& y, double sigma, const F& f, const VarID<T>&... ids) {
  return plot(est, text, x, y, std::vector<double>{sigma}, f, ids...);
}
template <class F, class... T>
Plot plot(const Estimator& est, const std::vector<double>& x, const std::vector<double>& y, double sigma,
          const F& f, const VarID<T>&... ids) {
  return plot(est, PlotText{}, x, y, std::vector<double>{sigma}, f, ids...);
}

/// Draws the residuals of all measurements in units of their standard deviations. Each label or type has a panel, in
/// the order of insertion, with the band that contains 95 % of good residuals. Suspects of slom::outliers are
/// marked by name. Without covariances, as with a free gauge, no suspects are marked.
Plot plotResiduals(const Estimator& est);

}  // namespace slom
