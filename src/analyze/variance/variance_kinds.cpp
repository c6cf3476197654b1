#include "analyze/variance/variance_kinds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/index.hpp"
#include "base/words.hpp"

namespace slom {

namespace {

constexpr double kSamePlace = 1e-9;  // distance over correlation length

/// Groups measurements by label, or by type if they have none, as in the rows of a summary's table.
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

/// Returns whether measurements of this pool are priors.
bool isPrior(const MeasurementPool& pool) {
  return pool.label() == "prior" || pool.label() == "position prior" || pool.type().states_noise;
}

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
                  " have losses, so their residuals do not show the variance of good measurements; remove "
                  "the outliers and insert the others without a loss, or leave this "
                  "kind out of VarianceOptions::kinds",
              kind);
}

/// Returns the groups of one shared error: those of the measurements of its kind.
SharedTerm makeSharedTerm(const Problem& problem, const Clustering& kinds, const SharedError& error) {
  const auto found = std::find(kinds.names.begin(), kinds.names.end(), error.kind);
  if (found == kinds.names.end()) {
    throw Error("slom.no-component",
                "no measurements are of the kind " + error.kind + ", which a SharedError names; there are " +
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
                  "measurements " + error.kind + " share an error by " + all.way + ", but the residual of " +
                      pool.measurementName(i) + " has the length " + std::to_string(pool.rows(i)) +
                      ", and others have " + std::to_string(term.dimension) +
                      "; name kinds with residuals of one length",
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

void requireLength(const SharedError& error) {
  if (error.length > 0 && error.length < std::numeric_limits<double>::infinity()) return;
  throw Error("slom.bad-option",
              "an error of measurements " + error.kind +
                  " changes along groups with the correlation length " + number(error.length, 6) +
                  "; pass a positive length in the units of SharedError::place",
              error.kind);
}

/// Returns the place of measurement i of pool p.
double placeIn(const Problem& problem, const SharedError& error, std::size_t p, int i) {
  const double place = error.place(ClusterItem(problem, *problem.pools()[p], i));
  if (std::isfinite(place)) return place;
  const std::string name = problem.pools()[p]->measurementName(i);
  throw Error("slom.bad-option",
              "the place of measurement " + name + " is " + number(place) +
                  "; let SharedError::place return a finite time or distance",
              name);
}

/// Makes each place in each group a group of its own, in the order of groups and places.
void splitByPlace(const Problem& problem, const SharedError& error, SharedTerm& term) {
  requireLength(error);
  std::map<std::pair<int, double>, int> states;  // by group and place
  std::vector<std::vector<double>> places(term.groups.of_pool.size());
  for (std::size_t p = 0; p < places.size(); ++p) {
    for (std::size_t i = 0; i < term.groups.of_pool[p].size(); ++i) {
      const int group = term.groups.of_pool[p][i];
      places[p].push_back(group < 0 ? 0 : placeIn(problem, error, p, static_cast<int>(i)));
      if (group >= 0) states[{group, places[p].back()}] = 0;
    }
  }
  std::vector<std::string> names;
  int group = -1;
  double place = 0;
  for (auto& [key, state] : states) {
    const double t = (key.second - place) / error.length;
    const bool is_first = key.first != group;
    if (is_first || t > kSamePlace) {  // places that differ by rounding are one
      term.previous.push_back(is_first ? -1 : static_cast<int>(names.size()) - 1);
      term.distance.push_back(is_first ? 0 : t);
      names.push_back(term.groups.names[at(key.first)]);
      place = key.second;
    }
    group = key.first;
    state = static_cast<int>(names.size()) - 1;
  }
  for (std::size_t p = 0; p < places.size(); ++p) {
    for (std::size_t i = 0; i < places[p].size(); ++i) {
      int& own = term.groups.of_pool[p][i];
      if (own >= 0) own = states[{own, places[p][i]}];
    }
  }
  term.groups.names = std::move(names);
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
    if (error.place) splitByPlace(problem, error, result.shared.back());
    result.shared_names.push_back(error.kind + ", shared by " + result.shared.back().groups.way);
    const auto own = std::find(result.names.begin(), result.names.end(), error.kind);
    result.shared_kind.push_back(own == result.names.end() ? -1
                                                           : static_cast<int>(own - result.names.begin()));
  }
  if (result.names.empty() && result.shared.empty()) {
    throw Error("slom.no-component",
                "there are no measurements whose variance can be estimated; to estimate the variance of "
                "priors, name them in VarianceOptions::kinds",
                "varianceComponents");
  }
  return result;
}

}  // namespace slom
