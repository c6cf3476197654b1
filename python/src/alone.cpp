#include "alone.hpp"

#include <algorithm>
#include <vector>

namespace slom::python {

namespace {
std::vector<const Estimator*>& all() {  // guarded by the interpreter's lock
  static std::vector<const Estimator*> estimators;
  return estimators;
}
}  // namespace

InUse::InUse(const Estimator& est) : est_(&est) {
  if (std::find(all().begin(), all().end(), est_) != all().end()) {
    throw mtk::Error(
        "slom.in-use",
        "the estimator is in the middle of another call, such as a fit, from another thread or from the "
        "function that calls this now; wait for its end, or use a copy made by est.clone()",
        "estimator");
  }
  all().push_back(est_);
}

InUse::~InUse() { all().erase(std::find(all().begin(), all().end(), est_)); }

}  // namespace slom::python
