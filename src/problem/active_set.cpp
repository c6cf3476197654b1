#include "slom/problem/active_set.hpp"

#include <algorithm>

namespace slom {

void ActiveSet::reserve(std::size_t variables) {
  is_optimized_.reserve(variables);
  place_.reserve(variables);
}

void ActiveSet::insert(int variable, bool is_optimized) {
  if (at(variable) >= place_.size()) {
    is_optimized_.resize(at(variable) + 1, 0);
    place_.resize(at(variable) + 1, -1);
  }
  is_optimized_[at(variable)] = is_optimized ? 1 : 0;
}

void ActiveSet::remove(int variable) {
  if (!isConstrained(variable)) return;
  make(variable) = {};
  tidy(variable);
}

const ComponentBound* ActiveSet::Constraints::boundOf(int component) const {
  const auto found =
      std::lower_bound(bounds.begin(), bounds.end(), component,
                       [](const ComponentBound& bound, int wanted) { return bound.component < wanted; });
  return found != bounds.end() && found->component == component ? &*found : nullptr;
}

const std::vector<ComponentBound>& ActiveSet::bounds(int variable) const {
  static const std::vector<ComponentBound> none;
  return isConstrained(variable) ? of(variable).bounds : none;
}

const std::vector<char>& ActiveSet::fixed(int variable) const {
  static const std::vector<char> none;
  return isConstrained(variable) ? of(variable).fixed : none;
}

ActiveSet::Constraints& ActiveSet::make(int variable) {
  int& place = place_[at(variable)];
  if (place < 0 && free_.empty()) {
    constraints_.emplace_back();
    place = static_cast<int>(constraints_.size()) - 1;
  } else if (place < 0) {
    place = free_.back();
    free_.pop_back();
  }
  return constraints_[at(place)];
}

void ActiveSet::tidy(int variable) {
  const Constraints& own = of(variable);
  bounded_.set(variable, !own.bounds.empty());
  const bool is_empty = own.fixed.empty() && own.bounds.empty();
  constrained_.set(variable, !is_empty);
  if (!is_empty) return;
  free_.push_back(place_[at(variable)]);
  place_[at(variable)] = -1;
}

void ActiveSet::setFixed(int variable, std::vector<char> fixed) {
  if (std::find_if(fixed.begin(), fixed.end(), [](char is_fixed) { return is_fixed != 0; }) == fixed.end())
    fixed.clear();
  make(variable).fixed = std::move(fixed);
  tidy(variable);
}

void ActiveSet::setBounds(int variable, std::vector<ComponentBound> bounds) {
  make(variable).bounds = std::move(bounds);
  tidy(variable);
}

void ActiveSet::activate(int variable, std::size_t i, bool is_active) {
  make(variable).bounds[i].is_active = is_active;
}

int ActiveSet::fixedCount() const {
  int count = 0;
  for (const int v : constrained_) {
    const std::vector<char>& fixed = of(v).fixed;
    if (isOptimized(v))
      count += static_cast<int>(
          std::count_if(fixed.begin(), fixed.end(), [](char is_fixed) { return is_fixed != 0; }));
  }
  return count;
}

int ActiveSet::fixedOrActiveCount() const {
  int count = fixedCount();
  for (const int v : constrained_) {
    if (!isOptimized(v)) continue;
    for (const ComponentBound& bound : of(v).bounds)
      count += bound.is_active && !of(v).isFixed(bound.component) ? 1 : 0;
  }
  return count;
}

void ActiveSet::clear(int a, int dof_a, int b, int dof_b, double* block) const {
  if (!isConstrained(a) && !isConstrained(b)) return;
  for (int j = 0; j < dof_b; ++j) {
    for (int i = 0; i < dof_a; ++i, ++block) {
      if (isFixedOrActive(a, i) || isFixedOrActive(b, j)) *block = 0;
    }
  }
}

}  // namespace slom
