/// Relative precision of corners: noise that grows with speed, slant or distance, and losses that reduce the weight of
/// distant corners.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom::calibration {

struct Dataset;
struct Result;

/// Quantity with which the standard deviation of a view's corners grows.
enum class SigmaBy {
  constant,  ///< all views have the same noise
  speed,     ///< motion of the corners between successive image numbers [px], from neighbouring views: blur
  slant,     ///< angle between the line of sight and the normal of the board [rad]
  distance,  ///< distance of the centre of the corners from the camera [m]
};
/// Returns text such as `speed`.
const char* toString(SigmaBy by);

/// The noise of one camera's corners. If the quantity of a view is x, its corners have the standard deviation
///   sigma_px sigma(x),   sigma(x) = factor sqrt(1 + growth (x / typical)^2)
/// The factor makes the mean logarithm over all corners 0, so sigma_px is the standard deviation of a typical corner.
/// The growth maximises the restricted likelihood of independent residuals, which accounts for what the pose of each
/// view absorbs.
struct CornerNoise {
  SigmaBy by = SigmaBy::constant;
  double typical = 1;  ///< median over views, in the quantity's unit
  double growth = 0;   ///< >= 0; also 0 if fewer than 4 views have a known x
  double factor = 1;
  double lower_quarter = 1, upper_quarter = 1;  ///< sigma(x) at the quartiles of x

  /// Returns sigma(x). If x is unknown (NaN), returns sigma of the typical x.
  double at(double x) const;
};

/// Effect of a loss (Robust::huber, Robust::cauchy) on the corners. A corner at the distance r from its predicted pixel
/// has the weight rho'(s), s = |r|^2 / (noise_px sigma(x))^2, as in slom/model/loss.hpp.
struct Downweighted {
  std::string loss;            ///< `Huber(1.5)`
  double noise_px = 0;         ///< of u and of v, from the median distance of the corners
  std::size_t corners = 0;     ///< number of corners with weight below 1/2
  double least = 1, mean = 1;  ///< least and mean weight over all corners
  /// Mean weight divided by the mean curvature of the loss. Clustered standard deviations are multiplied by this
  /// factor, because weights alone would make them too small.
  ///   source   Huber, "Robust statistics", 1981, section 7.6
  double over_curvature = 1;
};

/// Comparison of several ways for the noise to grow, on data from which they were not estimated. The views of each
/// camera are cut into blocks of successive views. The growth estimated from the other blocks gives the likelihood of
/// the residuals of each block.
struct NoiseComparison {
  /// The trial of one quantity.
  struct Trial {
    SigmaBy by = SigmaBy::constant;
    double gain = 0;  ///< logarithm of the likelihood minus that of constant noise
    /// Gain divided by its own standard error, from the variation between blocks.
    double standard_errors = 0;
    std::vector<CornerNoise> noise{};  ///< by camera, from all views
  };
  std::vector<Trial> trials;           ///< constant noise first
  SigmaBy chosen = SigmaBy::constant;  ///< largest gain of those above 2 standard errors
};

/// Returns with which quantity the residuals of a successful result grow. `data` and the settings of the result must be
/// those passed to calibrate().
NoiseComparison compareNoise(const Dataset& data, const Result& result);

}  // namespace slom::calibration
