#include "analyze/given_derivatives.hpp"

#include "slom/analyze/derivative_check.hpp"

namespace slom {

namespace {

/// Number of measurements checked in each group. One is not enough: left and right derivatives coincide at some values.
constexpr int kMeasurements = 4;

}  // namespace

void GivenDerivatives::check(const Problem& problem, std::vector<std::string>& warnings) {
  if (checked_at_ != problem.structureRevision()) {
    checked_at_ = problem.structureRevision();
    found_.clear();
    try {
      for (const GroupDerivativeCheck& group : findWrongDerivatives(problem, kMeasurements).groups) {
        found_.push_back(group.sentence() +
                         "; wrong derivatives lead to other values or wrong standard deviations: "
                         "slom::checkDerivatives(est) compares them all");
      }
    } catch (...) {  // the function throws next to the fit, so it cannot be checked
    }
  }
  warnings.insert(warnings.end(), found_.begin(), found_.end());
}

}  // namespace slom
