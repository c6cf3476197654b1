#include "tape/graph.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "mtk/types/so2.hpp"

namespace slom::tape {

int operandsOf(Operation operation) {
  switch (operation) {
    case Operation::constant:
    case Operation::coordinate:
    case Operation::datum:
    case Operation::tangent:
      return 0;
    case Operation::add:
    case Operation::subtract:
    case Operation::multiply:
    case Operation::divide:
    case Operation::scale:
    case Operation::inverse_arc:
    case Operation::atan2:
    case Operation::hypot:
    case Operation::pow:
    case Operation::less:
    case Operation::less_equal:
    case Operation::equal:
    case Operation::both:
    case Operation::either:
      return 2;
    case Operation::select:
      return 3;
    default:
      return 1;
  }
}

bool isComparison(Operation operation) {
  return operation >= Operation::less && operation <= Operation::opposite;
}

namespace {

double inverseArc(double a, double b) {
  const double square = a * a + b * b;
  if (square > 1e-30 && square < 1e30) return a * (1 / square);
  const double largest = std::max(std::abs(a), std::abs(b)), size = largest > 0 ? largest : 1;
  const double u = a / size, v = b / size, norm = (u * u + v * v) * size;
  return norm > 0 ? u * std::min(1 / norm, std::numeric_limits<double>::max()) : 0;
}

}  // namespace

double evaluate(Operation operation, double a, double b, double c) {
  switch (operation) {
    case Operation::add:
      return a + b;
    case Operation::subtract:
      return a - b;
    case Operation::multiply:
      return a * b;
    case Operation::negate:
      return -a;
    case Operation::divide:
      return a / b;
    case Operation::reciprocal:
      return 1 / a;
    case Operation::scale:
      return b == 0 ? 0 : a * b;
    case Operation::inverse_arc:
      return inverseArc(a, b);
    case Operation::sign:
      return a < 0 ? -1 : a > 0 ? 1 : 0;
    case Operation::abs:
      return std::abs(a);
    case Operation::floor:
      return std::floor(a);
    case Operation::wrap:
      return mtk::detail::wrapAngle(a);
    case Operation::sqrt:
      return std::sqrt(a);
    case Operation::sin:
      return std::sin(a);
    case Operation::cos:
      return std::cos(a);
    case Operation::tan:
      return std::tan(a);
    case Operation::asin:
      return std::asin(a);
    case Operation::acos:
      return std::acos(a);
    case Operation::atan:
      return std::atan(a);
    case Operation::sinh:
      return std::sinh(a);
    case Operation::cosh:
      return std::cosh(a);
    case Operation::tanh:
      return std::tanh(a);
    case Operation::asinh:
      return std::asinh(a);
    case Operation::acosh:
      return std::acosh(a);
    case Operation::atanh:
      return std::atanh(a);
    case Operation::exp:
      return std::exp(a);
    case Operation::expm1:
      return std::expm1(a);
    case Operation::log:
      return std::log(a);
    case Operation::log1p:
      return std::log1p(a);
    case Operation::cbrt:
      return std::cbrt(a);
    case Operation::erf:
      return std::erf(a);
    case Operation::erfc:
      return std::erfc(a);
    case Operation::atan2:
      return std::atan2(a, b);
    case Operation::hypot:
      return std::hypot(a, b);
    case Operation::pow:
      return std::pow(a, b);
    case Operation::less:
      return a < b ? 1 : 0;
    case Operation::less_equal:
      return a <= b ? 1 : 0;
    case Operation::equal:
      return a == b ? 1 : 0;
    case Operation::both:
      return a != 0 && b != 0 ? 1 : 0;
    case Operation::either:
      return a != 0 || b != 0 ? 1 : 0;
    case Operation::opposite:
      return a != 0 ? 0 : 1;
    case Operation::select:
      return a != 0 ? b : c;
    case Operation::constant:
    case Operation::coordinate:
    case Operation::datum:
    case Operation::tangent:
      break;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::size_t Graph::Hash::operator()(const Key& key) const {
  std::uint64_t h = static_cast<std::uint64_t>(key.operation) * 0x9E3779B97F4A7C15u;
  for (const std::uint64_t x : {std::uint64_t{key.a}, std::uint64_t{key.b}, std::uint64_t{key.c}, key.bits})
    h = (std::rotl(h, 25) ^ x) * 0x9E3779B97F4A7C15u;
  return static_cast<std::size_t>(h ^ (h >> 32));
}

Graph::Graph() {
  nodes_.reserve(256);
  constant(0);
}

Id Graph::append(const Node& node) {
  const Key key{node.operation, node.a, node.b, node.c, std::bit_cast<std::uint64_t>(node.value)};
  const auto [place, is_new] = known_.try_emplace(key, size());
  if (!is_new) return place->second;
  nodes_.push_back(node);
  nodes_.back().place = place_;
  const auto is_tame = [&](Id id) { return tame_[id] != 0; };
  bool tame = false;
  switch (node.operation) {
    case Operation::constant:
      tame = std::isfinite(node.value);
      break;
    case Operation::coordinate:
    case Operation::datum:
    case Operation::sign:
      tame = true;
      break;
    case Operation::add:
    case Operation::subtract:
    case Operation::multiply:
      tame = is_tame(node.a) && is_tame(node.b);
      break;
    case Operation::negate:
    case Operation::abs:
    case Operation::floor:
    case Operation::wrap:
    case Operation::sin:
    case Operation::cos:
    case Operation::atan:
    case Operation::tanh:
      tame = is_tame(node.a);
      break;
    case Operation::select:
      tame = is_tame(node.b) && is_tame(node.c);
      break;
    default:
      tame = false;
  }
  tame_.push_back(tame ? 1 : 0);
  return place->second;
}

Id Graph::constant(double value) {
  return append({Operation::constant, 0, 0, 0, value == 0 ? 0.0 : value, 0});
}
Id Graph::leaf(Operation operation, Id number) { return append({operation, number, 0, 0, 0, 0}); }

Id Graph::make(Operation operation, Id a, Id b, Id c) {
  const int count = operandsOf(operation);
  const bool is_known = isConstant(a) && (count < 2 || isConstant(b)) && (count < 3 || isConstant(c));
  if (is_known) {
    return constant(tape::evaluate(operation, nodes_[a].value, count > 1 ? nodes_[b].value : 0,
                                   count > 2 ? nodes_[c].value : 0));
  }
  if (const Id simple = simplified(operation, a, b, c); simple != kNone) return simple;
  const bool commutes = operation == Operation::add || operation == Operation::multiply ||
                        operation == Operation::equal || operation == Operation::both ||
                        operation == Operation::either || operation == Operation::hypot;
  const auto comes_first = [&](Id x, Id y) { return isConstant(x) != isConstant(y) ? isConstant(x) : x < y; };
  if (commutes && comes_first(b, a)) std::swap(a, b);  // constants first
  return append({operation, a, count > 1 ? b : 0, count > 2 ? c : 0, 0, 0});
}

Id Graph::simplified(Operation operation, Id a, Id b, Id c) {
  switch (operation) {
    case Operation::add:
      return simplifiedSum(a, b);
    case Operation::subtract:
      return simplifiedDifference(a, b);
    case Operation::multiply:
      return simplifiedProduct(a, b);
    case Operation::negate:
      return simplifiedNegation(a);
    case Operation::divide:
      return simplifiedQuotient(a, b);
    case Operation::reciprocal:
      return is(a, Operation::negate) ? negate(reciprocal(nodes_[a].a)) : kNone;
    case Operation::scale:  // a number that is not 0 needs no guard
      return isConstant(b) ? multiply(a, b) : isConstant(a, 0) ? a : kNone;
    case Operation::abs:
      return is(a, Operation::negate) ? make(Operation::abs, nodes_[a].a) : is(a, Operation::abs) ? a : kNone;
    case Operation::wrap:
      return is(a, Operation::wrap) ? a : kNone;
    case Operation::sin:
      return is(a, Operation::negate) ? negate(make(Operation::sin, nodes_[a].a)) : kNone;
    case Operation::cos:
      return is(a, Operation::negate) ? make(Operation::cos, nodes_[a].a) : kNone;
    case Operation::pow:
      if (isConstant(b, 0)) return constant(1);
      if (isConstant(b, 1)) return a;
      if (isConstant(b, 2)) return multiply(a, a);
      if (isConstant(b, -1)) return reciprocal(a);
      return kNone;
    case Operation::both:
    case Operation::either: {
      if (a == b) return a;
      const double neutral = operation == Operation::both ? 1 : 0;
      if (isConstant(a)) return isConstant(a, neutral) ? b : a;
      if (isConstant(b)) return isConstant(b, neutral) ? a : b;
      return kNone;
    }
    case Operation::opposite:
      return is(a, Operation::opposite) ? nodes_[a].a : kNone;
    case Operation::select:
      return simplifiedSelection(a, b, c);
    default:
      return kNone;
  }
}

Id Graph::simplifiedSum(Id a, Id b) {
  if (isConstant(a, 0)) return b;
  if (isConstant(b, 0)) return a;
  if (is(b, Operation::negate)) return subtract(a, nodes_[b].a);
  if (is(a, Operation::negate)) return subtract(b, nodes_[a].a);
  return kNone;
}

Id Graph::simplifiedDifference(Id a, Id b) {
  if (a == b) return constant(0);
  if (isConstant(b, 0)) return a;
  if (isConstant(a, 0)) return negate(b);
  if (is(b, Operation::negate)) return add(a, nodes_[b].a);
  if (is(a, Operation::negate)) return negate(add(nodes_[a].a, b));
  return kNone;
}

Id Graph::simplifiedProduct(Id a, Id b) {
  if (isConstant(b)) std::swap(a, b);
  if (isConstant(a, 0)) return a;
  if (isConstant(a, 1)) return b;
  if (isConstant(a, -1)) return negate(b);
  if (is(a, Operation::negate)) return negate(multiply(nodes_[a].a, b));
  if (is(b, Operation::negate)) {
    return isConstant(a) ? multiply(constant(-nodes_[a].value), nodes_[b].a)
                         : negate(multiply(a, nodes_[b].a));
  }
  if (isConstant(a) && is(b, Operation::multiply) && isConstant(nodes_[b].a))  // constants come first
    return multiply(constant(nodes_[a].value * nodes_[nodes_[b].a].value), nodes_[b].b);
  return kNone;
}

Id Graph::simplifiedQuotient(Id a, Id b) {
  if (isConstant(a, 0)) return a;
  if (isConstant(a, 1)) return reciprocal(b);
  if (isConstant(b)) {
    int exponent = 0;
    const double inverse = 1 / nodes_[b].value;
    const bool is_exact = std::abs(std::frexp(nodes_[b].value, &exponent)) == 0.5 && std::isnormal(inverse);
    return is_exact ? multiply(constant(inverse), a) : kNone;
  }
  if (is(a, Operation::negate)) return negate(divide(nodes_[a].a, b));
  if (is(b, Operation::negate)) return negate(divide(a, nodes_[b].a));
  return kNone;
}

Id Graph::simplifiedNegation(Id a) {
  if (is(a, Operation::negate)) return nodes_[a].a;
  if (is(a, Operation::subtract)) return subtract(nodes_[a].b, nodes_[a].a);
  if (is(a, Operation::multiply) && isConstant(nodes_[a].a))
    return multiply(constant(-nodes_[nodes_[a].a].value), nodes_[a].b);
  return kNone;
}

Id Graph::simplifiedSelection(Id condition, Id a, Id b) {
  if (isConstant(condition)) return isConstant(condition, 0) ? b : a;
  if (a == b) return a;
  if (is(condition, Operation::opposite)) return select(nodes_[condition].a, b, a);
  if (is(a, Operation::select) && nodes_[a].a == condition) return select(condition, nodes_[a].b, b);
  if (is(b, Operation::select) && nodes_[b].a == condition) return select(condition, a, nodes_[b].c);
  return kNone;
}

std::vector<int> usesOf(const Graph& graph, const std::vector<Id>& outputs) {
  std::vector<int> uses(graph.size(), 0);
  std::vector<Id> pending;
  const auto use = [&](Id id) {
    if (uses[id]++ == 0) pending.push_back(id);
  };
  for (const Id id : outputs) use(id);
  while (!pending.empty()) {
    const Node& n = graph[pending.back()];
    pending.pop_back();
    const int count = operandsOf(n.operation);
    if (count > 0) use(n.a);
    if (count > 1) use(n.b);
    if (count > 2) use(n.c);
  }
  return uses;
}

}  // namespace slom::tape
