/// Pictures of fits, as SVG: data with the fitted curve, and residuals.
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
  std::string svg;  ///< the file's text; browsers show it, and Markdown and HTML include it

  /// Writes it. Throws [slom.cannot-write] where that fails.
  void save(const std::string& file) const;
};

/// What is written at a plot of data.
struct PlotText {
  std::string title = "", x = "x", y = "y";
};

/// A point of a curve, with the standard deviation that the fit leaves it.
struct CurvePoint {
  double y = 0, standard_deviation = 0;
};

namespace detail {
/// What stated standard deviations are multiplied by: 1, or with Sigma::estimated what the residuals show.
double sigmaFactor(const Estimator& est);
/// `sigma`: one for each y, or one for all; none: no bars, and residuals in units of y.
Plot plotData(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& sigma,
              const std::function<CurvePoint(double)>& curve, const PlotText& text);
}  // namespace detail

/// Data y at x with their standard deviations, the curve f(variables, x) with the band that holds it with 95 % at each x, and below the
/// residuals y - f. `sigma` has one number for each y, or one for all, or none; with Sigma::estimated the bars are as
/// the residuals show. f returns a number for values as measurement functions get them and
/// a double; its derivatives are found as those of measurements are, by differences for a function of doubles. Throws [slom.bad-plot] for other numbers of them and for data that are not finite, and what covariance throws.
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
/// The same with one standard deviation for all data, and without a text.
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

/// The residuals of all measurements in units of their standard deviations: a panel for each label or type, in the order of insertion, with the
/// band that holds 95 % of good ones; suspects of Estimator::outliers() by name. Without covariances, as at a free gauge, no suspects are marked.
Plot plotResiduals(const Estimator& est);

}  // namespace slom
