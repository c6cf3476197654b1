#include "slom/problem/problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Core>

#include "base/index.hpp"
#include "base/words.hpp"
#include "model/runtime_store.hpp"
#include "problem/uses.hpp"
#include "slom/problem/group_table.hpp"

namespace slom {

namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string intervalText(double lower, double upper) {
  return "[" + number(lower, 6) + ", " + number(upper, 6) + "]";
}
}  // namespace

Problem::Problem() : uses_(nullptr), groups_(nullptr) {}
Problem::~Problem() = default;

int Problem::reserveVariable() {
  if (!free_.empty()) return free_.back();
  if (table_.size() == table_.capacity()) table_.reserve(std::max<std::size_t>(64, 2 * table_.size()));
  if (free_.capacity() < table_.capacity()) free_.reserve(table_.capacity());
  active_.reserve(table_.capacity());
  travelled_.reserve(table_.capacity());
  return static_cast<int>(table_.size());
}

void Problem::registerVariable(int index, VariableRecord record, bool optimize) {
  active_.insert(index, optimize);
  record.serial = ++inserted_;
  if (at(index) == table_.size()) {
    table_.push_back(std::move(record));
    travelled_.push_back(0);
  } else {
    free_.pop_back();
    table_[at(index)] = std::move(record);
    travelled_[at(index)] = 0;
  }
  changes_.add({Change::Kind::variable_inserted, index}, size());
  moves_.add(index, size());
}

VariableHandle Problem::insertVariable(std::type_index type, VariableStoreBase* (*make)(), const void* value,
                                       bool optimize, std::string_view name) {
  auto found =
      std::find_if(stores_.begin(), stores_.end(), [&](const TypedStore& own) { return own.type == type; });
  if (found == stores_.end()) {
    stores_.push_back({type, std::shared_ptr<VariableStoreBase>(make())});
    found = stores_.end() - 1;
  }
  return insertInto(found->store, value, optimize, name);
}

VariableHandle Problem::insertVariable(const std::shared_ptr<const RuntimeType>& type, const double* value,
                                       bool optimize, std::string_view name) {
  auto found = std::find_if(stores_.begin(), stores_.end(), [&](const TypedStore& own) {
    return own.type == typeid(RuntimeStore) && static_cast<const RuntimeStore&>(*own.store).type() == type;
  });
  if (found == stores_.end()) {
    stores_.push_back({typeid(RuntimeStore), std::make_shared<RuntimeStore>(type)});
    found = stores_.end() - 1;
  }
  return insertInto(found->store, value, optimize, name);
}

VariableHandle Problem::insertInto(const std::shared_ptr<VariableStoreBase>& store, const void* value,
                                   bool optimize, std::string_view name) {
  const int index = reserveVariable();
  const SlotRef ref = store->insert(value, index);
  registerVariable(index, {store.get(), ref.slot, store->dofOf(value), 0, 0, std::string(name)}, optimize);
  return VariableHandle(store, ref);
}

int Problem::indexOf(const VariableHandle& id) const {
  if (id.store_ == nullptr) detail::raiseStaleHandle("AnyVarID", false);
  return checkedIndex(id.store_.get(), id.ref_, nullptr);
}

VariableHandle Problem::handleOf(int variable) const {
  const VariableRecord& record = table_[at(variable)];
  for (const TypedStore& own : stores_) {
    if (own.store.get() == record.store) return {own.store, own.store->refTo(record.slot)};
  }
  return {};
}

int Problem::checkedIndex(const VariableStoreBase* store, SlotRef ref, std::string (*type)()) const {
  const auto name = [&] { return "VarID<" + (type != nullptr ? type() : store->typeName()) + ">"; };
  for (const TypedStore& own : stores_) {
    if (own.store.get() != store) continue;
    if (store->isCurrent(ref)) return store->variable(ref.slot);
    detail::raiseStaleHandle(name(), true);
  }
  if (store == nullptr) detail::raiseStaleHandle(name(), false);
  for (const TypedStore& own : stores_) {
    for (const StoreOrigin& origin : own.origins) {
      const bool is_from_there = origin.store.lock().get() == store && ref.slot < origin.generations.size() &&
                                 origin.generations[ref.slot] == ref.generation;
      if (!is_from_there) continue;
      if (own.store->isCurrent(ref)) return own.store->variable(ref.slot);
      detail::raiseStaleHandle(name(), true);
    }
  }
  throw Error("slom.foreign-handle",
              "the " + name() +
                  " belongs to another estimator; use it only with the "
                  "estimator whose insertRV returned it",
              name());
}

