/// Information that measurements leave on the other variables when some of their variables are eliminated.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "slom/linearize/linearize.hpp"

namespace slom {

/// R d + b|^2 over the stacked tangent vectors d of some variables at their current values.
struct InformationFactor {
  std::vector<int> variables;  ///< indices in the problem's table, ascending
  Eigen::MatrixXd R;           ///< rows x (sum of degrees of freedom); as many rows as its rank
  Eigen::VectorXd b;
};

/// A measurement: its pool and its index there.
using MeasurementIndex = std::pair<int, int>;

/// Returns the measurements that depend on at least one of the variables, ascending.
std::vector<MeasurementIndex> measurementsOf(const Problem& problem, const std::vector<int>& variables);

/// Returns the minimum of sum |r + J d|^2 over the tangent vectors of the eliminated variables, up to a constant, as a
/// function of those of the others. J and r of `measurements` are at the current values, reweighted by losses.
/// Directions that the measurements leave open count as free and leave no information. There is one factor for each
/// remaining set of variables. If elimination causes little fill-in, the time is proportional to the measurements.
/// Variables with few neighbours are eliminated first.
///   source   Dellaert and Kaess, "Factor graphs for robot perception", 2017, section 3.3 (elimination by QR)
std::vector<InformationFactor> marginalInformation(const Problem& problem, Linearizer& linearizer,
                                                   const std::vector<MeasurementIndex>& measurements,
                                                   const std::vector<int>& eliminated);

}  // namespace slom
