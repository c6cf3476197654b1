#include "tape/derivatives.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "mtk/error.hpp"

namespace slom::tape {

namespace {

/// A derivative: factor times node.
struct Coefficient {
  double factor = 0;
  Id node = 0;
  bool may_be_infinite = false;  ///< and is then multiplied so that 0 times it is 0
};

/// Arithmetic of derivatives.
class Calculus {
 public:
  explicit Calculus(Graph& graph) : graph_(graph), one_(graph.constant(1)), zero_(graph.constant(0)) {}

  Coefficient number(double x) const { return {x, one_, false}; }
  Coefficient of(Id node, double factor = 1, bool may_be_infinite = false) const {
    const Node& n = graph_[node];
    if (n.operation == Operation::constant) return number(factor * n.value);
    if (n.operation == Operation::negate) return of(n.a, -factor, may_be_infinite);
    if (n.operation == Operation::multiply && graph_.isConstant(n.a))
      return of(n.b, factor * graph_[n.a].value, may_be_infinite);
    return {factor, node, may_be_infinite};
  }
  Id node(const Coefficient& c) const { return graph_.multiply(graph_.constant(c.factor), c.node); }

  /// Returns outer times inner: the derivative along two edges.
  Coefficient product(const Coefficient& outer, const Coefficient& inner) {
    const double factor = outer.factor * inner.factor;
    if (factor == 0) return number(0);
    if (outer.node == one_) return {factor, inner.node, inner.may_be_infinite};
    if (inner.node == one_) return {factor, outer.node, outer.may_be_infinite};
    const Node left = graph_[outer.node], right = graph_[inner.node];
    const bool same = isMask(left) && isMask(right) && left.a == right.a;
    if (isMask(left) && (same || !graph_.isTame(inner.node) || inner.may_be_infinite))
      return masked(left, factor, outer, inner, true);
    if (isMask(right) && (!graph_.isTame(outer.node) || outer.may_be_infinite))
      return masked(right, factor, inner, outer, false);
    if (outer.may_be_infinite && !inner.may_be_infinite)
      return of(graph_.make(Operation::scale, outer.node, inner.node), factor);
    return of(graph_.multiply(outer.node, inner.node), factor,
              outer.may_be_infinite || inner.may_be_infinite);
  }
  Coefficient sum(const Coefficient& a, const Coefficient& b) {
    if (a.factor == 0) return b;
    if (b.factor == 0) return a;
    const bool may_be_infinite = a.may_be_infinite || b.may_be_infinite;
    if (a.node == b.node) return of(a.node, a.factor + b.factor, may_be_infinite);
    const bool minus = b.factor == -a.factor;
    if (a.factor != b.factor && !minus) return of(added(node(a), node(b), false), 1, may_be_infinite);
    return of(added(a.node, b.node, minus), a.factor, may_be_infinite);
  }
  /// Returns 1 where the condition holds and 0 elsewhere, or the other way round.
  Coefficient mask(Id condition, bool holds) const {
    return of(graph_.select(condition, holds ? one_ : zero_, holds ? zero_ : one_));
  }

