/// Values of variables as they were, to be brought back.
#pragma once

#include <map>
#include <set>
#include <utility>
#include <vector>

#include "slom/model/value_array.hpp"
#include "slom/problem/problem.hpp"

namespace slom {

class SavedValues {
 public:
  explicit SavedValues(Problem& problem) : problem_(problem) {}
  SavedValues(const SavedValues&) = delete;
  SavedValues& operator=(const SavedValues&) = delete;
  ~SavedValues();

  /// Copies the variable's value, the first time that it is called for it.
  void keep(int variable);
  /// The variables whose values are kept.
  const std::vector<int>& variables() const { return variables_; }
  /// All of them get their values back.
  void restore();

 private:
  Problem& problem_;
  std::map<VariableStoreBase*, ValueArray> values_;
  std::vector<int> variables_;
  std::vector<std::size_t> index_;  // of each, in the array of its store
  std::set<int> known_;
};

}  // namespace slom
