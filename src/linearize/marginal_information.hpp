/// What is left of measurements when some of their variables are eliminated.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "slom/linearize/linearize.hpp"

namespace slom {

/// |R d + b|^2 over the tangent vectors d of some variables at their current values, one after the other.
struct InformationFactor {
  std::vector<int> variables;  ///< in the problem's table, ascending
  Eigen::MatrixXd R;           ///< rows x (sum of their degrees of freedom), no more rows than its rank
  Eigen::VectorXd b;
};

/// A measurement, by its pool and its place there.
using MeasurementIndex = std::pair<int, int>;

/// The measurements that depend on at least one of the variables; ascending.
std::vector<MeasurementIndex> measurementsOf(const Problem& problem, const std::vector<int>& variables);

/// The minimum of sum |r + J d|^2 over the tangent vectors of the eliminated variables, as a function of those of the others but for a
/// constant; J and r of `measurements` at the current values, reweighted by losses. Directions that the measurements leave open count as
/// free: they leave nothing. One factor for each set of variables that is left over, in time proportional to the measurements where
/// elimination fills in little. Variables with few neighbours go first.
///   source   Dellaert and Kaess, "Factor graphs for robot perception", 2017, section 3.3 (elimination by QR)
std::vector<InformationFactor> marginalInformation(const Problem& problem, Linearizer& linearizer,
                                                   const std::vector<MeasurementIndex>& measurements,
                                                   const std::vector<int>& eliminated);

}  // namespace slom
