// Components that are coordinates, on which a prior on a part of a variable can be placed.
#include <algorithm>
#include <cmath>
#include <new>
#include <vector>

#include "base/index.hpp"
#include "base/words.hpp"
#include "slom/problem/problem.hpp"

namespace slom {

namespace {

/// A movable value of a variable's type.
class MovedValue {
 public:
  explicit MovedValue(const VariableRecord& record)
      : store_(*record.store),
        alignment_(std::align_val_t(store_.alignment())),
        place_(::operator new(store_.valueSize(), alignment_)) {
    try {
      store_.construct(place_, store_.valueAt(record.slot));
    } catch (...) {
      ::operator delete(place_, alignment_);
      throw;
    }
  }
  MovedValue(const MovedValue&) = delete;
  MovedValue& operator=(const MovedValue&) = delete;
  ~MovedValue() {
    store_.destroy(place_);
    ::operator delete(place_, alignment_);
  }

  void move(const std::vector<double>& d) { store_.boxplus(place_, d.data()); }
  double coordinate(int component, int dof) const {
    std::vector<double> x(at(dof));
    store_.coordinates(place_, x.data());
    return x[at(component)];
  }

 private:
  VariableStoreBase& store_;
  std::align_val_t alignment_;
  void* place_;
};

/// Returns whether [+] adds to the coordinate of this component. Tries a long step, which reveals a number with its own
/// [+], such as one that multiplies.
bool isAddedTo(const VariableRecord& record, int component) {
  MovedValue value(record);
  const double before = value.coordinate(component, record.dof);
  const double step = 0.5 * std::max(1.0, std::abs(before));
  std::vector<double> d(at(record.dof), 0.0);
  d[at(component)] = step;
  value.move(d);
  return std::abs(value.coordinate(component, record.dof) - before - step) <= 1e-9 * step;
}

}  // namespace

std::vector<int> Problem::coordinatesAt(int variable, const std::string& path, const double* values,
                                        std::size_t count) const {
  const VariableRecord& record = table_[at(variable)];
  std::vector<int> components = componentsAt(variable, path);
  const std::vector<std::string> names = componentNames(variable);
  if (components.size() != count) {
    throw Error("slom.wrong-length",
                "the prior on \"" + path + "\" of variable " + variableName(variable) + " has " +
                    counted(static_cast<int>(count), "value") + ", the path names " +
                    counted(static_cast<int>(components.size()), "component") + "; pass one value for each",
                variableName(variable));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::string& name = names[at(components[i])];
    if (!isAddedTo(record, components[i])) {
      throw Error(
          "slom.no-component",
          name +
              " is part of a rotation or the like, not a coordinate that [+] adds to; pass prior a value of "
              "the whole variable, or pass insertMeasurement a function that returns the part",
          name);
    }
    if (!std::isfinite(values[i])) {
      throw Error(
          "slom.prior-not-finite",
          "the value of the prior on " + name + " is " + number(values[i], 6) + "; pass a finite number",
          name);
    }
  }
  return components;
}

}  // namespace slom
