/// How precise corners are beside each other: noise that grows with speed, slant or distance, and losses by which corners that are far off
/// count less.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom::calibration {

struct Dataset;
struct Result;

/// What the standard deviation of the corners of a view grows with.
enum class SigmaBy {
  constant,  ///< all views alike
  speed,     ///< motion of the corners from one image number to the next [px], from neighbouring views: blur
  slant,     ///< angle between the line of sight and the normal of the board [rad]
  distance,  ///< of the centre of the corners from the camera [m]
};
/// `speed`
const char* toString(SigmaBy by);

/// The noise of one camera's corners. A corner of a view where the quantity is x has the standard deviation
///   sigma_px sigma(x),   sigma(x) = factor sqrt(1 + growth (x / typical)^2)
/// with the factor that leaves the mean logarithm over all corners at 0, so that sigma_px is that of a typical corner. The growth is the restricted
/// maximum of the likelihood of independent residuals, in which each view gives up what its pose takes.
struct CornerNoise {
  SigmaBy by = SigmaBy::constant;
  double typical = 1;  ///< median over views, in the quantity's unit
  double growth = 0;   ///< >= 0; 0 too where fewer than four views have a known x
  double factor = 1;
  double lower_quarter = 1, upper_quarter = 1;  ///< sigma(x) at the quartiles of x

  /// sigma(x); for NaN, where x is unknown, that of the typical x.
  double at(double x) const;
};

/// What a loss (Robust::huber, Robust::cauchy) made of the corners. A corner at the distance r from where the fit puts it has the weight
/// rho'(s) of s = |r|^2 / (noise_px sigma(x))^2, as in slom/model/loss.hpp.
struct Downweighted {
  std::string loss;            ///< `Huber(1.5)`
  double noise_px = 0;         ///< of u and of v, from the median distance of the corners
  std::size_t corners = 0;     ///< whose weight is less than one half
  double least = 1, mean = 1;  ///< weight, over all corners
  /// Mean weight over the mean curvature of the loss: the factor of the clustered standard deviations, which weights alone would state too small.
  ///   source   Huber, "Robust statistics", 1981, section 7.6
  double over_curvature = 1;
};

/// Several ways for the noise to grow, put to data that they were not estimated from: each camera's views are cut into blocks of successive ones,
/// and the residuals of each block are as likely as the growth in the others says.
struct NoiseComparison {
  /// One quantity.
  struct Trial {
    SigmaBy by = SigmaBy::constant;
    double gain = 0;  ///< logarithm of the likelihood, less that of constant noise
    double standard_errors =
        0;  ///< gain over its own standard error, from how much it varies between the blocks
    std::vector<CornerNoise> noise{};  ///< by camera, from all views
  };
  std::vector<Trial> trials;           ///< constant noise comes first
  SigmaBy chosen = SigmaBy::constant;  ///< the largest gain of those by more than two standard errors
};

/// Of a result that succeeded: which quantity the residuals grow with. `data` and the settings of the result as passed to calibrate().
NoiseComparison compareNoise(const Dataset& data, const Result& result);

}  // namespace slom::calibration
