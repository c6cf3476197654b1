/// The one owner of what does not move: fixed variables, fixed components, and components at an active bound because the
/// RSS falls beyond it. Variables are known by their index in the problem's table.
#pragma once

#include <cstddef>
#include <vector>

#include "slom/model/index_set.hpp"

namespace slom {

/// Limits of the coordinate of a component.
struct ComponentBound {
  int component;
  double lower, upper;
  bool is_active = false;  ///< it is at a limit and stays there, because the RSS falls beyond
};

class ActiveSet {
 public:
  /// A new variable, perhaps in the place of a removed one, without fixed components and bounds. Cannot fail after
  /// `reserve`.
  void insert(int variable, bool is_optimized);
  /// Forgets all about a variable that is removed.
  void remove(int variable);
  /// So that inserting cannot fail below this number of variables.
  void reserve(std::size_t variables);

  /// Whether the variable is not fixed as a whole.
  bool isOptimized(int variable) const { return is_optimized_[at(variable)] != 0; }
  /// Fixes a variable as a whole, or releases it.
  void setOptimized(int variable, bool is_optimized) { is_optimized_[at(variable)] = is_optimized ? 1 : 0; }

  /// Whether it has fixed components or bounds.
  bool isConstrained(int variable) const { return place_[at(variable)] >= 0; }
  /// Whether the component is fixed by itself.
  bool isFixed(int variable, int component) const {
    return isConstrained(variable) && of(variable).isFixed(component);
  }
  /// Whether the component is fixed by itself or at an active bound.
  bool isFixedOrActive(int variable, int component) const {
    return isConstrained(variable) && of(variable).isFixedOrActive(component);
  }
  /// Makes the rows of components of a, and the columns of those of b, that are fixed or at an active bound 0 in a block of dof_a x
  /// dof_b, column-major.
  void clear(int a, int dof_a, int b, int dof_b, double* block) const;
  /// Whether it has components that are fixed by themselves.
  bool hasFixed(int variable) const { return isConstrained(variable) && !of(variable).fixed.empty(); }
  /// The bounds of a variable, at most one for each component, sorted by component.
  const std::vector<ComponentBound>& bounds(int variable) const;
  /// The bound of a component, or null.
  const ComponentBound* boundOf(int variable, int component) const {
    return isConstrained(variable) ? of(variable).boundOf(component) : nullptr;
  }

  /// fixed: an entry for each component, not 0 where it is fixed; empty: none is.
  void setFixed(int variable, std::vector<char> fixed);
  /// As setFixed takes it.
  const std::vector<char>& fixed(int variable) const;
  /// Replaces the bounds of a variable, sorted by component; empty: none.
  void setBounds(int variable, std::vector<ComponentBound> bounds);
  /// Says whether bound i of the variable is active.
  void activate(int variable, std::size_t i, bool is_active);

  /// Variables with fixed components or bounds, ascending.
  const IndexSet& constrained() const { return constrained_; }
  /// Whether any variable has bounds.
  bool hasBounds() const { return !bounded_.empty(); }
  /// Number of components of optimised variables that are fixed or at a bound.
  int fixedOrActiveCount() const;
  /// Number of components of optimised variables that are fixed by themselves.
  int fixedCount() const;

 private:
  struct Constraints {
    std::vector<char> fixed;  // by component; empty: none
    std::vector<ComponentBound> bounds;

    bool isFixed(int component) const {
      return !fixed.empty() && fixed[static_cast<std::size_t>(component)] != 0;
    }
    bool isFixedOrActive(int component) const {
      if (isFixed(component)) return true;
      const ComponentBound* const bound = boundOf(component);
      return bound != nullptr && bound->is_active;
    }
    const ComponentBound* boundOf(int component) const;
  };
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  const Constraints& of(int variable) const { return constraints_[at(place_[at(variable)])]; }
  /// The constraints of the variable, made if there are none.
  Constraints& make(int variable);
  /// Removes empty constraints and indexes the others.
  void tidy(int variable);

  std::vector<char> is_optimized_;        // by variable
  std::vector<int> place_;                // of a variable's constraints; -1: none
  std::vector<Constraints> constraints_;  // of some variables, in no order
  std::vector<int> free_;                 // places
  IndexSet constrained_, bounded_;
};

}  // namespace slom
