#include "slom/archive.hpp"

#include <algorithm>
#include <numeric>

#include "archive/text.hpp"
#include "base/index.hpp"

namespace slom {

using archive_text::inQuotes;

const StoredProblem::Entry& StoredProblem::entryNamed(const std::string& name) const {
  const auto found =
      std::lower_bound(by_name_.begin(), by_name_.end(), name,
                       [&](int i, const std::string& other) { return entries_[at(i)].name < other; });
  if (found == by_name_.end() || entries_[at(*found)].name != name) {
    throw Error("slom.no-variable",
                "the problem has no variable " + inQuotes(name) + "; names are those given to insertRV",
                name);
  }
  return entries_[at(*found)];
}

VariableHandle StoredProblem::handle(const std::string& name, std::type_index type,
                                     std::string (*type_name)()) const {
  const Entry& entry = entryNamed(name);
  if (entry.type != type) {
    throw Error("slom.no-variable",
                "variable " + inQuotes(name) + " is no " + type_name() + "; ask for it by its own type",
                name);
  }
  return entry.handle;
}

void StoredProblem::sortNames() {
  by_name_.resize(entries_.size());
  std::iota(by_name_.begin(), by_name_.end(), 0);
  std::stable_sort(by_name_.begin(), by_name_.end(),
                   [&](int a, int b) { return entries_[at(a)].name < entries_[at(b)].name; });
}

const detail::StoredVariable* Archive::findVariable(std::type_index type) const {
  const auto found =
      std::find_if(variables_.begin(), variables_.end(), [&](const auto& kind) { return kind.type == type; });
  return found == variables_.end() ? nullptr : &*found;
}

Problem& Archive::problemOf(const Estimator& estimator) { return estimator.problem(); }

void Archive::add(detail::StoredVariable kind, bool is_named) {
  if (const detail::StoredVariable* const known = findVariable(kind.type)) {
    if (!is_named || kind.name == known->name) return;
    throw Error("slom.archive-name",
                "the archive already calls these variables " + inQuotes(known->name) + ", not " +
                    inQuotes(kind.name) + "; name variables before the measurements that use them",
                kind.name);
  }
  for (const detail::StoredVariable& other : variables_) {
    if (other.name == kind.name) {
      throw Error("slom.archive-name",
                  "the archive has variables " + inQuotes(kind.name) +
                      " of another type; give one of them "
                      "another name by archive.variable",
                  kind.name);
    }
  }
  variables_.push_back(std::move(kind));
}

void Archive::add(detail::StoredMeasurement kind) {
  for (const detail::StoredMeasurement& other : measurements_) {
    if (other.type == kind.type && other.name == kind.name) return;
    if (other.type != kind.type && other.name != kind.name) continue;
    throw Error("slom.archive-name",
                other.type == kind.type
                    ? "the archive already calls these measurements " + inQuotes(other.name) + ", not " +
                          inQuotes(kind.name) + "; name them once"
                    : "the archive has measurements " + inQuotes(kind.name) +
                          " of another type; give one of "
                          "them another name",
                kind.name);
  }
  measurements_.push_back(std::move(kind));
}

}  // namespace slom
