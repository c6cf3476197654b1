#include <algorithm>
#include <tuple>

#include "analyze/covariance.hpp"
#include "base/index.hpp"
#include "slom/analyze/uncertainty.hpp"

namespace slom {

Marginals makeMarginals(const Problem& problem, const std::function<bool(int variable, double* block)>& write,
                        double variance_factor) {
  using Place = Marginals::Place;
  Marginals result;
  result.stores_ = problem.stores();
  std::vector<double> block;
  for (std::size_t v = 0; v < problem.variables().size(); ++v) {
    const VariableRecord& record = problem.variables()[v];
    if (record.store == nullptr) continue;
    Place place;
    while (result.stores_[place.store].get() != record.store) ++place.store;
    place.ref = record.store->refTo(record.slot);
    place.dof = record.dof;
    block.resize(at(record.dof) * at(record.dof));
    if (write(static_cast<int>(v), block.data())) {
      place.start = result.numbers_.size();
      for (const double number : block) result.numbers_.push_back(number * variance_factor);
    }
    result.places_.push_back(place);
  }
  std::sort(result.places_.begin(), result.places_.end(), [](const Place& a, const Place& b) {
    return std::tie(a.store, a.ref.slot) < std::tie(b.store, b.ref.slot);
  });
  return result;
}

Marginals makeMarginals(const LinearizedProblem& linearized, FreeGauge gauge, double variance_factor) {
  const InverseBlocks& inverse = linearized.inverse(gauge);
  const ProblemStructure& structure = linearized.structure();
  const auto write = [&](int variable, double* block) {
    if (structure.system.isEmpty(variable)) return false;
    inverse.block(variable, variable, block);
    clearConstrained(linearized, variable, variable, block);
    const int dof = structure.system.dof(variable);
    for (int i = 0; i < dof; ++i) {  // conjugate gradients do not detect a loss of rank
      if (block[i * (dof + 1)] < 0)
        throw linearized.undetermined(SolveStatus{false, structure.offsetOf(variable) + i, 0, 0});
    }
    return true;
  };
  return makeMarginals(linearized.problem(), write, variance_factor);
}

const Marginals::Place& Marginals::placeOf(const VariableHandle& id) const {
  if (id.store_ == nullptr) detail::raiseStaleHandle("VarID", false);
  std::size_t store = 0;
  while (store < stores_.size() && stores_[store] != id.store_) ++store;
  const auto found =
      std::lower_bound(places_.begin(), places_.end(), std::pair(store, id.ref_.slot),
                       [](const Place& place, const auto& key) {
                         return std::tie(place.store, place.ref.slot) < std::tie(key.first, key.second);
                       });
  const bool is_there = found != places_.end() && found->store == store && found->ref.slot == id.ref_.slot &&
                        found->ref.generation == id.ref_.generation;
  if (is_there) return *found;
  const std::string name = "VarID<" + id.store_->typeName() + ">";
  throw Error("slom.stale-marginals",
              "the " + name +
                  " refers to a variable that was not in the problem when the marginals were "
                  "computed; call marginals() again, of the estimator that holds it",
              name);
}

}  // namespace slom
