/// Measurements whose function is a tape.
#pragma once

#include <memory>
#include <typeindex>
#include <vector>

#include "slom/model/any_var_id.hpp"
#include "slom/problem/problem.hpp"
#include "slom/tape/input.hpp"
#include "slom/tape/tape.hpp"

namespace slom {

/// A tape over variables of certain types: what measurements that are evaluated together have in common.
struct TracedKind : std::enable_shared_from_this<TracedKind> {
  tape::Tape tape;
  std::vector<std::type_index> types;  ///< of the variables
  std::vector<tape::Layout> layouts;   ///< of their coordinates
  std::vector<int> dof;                ///< of the variables
  std::vector<char> is_contiguous;     ///< whether the coordinates of a variable follow one another

  /// Creates a kind. Other code calls `shared`.
  TracedKind(tape::Tape tape, std::vector<std::type_index> types, std::vector<tape::Layout> layouts);

  /// Returns the kind with this tape and these types: the one that exists already, if there is one.
  static std::shared_ptr<const TracedKind> shared(tape::Tape tape, std::vector<std::type_index> types,
                                                  std::vector<tape::Layout> layouts);
  /// Returns the kind that `remember` was called with; null if it no longer exists.
  static std::shared_ptr<const TracedKind> remembered(std::uint64_t fingerprint);
  /// Notes a formula that led to this kind, so that it need not be differentiated again.
  static void remember(std::uint64_t fingerprint, const std::shared_ptr<const TracedKind>& kind);
};

/// A measurement of such a kind: its variables and its data, tape().data() numbers.
struct TracedMeasurement {
  std::shared_ptr<const TracedKind> kind;
  std::vector<VariableView> variables;
  std::vector<double> data;
};

/// Adds the measurement to the problem. Measurements of one kind and label are evaluated as a batch.
MeasID<TracedMeasurement> insertTraced(Problem& problem, TracedMeasurement& measurement,
                                       const NoiseView& noise, std::string_view label, const Loss& loss);

}  // namespace slom
