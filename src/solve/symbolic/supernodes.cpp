#include "supernodes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/index.hpp"

namespace slom {

namespace {

/// Number of pivots above which a front is cut into a chain, so that a stripe of the panel stays in the first-level
/// cache.
constexpr int kMostPivots = 144;

/// Returns the estimated time of a front [ns]: assembly, factorisation, and passing the update on. Only ratios matter.
/// Fitted to measured times of the kernels.
double cost(double p, double u) {
  const double padded = 12 * std::ceil(u / 12);
  const double panel = p * (p / 2 + padded), update = u * padded / 2;
  return 350 + 20 * p + 0.5 * panel + 0.9 * update + 0.045 * p * (p * p / 3 + p * padded + u * padded);
}

/// Returns the parent of each node in the elimination tree; -1 for roots.
///   source   Liu 1990, algorithm 4.2: path compression by `ancestor`
std::vector<int> eliminationTree(const BlockGraph& graph, const std::vector<int>& order,
                                 const std::vector<int>& position) {
  const int n = graph.size();
  std::vector<int> parent(at(n), -1), ancestor(at(n), -1);
  for (int j = 0; j < n; ++j) {
    const int b = order[at(j)];
    for (int e = graph.start[at(b)]; e < graph.start[at(b) + 1]; ++e) {
      for (int i = position[at(graph.neighbour[at(e)])]; i != -1 && i < j;) {
        const int next = ancestor[at(i)];
        ancestor[at(i)] = j;
        if (next == -1) parent[at(i)] = j;
        i = next;
      }
    }
  }
  return parent;
}

/// Returns the nodes of a forest, children before parents and each subtree contiguous.
std::vector<int> postorder(const std::vector<int>& parent) {
  const int n = static_cast<int>(parent.size());
  std::vector<int> first_child(at(n), -1), sibling(at(n), -1), result, stack;
  result.reserve(at(n));
  for (int i = n - 1; i >= 0; --i) {
    if (parent[at(i)] < 0) continue;
    sibling[at(i)] = first_child[at(parent[at(i)])];
    first_child[at(parent[at(i)])] = i;
  }
  for (int root = 0; root < n; ++root) {
    if (parent[at(root)] >= 0) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const int i = stack.back();
      const int child = first_child[at(i)];
      if (child >= 0) {
        first_child[at(i)] = sibling[at(child)];
        stack.push_back(child);
      } else {
        result.push_back(i);
        stack.pop_back();
      }
    }
  }
  return result;
}

std::vector<int> inverse(const std::vector<int>& order) {
  std::vector<int> position(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) position[at(order[i])] = static_cast<int>(i);
  return position;
}

/// Number of blocks below the diagonal in each column of the factor, and their degrees of freedom. Row i of the factor
/// has the nodes on the paths from i's earlier neighbours up to i.
struct ColumnCounts {
  std::vector<int> blocks, dof;
};
ColumnCounts countColumns(const BlockGraph& graph, const std::vector<int>& order,
                          const std::vector<int>& position, const std::vector<int>& parent) {
  const int n = graph.size();
  ColumnCounts count{std::vector<int>(at(n), 0), std::vector<int>(at(n), 0)};
  std::vector<int> mark(at(n), -1);
  for (int i = 0; i < n; ++i) {
    const int b = order[at(i)];
    mark[at(i)] = i;
    for (int e = graph.start[at(b)]; e < graph.start[at(b) + 1]; ++e) {
      for (int k = position[at(graph.neighbour[at(e)])]; k < i && mark[at(k)] != i; k = parent[at(k)]) {
        mark[at(k)] = i;
        ++count.blocks[at(k)];
        count.dof[at(k)] += graph.dof[at(b)];
      }
    }
  }
  return count;
}

/// A front during merging of fronts.
struct Node {
  int p = 0, u = 0;
  int parent = -1;
  bool is_merged = false;           // into its parent
  int first_child = -1, next = -1;  // its first child; the next child of its parent
};

/// Fronts, and by column its front.
struct Nodes {
  std::vector<Node> node;
  std::vector<int> of_column;
};

/// Makes fronts of neighbouring columns with the same rows below them.
Nodes fundamentalSupernodes(const BlockGraph& graph, const std::vector<int>& order,
                            const std::vector<int>& parent, const ColumnCounts& count) {
  Nodes nodes;
  nodes.of_column.resize(parent.size());
  std::vector<int> last_column;
  for (int j = 0; j < static_cast<int>(parent.size()); ++j) {
    const bool joins = j > 0 && parent[at(j - 1)] == j && count.blocks[at(j - 1)] == count.blocks[at(j)] + 1;
    if (!joins) {
      nodes.node.emplace_back();
      last_column.push_back(j);
    }
    Node& node = nodes.node.back();
    last_column.back() = j;
    node.p += graph.dof[at(order[at(j)])];
    node.u = count.dof[at(j)];
    nodes.of_column[at(j)] = static_cast<int>(nodes.node.size()) - 1;
  }
  for (std::size_t i = 0; i < nodes.node.size(); ++i) {
    const int above = parent[at(last_column[i])];
    nodes.node[i].parent = above < 0 ? -1 : nodes.of_column[at(above)];
  }
  return nodes;
}

/// Merges children into parents if one larger front costs less than two.
void amalgamate(std::vector<Node>& nodes) {
  const int n = static_cast<int>(nodes.size());
  std::vector<int> own, kept;
  for (int i = 0; i < n; ++i) {
    Node& node = nodes[at(i)];
    own.clear();
    for (int c = node.first_child; c >= 0; c = nodes[at(c)].next) own.push_back(c);
    // The child whose rows fill the front best comes first, so that the others see the larger front.
    std::sort(own.begin(), own.end(), [&](int a, int b) {
      return nodes[at(a)].u != nodes[at(b)].u ? nodes[at(a)].u > nodes[at(b)].u : a < b;
    });
    kept.clear();
    double alone = cost(node.p, node.u);
    for (const int c : own) {
      Node& child = nodes[at(c)];
      const double together = cost(node.p + child.p, node.u);
      if (together > alone + cost(child.p, child.u)) {
        kept.push_back(c);
        continue;
      }
      alone = together;
      node.p += child.p;
      child.is_merged = true;
      for (int g = child.first_child; g >= 0; g = nodes[at(g)].next) kept.push_back(g);
    }
    node.first_child = -1;
    for (const int c : kept) {
      nodes[at(c)].parent = i;
      nodes[at(c)].next = std::exchange(node.first_child, c);
    }
    if (node.parent >= 0) node.next = std::exchange(nodes[at(node.parent)].first_child, i);
  }
}

/// The merged nodes, children before parents, and the columns of each, ascending.
struct Merged {
  std::vector<Node> node;
  std::vector<int> first_column,
      column;  // the columns of node i are [first_column[i], first_column[i + 1])
};
Merged compact(const Nodes& nodes) {
  const int n = static_cast<int>(nodes.node.size());
  std::vector<int> left, number(at(n), -1), parent;
  for (int i = 0; i < n; ++i) {
    if (nodes.node[at(i)].is_merged) continue;
    number[at(i)] = static_cast<int>(left.size());
    left.push_back(i);
  }
  for (int i = n - 1; i >= 0; --i) {  // parents come after their children
    if (nodes.node[at(i)].is_merged) number[at(i)] = number[at(nodes.node[at(i)].parent)];
  }
  for (const int i : left) {
    const int above = nodes.node[at(i)].parent;
    parent.push_back(above < 0 ? -1 : number[at(above)]);
  }
  const std::vector<int> order = postorder(parent), place = inverse(order);
  Merged result;
  result.node.reserve(order.size());
  for (const int i : order) {
    result.node.push_back(nodes.node[at(left[at(i)])]);
    result.node.back().parent = parent[at(i)] < 0 ? -1 : place[at(parent[at(i)])];
  }
  result.first_column.assign(order.size() + 1, 0);
  const auto node_of = [&](int column) { return at(place[at(number[at(nodes.of_column[at(column)])])]); };
  const int columns = static_cast<int>(nodes.of_column.size());
  for (int j = 0; j < columns; ++j) ++result.first_column[node_of(j) + 1];
  for (std::size_t i = 0; i < order.size(); ++i) result.first_column[i + 1] += result.first_column[i];
  std::vector<int> next = result.first_column;
  result.column.resize(at(columns));
  for (int j = 0; j < columns; ++j) result.column[at(next[node_of(j)]++)] = j;
  return result;
}

/// Appends the node, whose columns are [position, end), as a chain of fronts. Each has at most kMostPivots pivots,
/// unless a single block has more.
void appendChain(const Node& node, int position, int end, const BlockGraph& graph, Fronts& fronts) {
  const int pieces = std::max(1, (node.p + kMostPivots - 1) / kMostPivots);
  const int wanted = (node.p + pieces - 1) / pieces;
  while (position < end) {
    Front front;
    front.first_column = position;
    while (position < end) {
      const int dof = graph.dof[at(fronts.order[at(position)])];
      if (front.p > 0 && front.p + dof > wanted + dof / 2) break;
      front.p += dof;
      ++position;
    }
    front.last_column = position;
    if (position < end) front.parent = static_cast<int>(fronts.front.size()) + 1;
    fronts.front.push_back(front);
  }
}

/// Finds the rows of all fronts: neighbours of their columns and rows of their children that come after their own
/// columns.
void findRows(const BlockGraph& graph, Fronts& fronts) {
  const int n = static_cast<int>(fronts.front.size());
  std::vector<int> mark(at(graph.size()), -1), first_child(at(n), -1), sibling(at(n), -1);
  for (int s = 0; s < n; ++s) {
    Front& front = fronts.front[at(s)];
    front.first_row = static_cast<int>(fronts.row.size());
    const auto add = [&](int i) {
      if (i < front.last_column || mark[at(i)] == s) return;
      mark[at(i)] = s;
      fronts.row.push_back(i);
    };
    for (int j = front.first_column; j < front.last_column; ++j) {
      const int b = fronts.order[at(j)];
      for (int e = graph.start[at(b)]; e < graph.start[at(b) + 1]; ++e)
        add(fronts.position[at(graph.neighbour[at(e)])]);
    }
    for (int c = first_child[at(s)]; c >= 0; c = sibling[at(c)]) {
      const Front& child = fronts.front[at(c)];
      for (int r = child.first_row; r < child.last_row; ++r) add(fronts.row[at(r)]);
    }
    front.last_row = static_cast<int>(fronts.row.size());
    std::sort(fronts.row.begin() + front.first_row, fronts.row.end());
    for (int r = front.first_row; r < front.last_row; ++r) {
      front.u += graph.dof[at(fronts.order[at(fronts.row[at(r)])])];
    }
    if (front.parent >= 0) {
      sibling[at(s)] = first_child[at(front.parent)];
      first_child[at(front.parent)] = s;
    }
  }
}

void countWork(Fronts& fronts) {
  for (const Front& front : fronts.front) {
    for (int j = 0; j < front.p; ++j) {
      const double below = front.p + front.u - j - 1;
      fronts.flops += 1 + below + below * (below + 1);
    }
  }
}

}  // namespace

