#include "analyze/clusters.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>

#include "base/index.hpp"
#include "base/words.hpp"
#include "slom/problem/group_table.hpp"

namespace slom {

std::optional<std::int64_t> ClusterItem::key(std::string_view dimension) const {
  const GroupTable* const groups = problem_.groups();
  const int d = groups == nullptr ? -1 : groups->find(dimension);
  const int number = d < 0 ? -1 : pool_.groupKey(d, i_);
  if (number < 0 || groups->keys(d)[at(number)].is_text) return {};
  return groups->keys(d)[at(number)].number;
}

bool ClusterItem::dependsOn(const VariableHandle& id) const {
  const int variable = problem_.indexOf(id);
  const int* const all = pool_.variables(i_);
  return std::find(all, all + pool_.arity(), variable) != all + pool_.arity();
}

ClusterBy ClusterBy::label() {
  ClusterBy by("label");
  by.kind_ = Kind::label;
  return by;
}

ClusterBy ClusterBy::variables(std::string name, std::vector<AnyVarID> ids) {
  ClusterBy by(std::move(name));
  by.kind_ = Kind::variables;
  by.ids_ = std::move(ids);
  return by;
}

ClusterBy ClusterBy::function(std::string name,
                              std::function<std::optional<std::int64_t>(const ClusterItem&)> f) {
  ClusterBy by(std::move(name));
  by.kind_ = Kind::function;
  by.function_ = std::move(f);
  return by;
}

ClusterBy ClusterBy::blocks(std::string dimension, std::int64_t length) {
  if (length < 1) {
    throw Error("slom.bad-option",
                "the length of blocks of \"" + dimension + "\" is " + std::to_string(length) +
                    "; pass a positive number of keys",
                dimension);
  }
  const std::string name = dimension + " / " + std::to_string(length);
  return function(name, [dimension, length](const ClusterItem& item) -> std::optional<std::int64_t> {
    const std::optional<std::int64_t> key = item.key(dimension);
    if (!key) return {};
    return *key / length - (*key % length < 0 ? 1 : 0);
  });
}

/// A maker of groups from keys. Keys are numbers; the names of groups may differ from them.
class ClusterMaker {
 public:
  ClusterMaker(const Problem& problem, const ClusterBy& by) : problem_(problem), by_(by) {}

  Clustering make() {
    switch (by_.kind_) {
      case ClusterBy::Kind::dimension:
        byDimension();
        break;
      case ClusterBy::Kind::label:
        byLabel();
        break;
      case ClusterBy::Kind::variables:
      case ClusterBy::Kind::type:
        byVariables();
        break;
      case ClusterBy::Kind::function:
        each([&](const MeasurementPool& pool, int i) {
          const std::optional<std::int64_t> key = by_.function_(ClusterItem(problem_, pool, i));
          return key ? add(*key, prefix() + std::to_string(*key)) : -1;
        });
        break;
    }
    return std::move(result_);
  }

 private:
  std::string prefix() const { return (by_.name_.empty() ? "group" : by_.name_) + " "; }

  /// Returns the number of the key, in the order in which keys first occur.
  int add(std::int64_t key, const std::string& name) {
    const auto [place, is_new] = numbers_.try_emplace(key, static_cast<int>(numbers_.size()));
    if (is_new) {
      keys_.push_back(key);
      result_.names.push_back(name);
    }
    return place->second;
  }

  /// Calls f(pool, i) for all measurements. f returns the number of the measurement's group in order of first
  /// occurrence, or -1.
  template <class F>
  void each(const F& f, bool is_sorted = true) {
    result_.way = by_.name_.empty() ? "group" : by_.name_;
    for (const auto& pool : problem_.pools()) {
      std::vector<int>& of = result_.of_pool.emplace_back(at(pool->size()));
      for (int i = 0; i < pool->size(); ++i) {
        of[at(i)] = f(*pool, i);
        result_.ungrouped += of[at(i)] < 0 ? 1 : 0;
      }
    }
    if (is_sorted) sort();
  }

  void sort() {
    std::vector<int> order(keys_.size()), place(keys_.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return keys_[at(a)] < keys_[at(b)]; });
    std::vector<std::string> names;
    for (std::size_t k = 0; k < order.size(); ++k) {
      place[at(order[k])] = static_cast<int>(k);
      names.push_back(std::move(result_.names[at(order[k])]));
    }
    result_.names = std::move(names);
    for (std::vector<int>& of : result_.of_pool) {
      for (int& group : of) group = group < 0 ? -1 : place[at(group)];
    }
  }

  void byDimension() {
    const GroupTable* const groups = problem_.groups();
    const int d = groups == nullptr ? -1 : groups->find(by_.name_);
    if (d < 0) raiseUnknown();
    const std::vector<GroupKey>& keys = groups->keys(d);
    // Number keys are sorted by value. Text keys follow, in the order of their first use.
    std::int64_t largest = std::numeric_limits<std::int64_t>::min();
    for (const GroupKey& key : keys) largest = key.is_text ? largest : std::max(largest, key.number);
    std::vector<int> rank(keys.size());
    std::iota(rank.begin(), rank.end(), 0);
    std::stable_sort(rank.begin(), rank.end(), [&](int a, int b) {
      const GroupKey &x = keys[at(a)], &y = keys[at(b)];
      return x.is_text != y.is_text ? y.is_text : !x.is_text && x.number < y.number;
    });
    std::vector<int> place(keys.size());
    for (std::size_t k = 0; k < rank.size(); ++k) place[at(rank[k])] = static_cast<int>(k);
    std::vector<int> number(keys.size(), -1);
    each([&](const MeasurementPool& pool, int i) {
      const int key = pool.groupKey(d, i);
      if (key < 0) return -1;
      int& own = number[at(key)];
      if (own < 0) own = add(place[at(key)], prefix() + keys[at(key)].name());
      return own;
    });
  }

