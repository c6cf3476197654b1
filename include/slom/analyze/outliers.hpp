/// Tests for measurements that do not fit the others ("data snooping").
///
/// A whitened residual w is smaller than its error, because the fit follows each measurement a little. Its covariance
/// is Q = I - J C J^T, with C the covariance of the variables. The trace of Q is the measurement's redundancy. It is 0
/// if no other measurement checks this one, and the length of the residual if all others determine the fit. T = w^T
/// Q^-1 w has a chi-square distribution if the measurement is good.
///   source   Baarda, "A testing procedure for use in geodetic networks", 1968; Cook and Weisberg, "Residuals and
///            influence in regression", 1982, chapters 2 and 3
/// With Sigma::estimated, the variance factor comes from all other measurements, so an error does not hide itself. T is
/// then divided by the factor without the measurement, and has an F distribution.
///   source   Cook and Weisberg, section 2.2.1 (external studentisation); Heck, "Der Einfluss einzelner Beobachtungen
///            auf das Ergebnis einer Ausgleichung", 1981
/// A measurement with a loss counts with the weight p from the loss, and Q = I + (1 - 2 p) J C J^T. This is exact for p
/// = 1, and for p = 0, where the measurement does not influence the fit.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "slom/model/meas_id.hpp"

namespace slom {

class Estimator;

/// Redundancy below which a measurement is hardly checkable: less than 10 % of an error shows in its residual.
///   source   Foerstner and Wrobel, "Photogrammetric Computer Vision", 2016, section 4.6 (classes of redundancy
///            numbers)
inline constexpr double kHardlyCheckable = 0.1;

/// Options: the rate of false alarms and the length of lists.
struct OutlierOptions {
  /// The probability that a problem with only good measurements has a suspect. It is divided among all measurements, so
  /// many measurements do not cause many false alarms.
  double significance = 0.01;
  /// Number of measurements of each group in the report.
  int worst = 10;
};

/// The test of one measurement. Lengths are in standard deviations.
struct MeasurementCheck {
  std::string measurement;
  double residual = 0;     ///< |w|, in stated standard deviations
  double studentized = 0;  ///< sqrt(T / dof), in standard deviations according to Sigma; usually near 1
  /// Trace of Q divided by the length of the residual. 0: nothing checks the measurement; 1: all else is known.
  double redundancy = 0;
  double weight = 1;       ///< weight from its loss
  double statistic = 0;    ///< T divided by the variance factor
  int dof = 0;             ///< rank of Q
  double probability = 1;  ///< p-value: that a good measurement has a T at least as large
  /// Root of Cook's distance (not divided by the number of unknowns): how far the fit moves without the measurement,
  /// sqrt(d^T C^-1 d), with C according to Sigma.
  double effect = 0;
  bool is_suspect = false;
  /// The number in `measurement`: 1 for the first one inserted with this label or of this type; 0 for a group of
  /// measurements.
  long number = 0;
  /// Handle of the measurement, for removeMeasurement and others. Refers to nothing for a group of measurements.
  AnyMeasID id;

  /// Returns whether the residual says little about errors: redundancy < kHardlyCheckable.
  bool isHardlyCheckable() const { return redundancy < kHardlyCheckable; }
};

/// The test of all measurements with one label or of one type.
struct GroupCheck {
  std::string name;
  int measurements = 0;
  double chi2 = 0;        ///< sum of |w|^2, without weights of losses
  double redundancy = 0;  ///< sum of the traces of Q: the expected value of chi2
  /// p-value of chi2, two-sided. 1 without redundancy, and if all of the redundancy served to estimate the variance
  /// factor.
  double probability = 1;
  bool has_losses = false;
  int suspects = 0;
  std::vector<MeasurementCheck> worst;            ///< sorted by probability, the least probable first
  int hardly_checkable = 0;                       ///< measurements with a redundancy below kHardlyCheckable
  std::vector<MeasurementCheck> least_checkable;  ///< OutlierOptions::worst of them, by redundancy
};

/// The tests of all measurements, by group.
struct OutlierReport {
  double significance = 0;     ///< significance level of each single test
  double variance_factor = 1;  ///< divisor of chi2: 1 for Sigma::known
  std::string noise;           ///< standard deviations in use, in a sentence; empty: the stated ones
  /// Reason why the last fit, which gave these values, has not converged. Empty if it has or if there was none.
  std::string unconverged;
  std::vector<GroupCheck> groups;

  /// Returns the number of measurements that fail the test, in all groups.
  int suspects() const;
  /// Returns the listed measurements of all groups, the least probable first.
  std::vector<MeasurementCheck> ranking() const;
  /// Returns the number of hardly checkable measurements, in all groups.
  int hardlyCheckable() const;
  /// Returns a table for each group, the ranking of all groups, and the hardly checkable measurements.
  std::string text() const;
};

std::ostream& operator<<(std::ostream& os, const OutlierReport& report);

/// Tests each measurement against all others, at the values of the fit: studentised residual, redundancy, p-value of
/// the residual, and how far the fit would move without the measurement. Throws as Estimator::covariance does.
OutlierReport outliers(const Estimator& est, const OutlierOptions& options = {});

}  // namespace slom
