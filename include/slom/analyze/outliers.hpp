/// Which measurements do not fit the others.
///
/// A residual w (whitened) is smaller than the error that made it, as the fit follows each measurement a little: its
/// covariance is Q = I - J C J^T, with C that of the variables. The trace of Q is the measurement's redundancy: 0 when nothing
/// checks it, its length when all else determines the fit. T = w^T Q^-1 w is chi-square distributed when the measurement is
/// good ("data snooping").
///   source   Baarda, "A testing procedure for use in geodetic networks", 1968; Cook and Weisberg, "Residuals and influence
///            in regression", 1982, chapters 2 and 3
/// With Sigma::estimated the variance factor comes from all other measurements, so that an error does not hide itself: T is then divided by the
/// factor without the measurement, and has an F distribution.
///   source   Cook and Weisberg, section 2.2.1 (external studentisation); Heck, "Der Einfluss einzelner Beobachtungen auf das Ergebnis einer
///            Ausgleichung", 1981
/// A measurement with a loss counts with the weight p that the loss gives it, and Q = I + (1 - 2 p) J C J^T, which is exact for
/// p = 1 and for p = 0, where the fit does not know of the measurement.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "slom/model/meas_id.hpp"

namespace slom {

/// A measurement with less redundancy is hardly checkable: less than a tenth of an error in it shows in its residual.
///   source   Foerstner and Wrobel, "Photogrammetric Computer Vision", 2016, section 4.6 (classes of redundancy numbers)
inline constexpr double kHardlyCheckable = 0.1;

/// How many false alarms are accepted, and how much is listed.
struct OutlierOptions {
  /// The probability that a problem in which all measurements are good has a suspect. Shared out among all measurements, so
  /// that many of them do not make for many false alarms.
  double significance = 0.01;
  /// Measurements of each group that the report lists.
  int worst = 10;
};

/// The test of one measurement; lengths in standard deviations.
struct MeasurementCheck {
  std::string measurement;
  double residual = 0;     ///< |w|, in stated standard deviations
  double studentized = 0;  ///< sqrt(T / dof), in the standard deviations that Sigma says: 1 is usual
  double redundancy =
      0;  ///< trace of Q over the length of the residual: 0 nothing checks it, 1 all else is known
  double weight = 1;       ///< the weight that its loss gives it
  double statistic = 0;    ///< T, over the variance factor
  int dof = 0;             ///< rank of Q
  double probability = 1;  ///< that a good measurement has such a T or a larger one
  double effect =
      0;  ///< root of Cook's distance (not divided by the unknowns): how far the fit moves without it, sqrt(d^T C^-1 d), C as Sigma says
  bool is_suspect = false;
  /// The number in `measurement`: 1 for the first that was inserted with this label or of this type; 0 for a group of measurements.
  long number = 0;
  AnyMeasID
      id;  ///< its handle, for removeMeasurement and others; refers to nothing for a group of measurements

  /// Whether its residual says little of its errors: redundancy < kHardlyCheckable.
  bool isHardlyCheckable() const { return redundancy < kHardlyCheckable; }
};

/// The test of all measurements with one label or of one type.
struct GroupCheck {
  std::string name;
  int measurements = 0;
  double chi2 = 0;        ///< sum of |w|^2, weights of losses not counted
  double redundancy = 0;  ///< sum of the traces of Q: what chi2 is on average
  double probability =
      1;  ///< that a chi2 is this far off or farther, to either side; 1 without redundancy, and where all of it made the variance factor
  bool has_losses = false;
  int suspects = 0;
  std::vector<MeasurementCheck> worst;            ///< sorted by probability, the least probable first
  int hardly_checkable = 0;                       ///< measurements with a redundancy below kHardlyCheckable
  std::vector<MeasurementCheck> least_checkable;  ///< the OutlierOptions::worst of them, by redundancy
};

/// The tests of all measurements, by group.
struct OutlierReport {
  double significance = 0;     ///< significance level of each single test
  double variance_factor = 1;  ///< divisor of chi2: 1 for Sigma::known
  std::string noise;           ///< which standard deviations count, in a sentence; empty: those stated
  std::string
      unconverged;  ///< why the last fit, whose values these are, has not converged; empty: it has, or there was none
  std::vector<GroupCheck> groups;

  /// The number of measurements whose test fails, in all groups.
  int suspects() const;
  /// The measurements that the groups list, over all groups: the least probable first.
  std::vector<MeasurementCheck> ranking() const;
  /// The number of measurements that are hardly checkable, in all groups.
  int hardlyCheckable() const;
  /// A table for each group, the ranking over all of them, and what is hardly checkable.
  std::string text() const;
};

std::ostream& operator<<(std::ostream& os, const OutlierReport& report);

}  // namespace slom
