#include <algorithm>
#include <mutex>
#include <unordered_map>

#include "slom/tape/measurement.hpp"

namespace slom {

namespace {

/// The kinds that exist.
struct KindsOfTapes {
  std::mutex mutex;
  std::unordered_multimap<std::uint64_t, std::weak_ptr<const TracedKind>> by_hash;
  std::size_t room = 64;  ///< number of kinds in by_hash after which those that no longer exist are forgotten
  std::unordered_map<std::uint64_t, std::weak_ptr<const TracedKind>> by_fingerprint;

  static KindsOfTapes& all() {
    static KindsOfTapes* const kinds = new KindsOfTapes;  // kinds may outlive static objects
    return *kinds;
  }
};

}  // namespace

TracedKind::TracedKind(tape::Tape own_tape, std::vector<std::type_index> own_types,
                       std::vector<tape::Layout> own_layouts)
    : tape(std::move(own_tape)), types(std::move(own_types)), layouts(std::move(own_layouts)) {
  for (const tape::VariableType& type : tape.code().variables) dof.push_back(type.dof());
  for (const tape::Layout& layout : layouts) {
    bool contiguous = true;
    for (std::size_t i = 1; i < layout.size(); ++i)
      contiguous = contiguous && layout[i] == layout[i - 1] + sizeof(double);
    is_contiguous.push_back(contiguous ? 1 : 0);
  }
}

std::shared_ptr<const TracedKind> TracedKind::shared(tape::Tape tape, std::vector<std::type_index> types,
                                                     std::vector<tape::Layout> layouts) {
  KindsOfTapes& kinds = KindsOfTapes::all();
  const std::lock_guard lock(kinds.mutex);
  const auto [first, last] = kinds.by_hash.equal_range(tape.hash());
  for (auto known = first; known != last;) {
    const std::shared_ptr<const TracedKind> kind = known->second.lock();
    if (kind == nullptr) {
      known = kinds.by_hash.erase(known);
      continue;
    }
    if (kind->tape == tape && kind->types == types && kind->layouts == layouts) return kind;
    ++known;
  }
  if (kinds.by_hash.size() >= kinds.room) {
    std::erase_if(kinds.by_hash, [](const auto& known) { return known.second.expired(); });
    kinds.room = 2 * kinds.by_hash.size() + 64;
  }
  const std::uint64_t hash = tape.hash();
  auto kind = std::make_shared<const TracedKind>(std::move(tape), std::move(types), std::move(layouts));
  kinds.by_hash.emplace(hash, kind);
  return kind;
}

std::shared_ptr<const TracedKind> TracedKind::remembered(std::uint64_t fingerprint) {
  KindsOfTapes& kinds = KindsOfTapes::all();
  const std::lock_guard lock(kinds.mutex);
  const auto found = kinds.by_fingerprint.find(fingerprint);
  return found == kinds.by_fingerprint.end() ? nullptr : found->second.lock();
}

void TracedKind::remember(std::uint64_t fingerprint, const std::shared_ptr<const TracedKind>& kind) {
  constexpr std::size_t most = 4096;
  KindsOfTapes& kinds = KindsOfTapes::all();
  const std::lock_guard lock(kinds.mutex);
  if (kinds.by_fingerprint.size() >= most)
    std::erase_if(kinds.by_fingerprint, [](const auto& known) { return known.second.expired(); });
  kinds.by_fingerprint[fingerprint] = kind;
}

}  // namespace slom