 private:
  /// Returns whether one side of a selection is 0.
  bool isMask(const Node& n) const {
    return n.operation == Operation::select && (n.b == zero_ || n.c == zero_);
  }
  /// Returns factor times the nodes' product, below the selection, so that the side that is not taken gives exactly 0.
  Coefficient masked(const Node& mask, double factor, const Coefficient& selection, const Coefficient& other,
                     bool is_outer) {
    const bool first = mask.c == zero_;
    const Coefficient own = of(first ? mask.b : mask.c, 1, selection.may_be_infinite);
    Coefficient with{1, other.node, other.may_be_infinite};
    const Node inner = graph_[other.node];
    if (isMask(inner) && inner.a == mask.a) {
      if ((inner.c == zero_) != first) return number(0);
      with = of(first ? inner.b : inner.c, 1, other.may_be_infinite);
    }
    Coefficient result = is_outer ? product(own, with) : product(with, own);
    if (first && result.may_be_infinite && guards(mask.a, result.node)) result.may_be_infinite = false;
    const Id chosen = node({result.factor, result.node, false});
    return of(graph_.select(mask.a, first ? chosen : zero_, first ? zero_ : chosen), factor,
              result.may_be_infinite);
  }
  /// Returns whether the condition is that x > 0, and the node 1 / sqrt(x).
  bool guards(Id condition, Id inverse_root) const {
    const Node &less = graph_[condition], &inverse = graph_[inverse_root];
    if (less.operation != Operation::less || less.a != zero_ || inverse.operation != Operation::reciprocal)
      return false;
    const Node& root = graph_[inverse.a];
    return root.operation == Operation::sqrt && root.a == less.b;
  }
  Id added(Id a, Id b, bool minus) {
    const Node &x = graph_[a], &y = graph_[b];
    if (isMask(x) && isMask(y) && x.a == y.a) {
      const Id condition = x.a;
      const Id yes = minus ? graph_.subtract(x.b, y.b) : graph_.add(x.b, y.b);
      const Node &again = graph_[a], &other = graph_[b];
      const Id no = minus ? graph_.subtract(again.c, other.c) : graph_.add(again.c, other.c);
      return graph_.select(condition, yes, no);
    }
    return minus ? graph_.subtract(a, b) : graph_.add(a, b);
  }

  Graph& graph_;
  Id one_, zero_;
};

struct Edge {
  Id from;
  Coefficient by;
};

/// The local derivatives of operations, with the conventions of mtk's dual numbers.
class LocalDerivatives {
 public:
  LocalDerivatives(Graph& graph, Calculus& calculus) : g_(graph), calculus_(calculus) {}

  std::vector<Edge> of(Id id) {
    const Node n = g_[id];
    switch (n.operation) {
      case Operation::add:
        return {{n.a, number(1)}, {n.b, number(1)}};
      case Operation::subtract:
        return {{n.a, number(1)}, {n.b, number(-1)}};
      case Operation::multiply:
        if (n.a == n.b) return {{n.a, calculus_.of(n.a, 2)}};
        return {{n.a, calculus_.of(n.b)}, {n.b, calculus_.of(n.a)}};
      case Operation::negate:
        return {{n.a, number(-1)}};
      case Operation::wrap:
        return {{n.a, number(1)}};
      case Operation::divide: {
        const Id inverse = g_.reciprocal(n.b);
        return {{n.a, calculus_.of(inverse)}, {n.b, calculus_.of(g_.multiply(id, inverse), -1)}};
      }
      case Operation::reciprocal:
        return {{n.a, calculus_.of(g_.multiply(id, id), -1)}};
      case Operation::atan2: {
        const Id by_y = g_.make(Operation::inverse_arc, n.b, n.a),
                 by_x = g_.make(Operation::inverse_arc, n.a, n.b);
        return {{n.a, calculus_.of(by_y)}, {n.b, calculus_.of(by_x, -1)}};
      }
      case Operation::hypot: {
        const Id size = g_.select(g_.make(Operation::less, constant(0), id), id, constant(1));
        const Id inverse = g_.reciprocal(size);
        return {{n.a, calculus_.of(g_.multiply(n.a, inverse))},
                {n.b, calculus_.of(g_.multiply(n.b, inverse))}};
      }
      case Operation::pow:
        return ofPower(id, n);
      case Operation::select:
        return {{n.b, calculus_.mask(n.a, true)}, {n.c, calculus_.mask(n.a, false)}};
      default:
        return ofFunction(id, n);
    }
  }

 private:
  Id constant(double x) { return g_.constant(x); }
  Coefficient number(double x) const { return calculus_.number(x); }
  Id oneMinusSquare(Id x) { return g_.multiply(g_.subtract(constant(1), x), g_.add(constant(1), x)); }
  Id inverseRoot(Id x) { return g_.reciprocal(g_.make(Operation::sqrt, x)); }
  static std::vector<Edge> one(Id from, const Coefficient& by) { return {{from, by}}; }

