// After random operations, the active set equals a plain table of the same operations.
#include <map>
#include <random>

#include <gtest/gtest.h>

#include <slom/problem/active_set.hpp>

namespace {

struct Plain {
  bool is_optimized = true;
  std::vector<char> fixed;
  std::vector<slom::ComponentBound> bounds;
};

constexpr int kComponents = 3;

TEST(ActiveSet, IsWhatAPlainTableSays) {
  std::mt19937 random(4);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  slom::ActiveSet set;
  std::map<int, Plain> table;
  for (int v = 0; v < 20; ++v) {
    table[v] = {};
    set.insert(v, true);
  }
  for (int operation = 0; operation < 10'000; ++operation) {
    const int variable = below(20);
    Plain& plain = table[variable];
    switch (below(6)) {
      case 0:
        plain = {below(2) == 0, {}, {}};
        set.remove(variable);
        set.insert(variable, plain.is_optimized);
        break;
      case 1:
        set.setOptimized(variable, plain.is_optimized = below(2) == 0);
        break;
      case 2:
        plain.fixed.assign(kComponents, 0);
        for (char& is_fixed : plain.fixed) is_fixed = below(2) == 0 ? 1 : 0;
        set.setFixed(variable, plain.fixed);
        break;
      case 3:
        plain.bounds.clear();
        for (int c = 0; c < kComponents; ++c) {
          if (below(2) == 0) plain.bounds.push_back({c, -1, 1});
        }
        set.setBounds(variable, plain.bounds);
        break;
      default:
        if (plain.bounds.empty()) break;
        const auto i = static_cast<std::size_t>(below(static_cast<int>(plain.bounds.size())));
        plain.bounds[i].is_active = below(2) == 0;
        set.activate(variable, i, plain.bounds[i].is_active);
    }
    int fixed_or_active = 0, fixed = 0;
    std::vector<int> constrained;
    bool has_bounds = false;
    for (const auto& [v, row] : table) {
      bool is_constrained = !row.bounds.empty();
      has_bounds = has_bounds || !row.bounds.empty();
      for (int c = 0; c < kComponents; ++c) {
        const bool is_fixed = !row.fixed.empty() && row.fixed[static_cast<std::size_t>(c)] != 0;
        bool is_fixed_or_active = is_fixed;
        for (const auto& bound : row.bounds)
          is_fixed_or_active = is_fixed_or_active || (bound.component == c && bound.is_active);
        is_constrained = is_constrained || is_fixed;
        ASSERT_EQ(set.isFixed(v, c), is_fixed) << operation;
        ASSERT_EQ(set.isFixedOrActive(v, c), is_fixed_or_active) << operation;
        fixed_or_active += is_fixed_or_active && row.is_optimized ? 1 : 0;
        fixed += is_fixed && row.is_optimized ? 1 : 0;
      }
      ASSERT_EQ(set.isOptimized(v), row.is_optimized);
      ASSERT_EQ(set.isConstrained(v), is_constrained);
      ASSERT_EQ(set.bounds(v).size(), row.bounds.size());
      if (is_constrained) constrained.push_back(v);
    }
    ASSERT_EQ(set.fixedOrActiveCount(), fixed_or_active);
    ASSERT_EQ(set.fixedCount(), fixed);
    ASSERT_EQ(set.hasBounds(), has_bounds);
    std::vector<int> listed;
    for (const int v : set.constrained()) listed.push_back(v);
    ASSERT_EQ(listed, constrained);
  }
}

}  // namespace
