/// Measurements that depend on a variable.
#pragma once

#include <utility>

#include "slom/problem/problem.hpp"

namespace slom {

/// Measurements that depend on each variable. Handles of removed measurements stay until the next query, or until there
/// are more of them than of the others.
struct Problem::Uses {
  struct OfVariable {
    std::vector<Use> all;
    long looked_through = 0;   // value of `removed` at the last search for removed ones
    std::size_t longest = 16;  // size at which add() searches for removed ones
  };
  std::vector<OfVariable> of;  // by variable, as in the variable table
  long removed = 0;            // number of measurements ever removed

  OfVariable& at(int variable) {
    if (static_cast<std::size_t>(variable) >= of.size()) of.resize(static_cast<std::size_t>(variable) + 1);
    return of[static_cast<std::size_t>(variable)];
  }
  void tidy(OfVariable& uses) const {
    if (std::exchange(uses.looked_through, removed) == removed) return;
    std::erase_if(uses.all, [](const Use& use) { return !use.pool->has(use.ref); });
    uses.longest = 2 * uses.all.size() + 16;
  }
  void add(int variable, const Use& use) {
    OfVariable& uses = at(variable);
    if (uses.all.size() >= uses.longest) tidy(uses);
    uses.all.push_back(use);
  }
};

}  // namespace slom