  std::vector<Edge> ofFunction(Id id, const Node& n) {
    const Id x = n.a;
    switch (n.operation) {
      case Operation::sqrt:
        return one(x, calculus_.of(g_.reciprocal(id), 0.5, true));
      case Operation::cbrt:
        return one(x, calculus_.of(g_.reciprocal(g_.multiply(id, id)), 1.0 / 3, true));
      case Operation::abs:
        return one(x, calculus_.of(g_.make(Operation::sign, x)));
      case Operation::sin:
        return one(x, calculus_.of(g_.make(Operation::cos, x)));
      case Operation::cos:
        return one(x, calculus_.of(g_.make(Operation::sin, x), -1));
      case Operation::tan:
        return one(x, calculus_.of(g_.add(constant(1), g_.multiply(id, id))));
      case Operation::asin:
        return one(x, calculus_.of(inverseRoot(oneMinusSquare(x)), 1, true));
      case Operation::acos:
        return one(x, calculus_.of(inverseRoot(oneMinusSquare(x)), -1, true));
      case Operation::atan:
        return one(x, calculus_.of(g_.reciprocal(g_.add(constant(1), g_.multiply(x, x)))));
      case Operation::sinh:
        return one(x, calculus_.of(g_.make(Operation::cosh, x)));
      case Operation::cosh:
        return one(x, calculus_.of(g_.make(Operation::sinh, x)));
      case Operation::tanh:
        return one(x, calculus_.of(oneMinusSquare(id)));
      case Operation::asinh:
        return one(x, calculus_.of(inverseRoot(g_.add(constant(1), g_.multiply(x, x)))));
      case Operation::acosh: {
        const Id product = g_.multiply(g_.subtract(x, constant(1)), g_.add(x, constant(1)));
        return one(x, calculus_.of(inverseRoot(product), 1, true));
      }
      case Operation::atanh:
        return one(x, calculus_.of(g_.reciprocal(oneMinusSquare(x)), 1, true));
      case Operation::exp:
        return one(x, calculus_.of(id));
      case Operation::expm1:
        return one(x, calculus_.of(g_.add(id, constant(1))));
      case Operation::log:
        return one(x, calculus_.of(g_.reciprocal(x), 1, true));
      case Operation::log1p:
        return one(x, calculus_.of(g_.reciprocal(g_.add(constant(1), x)), 1, true));
      case Operation::erf:
      case Operation::erfc:
        return one(
            x, calculus_.of(g_.make(Operation::exp, g_.negate(g_.multiply(x, x))),
                            (n.operation == Operation::erf ? 1 : -1) * 1.1283791670955125738961589031215452));
      default:  // floor, sign and conditions
        return {};
    }
  }
  std::vector<Edge> ofPower(Id id, const Node& n) {
    std::vector<Edge> edges;
    const Id zero = constant(0);
    if (!g_.isConstant(n.a)) {
      const Id slope = g_.multiply(n.b, g_.make(Operation::pow, n.a, g_.subtract(n.b, constant(1))));
      const Id by = g_.select(g_.make(Operation::equal, n.b, zero), zero, slope);
      edges.push_back({n.a, calculus_.of(by, 1, true)});
    }
    if (!g_.isConstant(n.b)) {
      const Id slope = g_.multiply(id, g_.make(Operation::log, n.a));
      const Id by = g_.select(g_.make(Operation::equal, id, zero), zero, slope);
      edges.push_back({n.b, calculus_.of(by, 1, true)});
    }
    return edges;
  }

