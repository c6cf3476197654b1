/// ActiveSet: the only place that records what does not move. These are fixed variables, fixed components, and
/// components at an active bound, beyond which the RSS would fall. Variables are given by their index in the problem's
/// table.
#pragma once

#include <cstddef>
#include <vector>

#include "slom/model/index_set.hpp"

namespace slom {

/// Bounds of the coordinate of a component.
struct ComponentBound {
  int component;
  double lower, upper;
  bool is_active = false;  ///< the component is at a limit and stays there, because the RSS falls beyond it
};

class ActiveSet {
 public:
  /// Adds a new variable without fixed components and bounds, possibly with the index of a removed one. Cannot fail
  /// after `reserve`.
  void insert(int variable, bool is_optimized);
  /// Removes all data of a variable that is removed.
  void remove(int variable);
  /// Reserves memory, so that inserting cannot fail below this number of variables.
  void reserve(std::size_t variables);

  /// Returns whether the variable is not fixed as a whole.
  bool isOptimized(int variable) const { return is_optimized_[at(variable)] != 0; }
  /// Fixes a variable as a whole, or releases it.
  void setOptimized(int variable, bool is_optimized) { is_optimized_[at(variable)] = is_optimized ? 1 : 0; }

  /// Returns whether the variable has fixed components or bounds.
  bool isConstrained(int variable) const { return place_[at(variable)] >= 0; }
  /// Returns whether the component itself is fixed.
  bool isFixed(int variable, int component) const {
    return isConstrained(variable) && of(variable).isFixed(component);
  }
  /// Returns whether the component itself is fixed or at an active bound.
  bool isFixedOrActive(int variable, int component) const {
    return isConstrained(variable) && of(variable).isFixedOrActive(component);
  }
  /// Sets entries of a block (dof_a x dof_b, column-major) to 0: the rows of components of a and the columns of
  /// components of b that are fixed or at an active bound.
  void clear(int a, int dof_a, int b, int dof_b, double* block) const;
  /// Returns whether the variable has components that are fixed themselves.
  bool hasFixed(int variable) const { return isConstrained(variable) && !of(variable).fixed.empty(); }
  /// Returns the bounds of a variable, at most one for each component, sorted by component.
  const std::vector<ComponentBound>& bounds(int variable) const;
  /// Returns the bound of a component, or null.
  const ComponentBound* boundOf(int variable, int component) const {
    return isConstrained(variable) ? of(variable).boundOf(component) : nullptr;
  }

  /// Sets the fixed components. fixed: an entry for each component, not 0 if it is fixed; empty: none.
  void setFixed(int variable, std::vector<char> fixed);
  /// Returns the fixed components in the form of setFixed.
  const std::vector<char>& fixed(int variable) const;
  /// Replaces the bounds of a variable, sorted by component; empty: none.
  void setBounds(int variable, std::vector<ComponentBound> bounds);
  /// Sets whether bound i of the variable is active.
  void activate(int variable, std::size_t i, bool is_active);

  /// Returns the variables with fixed components or bounds, ascending.
  const IndexSet& constrained() const { return constrained_; }
  /// Returns whether any variable has bounds.
  bool hasBounds() const { return !bounded_.empty(); }
  /// Returns the number of components of optimised variables that are fixed or at an active bound.
  int fixedOrActiveCount() const;
  /// Returns the number of components of optimised variables that are fixed themselves.
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
  /// Returns the constraints of the variable; creates them if there are none.
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
