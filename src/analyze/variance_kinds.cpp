#include "analyze/variance_kinds.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "base/words.hpp"

namespace slom {

namespace {

/// Labels, or types of measurements without one: the rows of a summary's table.
Clustering byPool(const Problem& problem) {
  Clustering result;
  result.way = "kind";
  std::vector<int> number(at(problem.groupCount()), -1);
  for (const auto& pool : problem.pools()) {
    int& own = number[at(pool->group())];
    if (own < 0 && pool->size() > 0) {
      own = result.count();
      result.names.push_back(pool->name());
    }
    result.of_pool.emplace_back(at(pool->size()), own);
  }
  return result;
}

/// Whether measurements of this pool state what is known beforehand.
bool isPrior(const MeasurementPool& pool) { return pool.label() == "prior" || pool.type().states_noise; }

std::vector<char> chosenKinds(const Problem& problem, const Clustering& kinds,
                              const VarianceOptions& options) {
  std::vector<char> is_chosen(at(kinds.count()), options.kinds.empty() ? 1 : 0);
  for (const std::string& name : options.kinds) {
    const auto found = std::find(kinds.names.begin(), kinds.names.end(), name);
    if (found == kinds.names.end()) {
      throw Error("slom.no-component",
                  "no measurements are of the kind " + name + "; there are " + listed(kinds.names, 8), name);
    }
    is_chosen[static_cast<std::size_t>(found - kinds.names.begin())] = 1;
  }
  if (!options.kinds.empty() || options.by) return is_chosen;
  for (std::size_t p = 0; p < problem.pools().size(); ++p) {
    if (problem.pools()[p]->size() > 0 && isPrior(*problem.pools()[p]))
      is_chosen[at(kinds.of_pool[p].front())] = 0;
  }
  return is_chosen;
}

void requireNoLosses(const MeasurementPool& pool, const std::string& kind) {
  if (pool.lossCount() == 0) return;
  throw Error("slom.components-with-loss",
              "measurements " + kind +
                  " have losses, and the residuals that a loss lets grow say nothing of the variance of good "
                  "measurements; remove the outliers and insert the others without a loss, or leave this "
                  "kind out of VarianceOptions::kinds",
              kind);
}

/// The groups of one shared error: those of the measurements of its kind.
SharedTerm makeSharedTerm(const Problem& problem, const Clustering& kinds, const SharedError& error) {
  const auto found = std::find(kinds.names.begin(), kinds.names.end(), error.kind);
  if (found == kinds.names.end()) {
    throw Error("slom.no-component",
                "an error is to be shared by measurements of the kind " + error.kind + "; there are " +
                    listed(kinds.names, 8),
                error.kind);
  }
  const int kind = static_cast<int>(found - kinds.names.begin());
  const Clustering all = makeClustering(problem, error.by);
  SharedTerm term;
  term.groups.way = all.way;
  std::vector<int> number(at(all.count()), -1);
  for (std::size_t p = 0; p < problem.pools().size(); ++p) {
    const MeasurementPool& pool = *problem.pools()[p];
    std::vector<int>& of = term.groups.of_pool.emplace_back(at(pool.size()), -1);
    for (int i = 0; i < pool.size(); ++i) {
      const int group = all.of_pool[p][at(i)];
      if (group < 0 || kinds.of_pool[p][at(i)] != kind) continue;
      requireNoLosses(pool, error.kind);
      if (number[at(group)] < 0) {
        number[at(group)] = term.groups.count();
        term.groups.names.push_back(all.names[at(group)]);
      }
      of[at(i)] = number[at(group)];
      if (term.dimension == 0) term.dimension = pool.rows(i);
      if (pool.rows(i) == term.dimension) continue;
      throw Error("slom.bad-group",
                  "measurements " + error.kind + " share an error by " + all.way + ", but that of " +
                      pool.measurementName(i) + " has the length " + std::to_string(pool.rows(i)) +
                      ", and others have " + std::to_string(term.dimension) +
                      "; name kinds whose residuals have one length",
                  pool.measurementName(i));
    }
  }
  if (term.groups.count() == 0) {
    throw Error("slom.no-groups",
                "no measurement of the kind " + error.kind + " is in a group by " + all.way +
                    "; pass slom::group to insertMeasurement",
                error.kind);
  }
  return term;
}

}  // namespace

VarianceKinds makeVarianceKinds(const Problem& problem, const VarianceOptions& options) {
  const Clustering kinds = options.by ? makeClustering(problem, *options.by) : byPool(problem);
  const std::vector<char> is_chosen = chosenKinds(problem, kinds, options);
  VarianceKinds result;
  std::vector<int> number(at(kinds.count()), -1);
  for (int k = 0; k < kinds.count(); ++k) {
    if (is_chosen[at(k)] != 0) {
      number[at(k)] = static_cast<int>(result.names.size());
      result.names.push_back(kinds.names[at(k)]);
    } else {
      result.kept.push_back(kinds.names[at(k)]);
    }
  }
  result.measurements.assign(result.names.size(), 0);
  for (std::size_t p = 0; p < problem.pools().size(); ++p) {
    std::vector<int>& of = result.of_pool.emplace_back(kinds.of_pool[p]);
    for (int& kind : of) {
      kind = kind < 0 ? -1 : number[at(kind)];
      if (kind < 0) continue;
      ++result.measurements[at(kind)];
      requireNoLosses(*problem.pools()[p], result.names[at(kind)]);
    }
  }
  for (const SharedError& error : options.shared) {
    result.shared.push_back(makeSharedTerm(problem, kinds, error));
    result.shared_names.push_back(error.kind + ", shared by " + result.shared.back().groups.way);
    const auto own = std::find(result.names.begin(), result.names.end(), error.kind);
    result.shared_kind.push_back(own == result.names.end() ? -1
                                                           : static_cast<int>(own - result.names.begin()));
  }
  if (result.names.empty() && result.shared.empty()) {
    throw Error("slom.no-component",
                "there are no measurements whose variance could be estimated; priors state what is known, "
                "name them in VarianceOptions::kinds if theirs is in question",
                "varianceComponents");
  }
  return result;
}

}  // namespace slom