  Graph& g_;
  Calculus& calculus_;
};

/// The linearised graph. Vertices are in topological order: unknowns, nodes, sinks.
class LinearGraph {
 public:
  LinearGraph(Graph& graph, const StatedDerivatives& stated, const std::vector<Id>& outputs,
              const std::vector<Id>& unknowns)
      : graph_(graph), stated_(stated), calculus_(graph), local_(graph, calculus_) {
    for (const Id id : unknowns) vertex_[id] = addVertex();
    first_inner_ = count();
    for (const Id id : outputs) visit(id);
    last_inner_ = count();
    for (const Id id : outputs) {
      const int sink = addVertex();
      if (const auto found = vertex_.find(id); found != vertex_.end() && found->second >= 0)
        connect(sink, found->second, calculus_.number(1));
    }
  }

  enum class Order { forward, reverse, markowitz };
  /// Returns the derivatives of the sinks after elimination in this order; leaves this graph as it is. Returns nothing if
  /// that takes more than `most` products, and sets `most` to their number otherwise.
  std::optional<std::vector<Id>> eliminated(Order order, long& most) {
    const auto saved_in = in_;
    const auto saved_out = out_;
    products_left_ = most;
    if (order == Order::forward) {
      for (int v = first_inner_; v < last_inner_ && products_left_ >= 0; ++v) eliminate(v);
    } else if (order == Order::reverse) {
      for (int v = last_inner_; v-- > first_inner_ && products_left_ >= 0;) eliminate(v);
    } else {
      eliminateByMarkowitz();
    }
    if (products_left_ < 0) {
      in_ = saved_in;
      out_ = saved_out;
      return std::nullopt;
    }
    most -= products_left_;
    std::vector<Id> result;
    for (int column = 0; column < first_inner_; ++column) {
      for (int sink = last_inner_; sink < count(); ++sink) {
        const auto found = in_[at(sink)].find(column);
        result.push_back(found == in_[at(sink)].end() ? graph_.constant(0) : calculus_.node(found->second));
      }
    }
    in_ = saved_in;
    out_ = saved_out;
    return result;
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  int count() const { return static_cast<int>(in_.size()); }
  int addVertex() {
    in_.emplace_back();
    out_.emplace_back();
    return count() - 1;
  }
  void connect(int to, int from, const Coefficient& by) {
    if (by.factor == 0) return;
    const auto [place, is_new] = in_[at(to)].try_emplace(from, by);
    if (!is_new) place->second = calculus_.sum(place->second, by);
    if (place->second.factor == 0) {
      in_[at(to)].erase(place);
      out_[at(from)].erase(to);
    } else {
      out_[at(from)].insert(to);
    }
  }

  std::vector<Edge> edgesOf(Id id) {
    const auto found = stated_.find(id);
    if (found == stated_.end()) return local_.of(id);
    std::vector<Edge> edges;
    for (const StatedTerm& term : found->second) edges.push_back({term.of, calculus_.of(term.coefficient)});
    return edges;
  }
  /// Adds a vertex for the node, after those that it depends on; none if it depends on no unknown.
  void visit(Id root) {
    struct Step {
      Id id;
      std::vector<Edge> edges;
      std::size_t next = 0;
    };
    std::vector<Step> path;
    const auto enter = [&](Id id) {
      if (vertex_.contains(id)) return;
      vertex_[id] = kPending;
      path.push_back({id, edgesOf(id)});
    };
    enter(root);
    while (!path.empty()) {
      Step& step = path.back();
      if (step.next < step.edges.size()) {
        enter(step.edges[step.next++].from);
        continue;
      }
      const Step done = std::move(step);
      path.pop_back();
      int own = kIndependent;
      for (const Edge& edge : done.edges) {
        const int from = vertex_.at(edge.from);
        if (from < 0) continue;
        if (own < 0) own = addVertex();
        connect(own, from, edge.by);
      }
      vertex_[done.id] = own;
    }
  }

  void eliminate(int v) {
    const auto in = std::move(in_[at(v)]);
    const auto out = std::move(out_[at(v)]);
    in_[at(v)].clear();
    out_[at(v)].clear();
    products_left_ -= static_cast<long>(in.size() * out.size());
    for (const auto& [from, by] : in) out_[at(from)].erase(v);
    for (const int to : out) {
      const Coefficient outer = in_[at(to)].at(v);
      in_[at(to)].erase(v);
      for (const auto& [from, by] : in) connect(to, from, calculus_.product(outer, by));
    }
  }
  /// Eliminates the vertex with the fewest products next, the first of several.
  void eliminateByMarkowitz() {
    const auto productsOf = [&](int v) { return in_[at(v)].size() * out_[at(v)].size(); };
    std::set<std::pair<std::size_t, int>> left;
    std::vector<std::size_t> products(at(last_inner_));
    for (int v = first_inner_; v < last_inner_; ++v) left.emplace(products[at(v)] = productsOf(v), v);
    std::vector<int> neighbours;
    while (!left.empty() && products_left_ >= 0) {
      const int best = left.begin()->second;
      left.erase(left.begin());
      neighbours.assign(out_[at(best)].begin(), out_[at(best)].end());
      for (const auto& [from, by] : in_[at(best)]) neighbours.push_back(from);
      eliminate(best);
      for (const int v : neighbours) {
        const bool is_left = v >= first_inner_ && v < last_inner_ && left.erase({products[at(v)], v}) > 0;
        if (is_left) left.emplace(products[at(v)] = productsOf(v), v);
      }
    }
  }

  static constexpr int kPending = -2, kIndependent = -1;
  Graph& graph_;
  const StatedDerivatives& stated_;
  Calculus calculus_;
  LocalDerivatives local_;
  std::unordered_map<Id, int> vertex_;
  std::vector<std::map<int, Coefficient>> in_;
  std::vector<std::set<int>> out_;
  int first_inner_ = 0, last_inner_ = 0;
  long products_left_ = 0;
};

}  // namespace

int costOf(const Graph& graph, const std::vector<Id>& outputs) {
  const std::vector<int> uses = usesOf(graph, outputs);
  int cost = 0;
  for (Id id = 0; id < graph.size(); ++id) {
    const Node& n = graph[id];
    if (uses[id] == 0 || operandsOf(n.operation) == 0) continue;
    const auto takes_over = [&](Id operand) {
      return uses[operand] == 1 && graph[operand].operation == Operation::multiply;
    };
    const bool is_sum = n.operation == Operation::add || n.operation == Operation::subtract;
    if (!is_sum || !(takes_over(n.a) || takes_over(n.b))) ++cost;
  }
  return cost;
}

std::vector<Id> differentiate(Graph& graph, const StatedDerivatives& stated, const std::vector<Id>& outputs,
                              const std::vector<Id>& unknowns) {
  LinearGraph linear(graph, stated, outputs, unknowns);
  std::vector<Id> best;
  int fewest = std::numeric_limits<int>::max();
  using Order = LinearGraph::Order;
  // The first order has few products where the unknowns, or the outputs, are few. Others are given up where they take more.
  constexpr long most_products = 20'000'000, share = 8, few = 1000;
  const bool is_forward_first = unknowns.size() < outputs.size();
  const Order first = is_forward_first ? Order::forward : Order::reverse,
              second = is_forward_first ? Order::reverse : Order::forward;
  long least = most_products;
  for (const Order order : {first, second, Order::markowitz}) {
    long products = least < most_products ? share * least + few : most_products;
    const std::optional<std::vector<Id>> found = linear.eliminated(order, products);
    if (!found) continue;
    least = std::min(least, products);
    const std::vector<Id>& own = *found;
    std::vector<Id> all = own;
    all.insert(all.end(), outputs.begin(), outputs.end());
    if (const int cost = costOf(graph, all); cost < fewest) {
      fewest = cost;
      best = own;
    }
  }
  if (least == most_products) {
    throw mtk::Error(
        "slom.traced-too-long",
        "the derivatives of a measurement function need more than " + std::to_string(most_products) +
            " products; divide the measurement into shorter ones, or pass the function without recording it",
        "slom::traced");
  }
  return best;
}

}  // namespace slom::tape
