#include "distributed/ownership.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "distributed/index.hpp"
#include "distributed/messages.hpp"

namespace slom::distributed {

namespace {

/// Two sums over the numbers of a value, which differ if the values do.
struct Fingerprint {
  double sum = 0, size = 0;

  void add(double number) {
    if (!std::isfinite(number)) return;  // a component without a coordinate
    const double weighted = (1 + std::sqrt(2.0) * ++count_) * number;
    sum += weighted;
    size += std::abs(weighted);
  }
  /// Returns whether both are of one value, up to rounding.
  bool agrees(const Fingerprint& other) const {
    constexpr double rounding = 1e-9;
    return std::abs(sum - other.sum) <= rounding * (size + other.size);
  }

 private:
  int count_ = 0;
};

/// Adds rotations and directions to a fingerprint.
class OrientationNumbers final : public OrientationSink {
 public:
  explicit OrientationNumbers(Fingerprint& fingerprint) : fingerprint_(fingerprint) {}
  void take(Kind kind, int, const double* numbers) override {
    for (int i = 0; i < (kind == Kind::angle ? 1 : 3); ++i) fingerprint_.add(numbers[i]);
  }

 private:
  Fingerprint& fingerprint_;
};

Fingerprint fingerprintOf(const VariableRecord& record) {
  Fingerprint fingerprint;
  const void* const value = record.store->valueAt(record.slot);
  std::vector<double> coordinates(at(record.dof));
  record.store->coordinates(value, coordinates.data());
  for (const double x : coordinates) fingerprint.add(x);
  OrientationNumbers orientations(fingerprint);
  record.store->visitOrientations(value, orientations);
  return fingerprint;
}

/// The claim of a process on a shared variable.
struct Claim {
  std::uint64_t name = 0;
  int dof = 0;   ///< unknowns here; 0: it is fixed, or no measurement here depends on it
  int size = 0;  ///< degrees of freedom of its type
  char is_optimized = 0, is_home = 0;
  Fingerprint value;
};

/// The decision about a shared variable.
struct Decision {
  int owner = -1;  ///< -1: nobody has measurements of it
  int fault = 0;   ///< 1: different sizes; 2: fixed in some processes alone; 3: different values
};

/// Returns the process that decides about a name.
int processFor(std::uint64_t name, int processes) {
  name ^= name >> 33;
  name *= 0xff51afd7ed558ccdULL;
  name ^= name >> 33;
  return int(name % std::uint64_t(processes));
}

/// Decides about the variables whose claims have arrived, process by process. Returns the decision for each claim.
std::vector<std::vector<Decision>> decide(const std::vector<std::vector<Claim>>& claims) {
  struct Known {
    Claim first;
    Decision decision;
    bool has_home = false;
  };
  std::unordered_map<std::uint64_t, Known> known;
  for (int p = 0; p < int(claims.size()); ++p) {
    for (const Claim& claim : claims[at(p)]) {
      Known& now = known.try_emplace(claim.name, Known{claim, {}, false}).first->second;
      if (claim.size != now.first.size) now.decision.fault = 1;
      if (claim.is_optimized != now.first.is_optimized) now.decision.fault = 2;
      if (now.decision.fault == 0 && !claim.value.agrees(now.first.value)) now.decision.fault = 3;
      if (claim.dof == 0 || (now.decision.owner >= 0 && (now.has_home || claim.is_home == 0))) continue;
      now.decision.owner = p;
      now.has_home = claim.is_home != 0;
    }
  }
  std::vector<std::vector<Decision>> decisions(claims.size());
  for (std::size_t p = 0; p < claims.size(); ++p) {
    for (const Claim& claim : claims[p]) decisions[p].push_back(known.at(claim.name).decision);
  }
  return decisions;
}

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw Error("slom.bad-share", "the shared variable " + name + " " + what, name);
}

[[noreturn]] void refuse(const Problem& problem, int variable, int fault) {
  const std::string name = problem.variableName(variable);
  switch (fault) {
    case 1:
      refuse(
          name,
          "has different numbers of degrees of freedom in different processes; insert it with the same type");
    case 2:
      refuse(name, "is fixed in some processes and free in others; fix it in all");
    default:
      refuse(name, "has the value " + problem.variableValue(variable) +
                       " here and another one in another process; give it the same start value in all");
  }
}

/// Returns the unknowns of these blocks of a vector, one after another.
void appendOf(const Eigen::VectorXd& x, const std::vector<int>& blocks, const std::vector<int>& offset,
              std::vector<double>& values) {
  for (const int b : blocks) {
    for (int i = offset[at(b)]; i < offset[at(b) + 1]; ++i) values.push_back(x[i]);
  }
}

}  // namespace