  void byLabel() {
    std::map<std::string, int> labels;
    each([&](const MeasurementPool& pool, int) {
      if (pool.label().empty()) return -1;
      const int number = labels.try_emplace(pool.label(), static_cast<int>(labels.size())).first->second;
      return add(number, pool.label());
    });
  }

  void byVariables() {
    std::vector<char> is_key(problem_.variables().size(), 0);
    if (by_.kind_ == ClusterBy::Kind::variables) {
      for (const AnyVarID& id : by_.ids_)
        is_key[at(problem_.indexOf(static_cast<const VariableHandle&>(id)))] = 1;
    } else {
      for (std::size_t v = 0; v < is_key.size(); ++v)
        is_key[v] = by_.is_of_type_(problem_.variables()[v].store) ? 1 : 0;
    }
    each([&](const MeasurementPool& pool, int i) {
      int found = -1;
      for (int k = 0; k < pool.arity(); ++k) {
        const int variable = pool.variables(i)[k];
        if (is_key[at(variable)] == 0 || variable == found) continue;
        if (found >= 0) raiseSeveral(pool, i, found, variable);
        found = variable;
      }
      return found < 0 ? -1 : add(found, problem_.variableName(found));
    });
  }

  [[noreturn]] void raiseUnknown() const {
    std::vector<std::string> known;
    const GroupTable* const groups = problem_.groups();
    for (int d = 0; groups != nullptr && d < groups->dimensionCount(); ++d)
      known.push_back(groups->dimension(d).empty() ? "those without a name" : groups->dimension(d));
    const std::string name = by_.name_.empty() ? "without a name" : "of \"" + by_.name_ + "\"";
    throw Error("slom.no-groups",
                "no measurement is in a group " + name +
                    (known.empty() ? "; pass slom::group(key) to insertMeasurement, or group by "
                                     "slom::ClusterBy::variables, label or function"
                                   : "; there are " + listed(known) + ", as in {.by = {\"" +
                                         groups->dimension(0) + "\"}}"),
                by_.name_.empty() ? "groups" : by_.name_);
  }

  [[noreturn]] void raiseSeveral(const MeasurementPool& pool, int i, int a, int b) const {
    throw Error("slom.bad-group",
                "measurement " + pool.measurementName(i) + " depends on " + problem_.variableName(a) +
                    " and on " + problem_.variableName(b) +
                    ", but can be grouped by only one of them; list the variables in "
                    "slom::ClusterBy::variables, or pass slom::group to insertMeasurement",
                pool.measurementName(i));
  }

  const Problem& problem_;
  const ClusterBy& by_;
  Clustering result_;
  std::unordered_map<std::int64_t, int> numbers_;
  std::vector<std::int64_t> keys_;  // by number
};

Clustering makeClustering(const Problem& problem, const ClusterBy& by) {
  return ClusterMaker(problem, by).make();
}

Clustering intersectionOf(const Clustering& a, const Clustering& b) {
  Clustering result;
  result.way = a.way + " and " + b.way;
  std::map<std::pair<int, int>, int> numbers;
  for (std::size_t p = 0; p < a.of_pool.size(); ++p) {
    std::vector<int>& of = result.of_pool.emplace_back(a.of_pool[p].size(), -1);
    for (std::size_t i = 0; i < of.size(); ++i) {
      const std::pair<int, int> key(a.of_pool[p][i], b.of_pool[p][i]);
      if (key.first < 0 || key.second < 0) {
        ++result.ungrouped;
        continue;
      }
      const auto [place, is_new] = numbers.try_emplace(key, result.count());
      if (is_new) result.names.push_back(a.names[at(key.first)] + ", " + b.names[at(key.second)]);
      of[i] = place->second;
    }
  }
  return result;
}

Clustering blocksOf(const Clustering& clustering, int length) {
  if (length == 1) return clustering;
  const int whole = clustering.count() / length, left = clustering.count() % length;
  const int count = std::max(1, whole + (2 * left >= length ? 1 : 0));
  Clustering result;
  result.way = clustering.way;
  result.ungrouped = clustering.ungrouped;
  for (int b = 0; b < count; ++b) {
    const int last = b + 1 == count ? clustering.count() - 1 : (b + 1) * length - 1;
    result.names.push_back(clustering.names[at(b * length)] + " to " + clustering.names[at(last)]);
  }
  for (const std::vector<int>& of : clustering.of_pool) {
    std::vector<int>& blocks = result.of_pool.emplace_back(of);
    for (int& group : blocks) group = group < 0 ? -1 : std::min(group / length, count - 1);
  }
  return result;
}

}  // namespace slom