Fronts makeFronts(const BlockGraph& graph, const std::vector<int>& given_order) {
  // Columns are put into postorder, so that supernodes are contiguous.
  std::vector<int> parent = eliminationTree(graph, given_order, inverse(given_order));
  const std::vector<int> post = postorder(parent), place = inverse(post);
  std::vector<int> order(post.size()), moved(post.size());
  for (std::size_t i = 0; i < post.size(); ++i) {
    order[i] = given_order[at(post[i])];
    const int above = parent[at(post[i])];
    moved[i] = above < 0 ? -1 : place[at(above)];
  }
  parent = std::move(moved);

  Nodes fundamental =
      fundamentalSupernodes(graph, order, parent, countColumns(graph, order, inverse(order), parent));
  amalgamate(fundamental.node);
  const Merged nodes = compact(fundamental);

  Fronts fronts;
  fronts.order.reserve(order.size());
  for (const int column : nodes.column) fronts.order.push_back(order[at(column)]);
  fronts.position = inverse(fronts.order);
  fronts.offset.reserve(order.size() + 1);
  fronts.offset.push_back(0);
  for (const int b : fronts.order) fronts.offset.push_back(fronts.offset.back() + graph.dof[at(b)]);
  std::vector<int> first_front, last_front;
  for (std::size_t i = 0; i < nodes.node.size(); ++i) {
    first_front.push_back(static_cast<int>(fronts.front.size()));
    appendChain(nodes.node[i], nodes.first_column[i], nodes.first_column[i + 1], graph, fronts);
    last_front.push_back(static_cast<int>(fronts.front.size()) - 1);
  }
  for (std::size_t i = 0; i < nodes.node.size(); ++i) {
    const int above = nodes.node[i].parent;
    if (above >= 0) fronts.front[at(last_front[i])].parent = first_front[at(above)];
  }
  findRows(graph, fronts);
  countWork(fronts);
  return fronts;
}

}  // namespace slom