void Ownership::find(const Processes& processes, const Problem& problem, const BlockStructure& structure,
                     const SharedVariables& shared) {
  offset_ = structure.offset;
  const auto P = std::size_t(processes.size());
  owner_.assign(at(structure.blockCount()), -1);
  is_shared_.assign(at(structure.blockCount()), 0);
  held_.assign(P, {});
  served_.assign(P, {});
  std::vector<std::vector<Claim>> claims(P);
  std::vector<std::vector<SharedVariables::Entry>> asked(P);
  std::unordered_map<std::uint64_t, int> block_of;
  std::vector<char> is_named(at(structure.blockCount()), 0);
  processes.agree([&] {
    for (const SharedVariables::Entry& entry : shared.entries()) {
      const int v = entry.variable;
      const std::string name = problem.variableName(v);
      const auto [known, is_new] = block_of.try_emplace(entry.name, v);
      if (!is_new && known->second != v)
        refuse(name,
               "has a name that this process has given to another one, too; give each variable its own name");
      if (!is_new) continue;  // shared twice, such as the first and last variable of a loop
      if (std::exchange(is_named[at(v)], char(1)) != 0)
        refuse(name, "has two names in this process; give it the name that it has in the other processes");
      if (!problem.activeSet().bounds(v).empty())
        refuse(name, "has bounds; remove them, or let one process have the variable");
      const auto p = at(processFor(entry.name, processes.size()));
      claims[p].push_back({entry.name, structure.dof(v), problem.variables()[at(v)].dof,
                           char(problem.activeSet().isOptimized(v)), char(entry.is_home),
                           fingerprintOf(problem.variables()[at(v)])});
      asked[p].push_back(entry);
    }
  });
  const auto decisions = exchanged(processes, decide(exchanged(processes, claims)));
  std::vector<std::vector<std::uint64_t>> wanted(P);
  processes.agree([&] {
    for (std::size_t p = 0; p < P; ++p) {
      for (std::size_t i = 0; i < asked[p].size(); ++i) {
        const Decision& decision = decisions[p][i];
        const int v = asked[p][i].variable;
        if (decision.fault != 0) refuse(problem, v, decision.fault);
        if (structure.isEmpty(v)) continue;
        is_shared_[at(v)] = 1;
        if (decision.owner == processes.rank()) continue;
        owner_[at(v)] = decision.owner;
        held_[at(decision.owner)].push_back(v);
        wanted[at(decision.owner)].push_back(asked[p][i].name);
      }
    }
  });
  const auto names = exchanged(processes, wanted);
  for (std::size_t p = 0; p < P; ++p) {
    for (const std::uint64_t name : names[p]) served_[p].push_back(block_of.at(name));
  }
  const auto unknownsOf = [&](const std::vector<std::vector<int>>& blocks) {
    std::vector<std::size_t> counts(P, 0);
    for (std::size_t p = 0; p < P; ++p) {
      for (const int b : blocks[p]) counts[p] += at(structure.dof(b));
    }
    return counts;
  };
  held_unknowns_ = unknownsOf(held_);
  served_unknowns_ = unknownsOf(served_);
}

void Ownership::addUp(const Processes& processes, const std::vector<Eigen::VectorXd*>& per_unknown) const {
  addUpAtOwners(processes, per_unknown);
  for (Eigen::VectorXd* const x : per_unknown) spread(processes, *x);
}

void Ownership::addUpAtOwners(const Processes& processes,
                              const std::vector<Eigen::VectorXd*>& per_unknown) const {
  if (processes.isAlone()) return;
  std::vector<std::vector<double>> sent(held_.size());
  for (std::size_t p = 0; p < held_.size(); ++p) {
    for (const Eigen::VectorXd* const x : per_unknown) appendOf(*x, held_[p], offset_, sent[p]);
  }
  std::vector<std::size_t> counts = served_unknowns_;
  for (std::size_t& count : counts) count *= per_unknown.size();
  const auto received = exchanged(processes, std::move(sent), std::move(counts));
  for (std::size_t p = 0; p < served_.size(); ++p) {
    const double* value = received[p].data();
    for (Eigen::VectorXd* const x : per_unknown) {
      for (const int b : served_[p]) {
        for (int i = offset_[at(b)]; i < offset_[at(b) + 1]; ++i) (*x)[i] += *value++;
      }
    }
  }
}

void Ownership::spread(const Processes& processes, Eigen::VectorXd& x) const {
  if (processes.isAlone()) return;
  std::vector<std::vector<double>> sent(served_.size());
  for (std::size_t p = 0; p < served_.size(); ++p) appendOf(x, served_[p], offset_, sent[p]);
  const auto received = exchanged(processes, std::move(sent), held_unknowns_);
  for (std::size_t p = 0; p < held_.size(); ++p) {
    const double* value = received[p].data();
    for (const int b : held_[p]) {
      for (int i = offset_[at(b)]; i < offset_[at(b) + 1]; ++i) x[i] = *value++;
    }
  }
}

void Ownership::spread(const Processes& processes, std::vector<std::int64_t>& of_block) const {
  if (processes.isAlone()) return;
  std::vector<std::vector<std::int64_t>> sent(served_.size());
  for (std::size_t p = 0; p < served_.size(); ++p) {
    for (const int b : served_[p]) sent[p].push_back(of_block[at(b)]);
  }
  const auto received = exchanged(processes, sent);
  for (std::size_t p = 0; p < held_.size(); ++p) {
    for (std::size_t i = 0; i < held_[p].size(); ++i) of_block[at(held_[p][i])] = received[p][i];
  }
}

}  // namespace slom::distributed
