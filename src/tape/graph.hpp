/// The graph of a recorded formula. Nodes refer to earlier nodes only. Equal nodes exist once; what can be simplified
/// is simplified when a node is made.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "slom/tape/number.hpp"

namespace slom::tape {

using Id = std::uint32_t;

struct Node {
  Operation operation = Operation::constant;
  Id a = 0, b = 0, c = 0;  ///< operands; a of a coordinate, datum or tangent: its number
  double value = 0;        ///< of a constant; conditions are 1 or 0
  std::uint32_t place = 0;
};

/// Returns the number of operands.
int operandsOf(Operation operation);
/// Returns whether the result is a condition.
bool isComparison(Operation operation);
/// Returns the value of an operation on numbers; conditions are 1 or 0.
double evaluate(Operation operation, double a, double b, double c);

class Graph {
 public:
  Graph();

  const Node& operator[](Id id) const { return nodes_[id]; }
  Id size() const { return static_cast<Id>(nodes_.size()); }
  bool isConstant(Id id) const { return nodes_[id].operation == Operation::constant; }
  bool isConstant(Id id, double value) const { return isConstant(id) && nodes_[id].value == value; }
  /// Returns whether the number is finite if all coordinates and data are, apart from overflow.
  bool isTame(Id id) const { return tame_[id] != 0; }

  Id constant(double value);
  /// Returns a coordinate, datum or tangent.
  Id leaf(Operation operation, Id number);
  /// Returns the result of an operation, simplified.
  Id make(Operation operation, Id a, Id b = 0, Id c = 0);
  Id add(Id a, Id b) { return make(Operation::add, a, b); }
  Id subtract(Id a, Id b) { return make(Operation::subtract, a, b); }
  Id multiply(Id a, Id b) { return make(Operation::multiply, a, b); }
  Id negate(Id a) { return make(Operation::negate, a); }
  Id reciprocal(Id a) { return make(Operation::reciprocal, a); }
  Id divide(Id a, Id b) { return make(Operation::divide, a, b); }
  Id select(Id condition, Id a, Id b) { return make(Operation::select, condition, a, b); }

  /// Sets the place of the nodes that are made next; 0: unknown.
  void setPlace(std::uint32_t place) { place_ = place; }

 private:
  struct Key {
    Operation operation;
    Id a, b, c;
    std::uint64_t bits;
    bool operator==(const Key&) const = default;
  };
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };
  Id append(const Node& node);
  /// Returns a simpler node that equals the operation; kNone if there is none.
  Id simplified(Operation operation, Id a, Id b, Id c);
  Id simplifiedSum(Id a, Id b);
  Id simplifiedDifference(Id a, Id b);
  Id simplifiedProduct(Id a, Id b);
  Id simplifiedQuotient(Id a, Id b);
  Id simplifiedNegation(Id a);
  Id simplifiedSelection(Id condition, Id a, Id b);
  bool is(Id id, Operation operation) const { return nodes_[id].operation == operation; }

  static constexpr Id kNone = ~Id{0};
  std::vector<Node> nodes_;
  std::vector<char> tame_;
  std::unordered_map<Key, Id, Hash> known_;
  std::uint32_t place_ = 0;
};

/// Returns for each node how often the outputs and the nodes that they need use it; 0: not needed.
std::vector<int> usesOf(const Graph& graph, const std::vector<Id>& outputs);

}  // namespace slom::tape
