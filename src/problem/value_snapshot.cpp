#include "problem/value_snapshot.hpp"

#include <algorithm>
#include <new>

namespace slom {

struct ValueSnapshot::Copy {
  Copy(VariableStoreBase& of, std::uint32_t slot_, int variable_)
      : store(of),
        slot(slot_),
        variable(variable_),
        place(::operator new(of.valueSize(), std::align_val_t(of.alignment()))) {
    store.construct(place, store.valueAt(slot));
  }
  ~Copy() {
    store.destroy(place);
    ::operator delete(place, std::align_val_t(store.alignment()));
  }
  VariableStoreBase& store;
  std::uint32_t slot;
  int variable;
  void* place;
};

ValueSnapshot::ValueSnapshot(Problem& problem) : problem_(problem) {
  for (int v = 0; v < static_cast<int>(problem.variables().size()); ++v) copy(v);
}
ValueSnapshot::ValueSnapshot(Problem& problem, std::initializer_list<int> variables) : problem_(problem) {
  for (const int v : variables) keep(v);
}

void ValueSnapshot::keep(int variable) {
  if (kept_.insert(variable).second) copy(variable);
}
std::unique_ptr<ValueSnapshot> ValueSnapshot::takeAgain() const {
  auto now = std::make_unique<ValueSnapshot>(problem_, std::initializer_list<int>{});
  for (const int v : kept_) now->keep(v);
  return now;
}
void ValueSnapshot::copy(int variable) {
  const VariableRecord& record = problem_.variables()[static_cast<std::size_t>(variable)];
  if (record.store != nullptr)
    copies_.push_back(std::make_unique<Copy>(*record.store, record.slot, variable));
}
ValueSnapshot::~ValueSnapshot() = default;

void ValueSnapshot::difference(int variable, double* d) const {
  const auto found = std::lower_bound(copies_.begin(), copies_.end(), variable,
                                      [](const auto& copy, int v) { return copy->variable < v; });
  const VariableRecord& record = problem_.variables()[static_cast<std::size_t>(variable)];
  record.store->boxminus(d, record.store->valueAt(record.slot), (*found)->place);
}

void ValueSnapshot::restore() {
  for (const auto& copy : copies_) problem_.overwrite(copy->variable, copy->place);
}

}  // namespace slom