void Problem::setValue(int variable, const void* value) {
  const VariableRecord& record = table_[at(variable)];
  const int dof = record.store->dofOf(value);
  if (record.dof != dof) {
    throw Error("slom.size-change",
                "variable " + variableName(variable) + " has " + std::to_string(record.dof) +
                    " degrees of freedom, the new value has " + std::to_string(dof) +
                    "; insert a new variable instead",
                variableName(variable));
  }
  checkBounds(variable, active_.bounds(variable), value);
  overwrite(variable, value);
}

void Problem::overwrite(int variable, const void* value) {
  const VariableRecord& record = table_[at(variable)];
  const double distance = distanceTo(variable, value);
  record.store->assign(record.store->valueAt(record.slot), value);
  travelled_[at(variable)] += distance;
  moves_.add(variable, size());
}

/// Returns the largest component of value [-] the variable; infinite if that is not a number.
double Problem::distanceTo(int variable, const void* value) const {
  const VariableRecord& record = table_[at(variable)];
  double most = 0;
  try {
    Eigen::VectorXd difference(record.dof);
    record.store->boxminus(difference.data(), value, record.store->valueAt(record.slot));
    for (const double d : difference) most = std::max(most, std::isnan(d) ? kInfinity : std::abs(d));
  } catch (...) {  // the user's own [-] may throw for some values
    most = kInfinity;
  }
  return most;
}

void Problem::checkBounds(int variable, const std::vector<ComponentBound>& bounds, const void* value) const {
  const VariableRecord& record = table_[at(variable)];
  if (bounds.empty()) return;
  std::vector<double> x(at(record.dof));
  record.store->coordinates(value, x.data());
  for (const ComponentBound& bound : bounds) {
    const double own = x[at(bound.component)], margin = 1e-12 * std::abs(own);  // for rounding of steps
    if (own >= bound.lower - margin && own <= bound.upper + margin) continue;
    throw Error("slom.outside-bound",
                componentNames(variable)[at(bound.component)] + " is " + number(own, 6) +
                    ", outside of its bound " + intervalText(bound.lower, bound.upper) +
                    "; give it a value inside, or another bound",
                componentNames(variable)[at(bound.component)]);
  }
}

std::vector<int> Problem::componentsAt(int variable, const std::string& path) const {
  const VariableRecord& record = table_[at(variable)];
  const std::vector<std::string> names = record.store->componentNames(record.slot, "");
  if (path.empty() && names.size() == 1) return {0};
  std::vector<int> found;
  for (std::size_t c = 0; c < names.size(); ++c) {
    if (names[c] == path || names[c].rfind(path + ".", 0) == 0) found.push_back(static_cast<int>(c));
  }
  if (!found.empty() && (names.size() == 1 || !path.empty())) return found;
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  throw Error("slom.no-component",
              "variable " + variableName(variable) + " has no component \"" + path + "\"; pass " +
                  (names.size() == 1 && names[0].empty() ? "\"\" for its only one" : "one of " + all),
              variableName(variable));
}

void Problem::setFixed(int variable, const std::vector<int>& components, bool is_fixed) {
  std::vector<char> fixed = active_.fixed(variable);
  fixed.resize(at(table_[at(variable)].dof), 0);
  for (const int c : components) fixed[at(c)] = is_fixed ? 1 : 0;
  active_.setFixed(variable, std::move(fixed));
  registerConstraint(variable);
}

void Problem::setBound(int variable, const std::vector<int>& components, double lower, double upper) {
  const VariableRecord& record = table_[at(variable)];
  if (!(lower <= upper) || lower == kInfinity || upper == -kInfinity) {
    throw Error(
        "slom.bad-bound",
        "the bound of " + componentNames(variable)[at(components.front())] + " is " +
            intervalText(lower, upper) +
            (lower <= upper ? ", which holds no finite number; pass -infinity and infinity to remove a bound"
                            : "; pass a lower limit that is not above the upper one"),
        componentNames(variable)[at(components.front())]);
  }
  std::vector<double> x(at(record.dof));
  record.store->coordinates(record.store->valueAt(record.slot), x.data());
  std::vector<ComponentBound> bounds = active_.bounds(variable);
  for (const int c : components) {
    if (std::isnan(x[at(c)])) {
      throw Error("slom.bad-bound",
                  componentNames(variable)[at(c)] +
                      " has no coordinate that can be bounded: it is part of a rotation or the like; bound "
                      "components of vectors, or add a prior",
                  componentNames(variable)[at(c)]);
    }
  }
  std::vector<char> is_new(at(record.dof), 0);
  for (const int c : components) is_new[at(c)] = 1;
  std::erase_if(bounds, [&](const ComponentBound& bound) { return is_new[at(bound.component)] != 0; });
  if (std::isfinite(lower) || std::isfinite(upper)) {
    for (const int c : components) bounds.push_back({c, lower, upper});
  }
  std::sort(bounds.begin(), bounds.end(),
            [](const auto& a, const auto& b) { return a.component < b.component; });
  checkBounds(variable, bounds, record.store->valueAt(record.slot));
  active_.setBounds(variable, std::move(bounds));
  registerConstraint(variable);
}

void Problem::registerConstraint(int variable) {
  changes_.add({Change::Kind::constraint, variable}, size());
  moves_.add(variable, size());
}

int Problem::freeCount() const {
  if (counted_at_ == structureRevision()) return free_count_;
  int count = -active_.fixedCount();
  for (std::size_t v = 0; v < table_.size(); ++v) {
    if (table_[v].store != nullptr && active_.isOptimized(static_cast<int>(v))) count += table_[v].dof;
  }
  counted_at_ = structureRevision();
  return free_count_ = count;
}

void Problem::setOptimized(int variable, bool optimize) {
  if (active_.isOptimized(variable) == optimize) return;
  active_.setOptimized(variable, optimize);
  changes_.add({optimize ? Change::Kind::variable_freed : Change::Kind::variable_fixed, variable}, size());
}

void Problem::removeVariable(int variable) {
  VariableRecord& record = table_[at(variable)];
  if (record.uses > 0) {
    throw Error("slom.variable-in-use",
                "variable " + variableName(variable) + " cannot be removed: " + std::to_string(record.uses) +
                    (record.uses == 1 ? " measurement depends" : " measurements depend") + " on it; remove " +
                    (record.uses == 1 ? "it" : "them") + " first",
                variableName(variable));
  }
  record.store->release(record.slot);
  record = VariableRecord{};
  active_.remove(variable);
  if (uses_) uses_->at(variable) = {};
  free_.push_back(variable);
  changes_.add({Change::Kind::variable_removed, variable}, size());
}

std::vector<std::shared_ptr<const VariableStoreBase>> Problem::stores() const {
  std::vector<std::shared_ptr<const VariableStoreBase>> all;
  for (const TypedStore& own : stores_) all.push_back(own.store);
  return all;
}

std::string Problem::variableName(int variable) const {
  const VariableRecord& record = table_[at(variable)];
  if (!record.name.empty()) return record.name;
  return record.store->typeName() + " #" + std::to_string(record.serial);
}

std::string Problem::variableValue(int variable) const {
  const VariableRecord& record = table_[at(variable)];
  return record.store->valueText(record.slot);
}

std::vector<std::string> Problem::componentNames(int variable) const {
  const VariableRecord& record = table_[at(variable)];
  return record.store->componentNames(record.slot, variableName(variable));
}

std::string Problem::valuesText(const int* variables, int arity) const {
  std::string text;
  for (int k = 0; k < arity; ++k) {
    text += (k > 0 ? ", " : "") + variableName(variables[k]) + " = (" + variableValue(variables[k]) + ")";
  }
  return text;
}

double Problem::largestStatedStep() const {
  double largest = 0;
  for (const auto& pool : pools_) largest = std::max(largest, pool->statedStep());
  return largest;
}

bool Problem::hasNumericDerivatives() const {
  return std::any_of(pools_.begin(), pools_.end(),
                     [](const auto& pool) { return pool->derivatives() == DerivativeSource::numeric; });
}

}  // namespace slom
