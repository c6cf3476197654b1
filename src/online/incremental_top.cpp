/// The top of the tree: the fronts that are dissolved and reordered.
#include <algorithm>
#include <iterator>
#include <numeric>

#include "online/incremental_cholesky.hpp"
#include "solve/dense/kernels.hpp"
#include "solve/symbolic/ordering.hpp"

namespace slom {

namespace {

/// Number of blocks from which on nested dissection beats minimum degree, because the tree stays shallow.
constexpr int kManyBlocks = 50;
constexpr double kNearlyAsGood = 1.2;  // ratio of operations

/// Returns fronts that keep the factor sparse, with the last block at the end, because new elements will most likely
/// touch it. If there are few blocks, as in a growing chain, and elimination by age is nearly as good, eliminates by
/// age. Then old blocks do not stay at the top.
Fronts frontsWithNewestLast(const BlockGraph& graph) {
  const int newest = graph.size() - 1;
  BlockGraph older;
  older.start.push_back(0);
  for (int i = 0; i < newest; ++i) {
    std::copy_if(graph.neighbour.begin() + graph.start[at(i)],
                 graph.neighbour.begin() + graph.start[at(i + 1)], std::back_inserter(older.neighbour),
                 [&](int k) { return k != newest; });
    older.start.push_back(static_cast<int>(older.neighbour.size()));
    older.dof.push_back(graph.dof[at(i)]);
  }
  std::vector<int> order;
  if (older.size() >= kManyBlocks) order = orderByNestedDissection(older);
  if (order.empty() && older.size() > 0) order = orderByMinimumDegree(older);
  order.push_back(newest);
  Fronts fronts = makeFronts(graph, order);
  if (older.size() < kManyBlocks) {
    std::iota(order.begin(), order.end(), 0);
    Fronts by_age = makeFronts(graph, order);
    if (by_age.flops <= kNearlyAsGood * fronts.flops) return by_age;
  }
  return fronts;
}

}  // namespace

/// Dissolves the front of a block and all fronts above it.
void IncrementalCholesky::markPathFrom(int block) {
  for (int f = blocks_[at(block)].front; f >= 0;) {
    const int parent = fronts_[at(f)].parent;
    dissolve(f);
    f = parent;
  }
}

void IncrementalCholesky::dissolve(int f) {
  Front& front = fronts_[at(f)];
  for (const int b : front.pivots) {
    blocks_[at(b)].front = -1;
    loose_blocks_.push_back(b);
    if (!front.undetermined.empty()) forgetUndetermined(b);
  }
  for (const int e : front.elements) {
    elements_[at(e)].front = -1;
    loose_elements_.push_back(e);
  }
  for (const int child : front.children) {
    fronts_[at(child)].parent = -1;
    loose_subtrees_.push_back(child);
  }
  if (front.parent >= 0) std::erase(fronts_[at(front.parent)].children, f);
  std::erase(loose_subtrees_, f);
  roots_.erase(f);
  factor_flops_ -= frontFlops(front.p, front.u);
  front = {};
  free_fronts_.push_back(f);
}

int IncrementalCholesky::newFront() {
  if (free_fronts_.empty()) {
    fronts_.emplace_back();
    return static_cast<int>(fronts_.size()) - 1;
  }
  const int f = free_fronts_.back();
  free_fronts_.pop_back();
  return f;
}

void IncrementalCholesky::attach(int child, int parent) {
  fronts_[at(child)].parent = parent;
  if (parent < 0) {
    roots_.insert(child);
    return;
  }
  std::vector<int>& children = fronts_[at(parent)].children;
  const auto is_before = [&](int a, int b) { return fronts_[at(a)].order < fronts_[at(b)].order; };
  children.insert(std::upper_bound(children.begin(), children.end(), child, is_before), child);
}

void IncrementalCholesky::reorder() {
  while (!roots_.empty()) {
    std::vector<int> all{*roots_.begin()};
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::vector<int>& children = fronts_[at(all[i])].children;
      all.insert(all.end(), children.begin(), children.end());
    }
    for (auto f = all.rbegin(); f != all.rend(); ++f) dissolve(*f);
  }
  rebuildTop();
  flops_when_ordered_ = factor_flops_;
  blocks_when_ordered_ = filled_blocks_;
  work_.reordered_all = true;
}

/// Returns the graph of the loose blocks, in their order. Its edges come from loose elements and from the rows of loose
/// subtrees.
BlockGraph IncrementalCholesky::looseGraph() {
  const int count = static_cast<int>(loose_blocks_.size());
  for (int i = 0; i < count; ++i) local_[at(loose_blocks_[at(i)])] = i;
  std::vector<std::vector<int>> neighbours(at(count));
  std::vector<int> places;
  const auto addClique = [&](const std::vector<int>& blocks) {
    places.clear();
    for (const int b : blocks) places.push_back(local_[at(b)]);
    for (const int i : places) {
      std::vector<int>& own = neighbours[at(i)];
      own.insert(own.end(), places.begin(), places.end());
    }
  };
  for (const int e : loose_elements_) addClique(elements_[at(e)].blocks);
  for (const int f : loose_subtrees_) addClique(fronts_[at(f)].rows);
  for (const int b : loose_blocks_) local_[at(b)] = -1;
  BlockGraph graph;
  graph.start.push_back(0);
  for (int i = 0; i < count; ++i) {
    std::vector<int>& own = neighbours[at(i)];
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    std::copy_if(own.begin(), own.end(), std::back_inserter(graph.neighbour), [&](int k) { return k != i; });
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
    graph.dof.push_back(dof(loose_blocks_[at(i)]));
  }
  return graph;
}

/// Returns the block that is eliminated first.
int IncrementalCholesky::firstOf(const std::vector<int>& blocks) const {
  return *std::min_element(blocks.begin(), blocks.end(),
                           [&](int a, int b) { return blocks_[at(a)].order < blocks_[at(b)].order; });
}

/// Makes fronts of these shapes, which eliminate the loose blocks. Returns their indices.
std::vector<int> IncrementalCholesky::makeLooseFronts(const Fronts& shapes) {
  std::vector<int> index;
  for (const slom::Front& shape : shapes.front) {
    const int f = newFront();
    index.push_back(f);
    Front& front = fronts_[at(f)];
    for (int c = shape.first_column; c < shape.last_column; ++c) {
      const int b = loose_blocks_[at(shapes.order[at(c)])];
      front.pivots.push_back(b);
      blocks_[at(b)].front = f;
      blocks_[at(b)].order = next_order_++;
    }
    for (int r = shape.first_row; r < shape.last_row; ++r)
      front.rows.push_back(loose_blocks_[at(shapes.order[at(shapes.row[at(r)])])]);
    front.p = shape.p;
    front.u = shape.u;
    front.order = blocks_[at(front.pivots.front())].order;
    front.D.resize(dense::panelSize(front.p, front.p));
    front.B.resize(dense::panelSize(front.u, front.p));
    front.U.resize(dense::updateSize(front.u));
    factor_flops_ += frontFlops(front.p, front.u);
    pushDirty(f);
  }
  return index;
}

/// Sets the places of the elements and children of a front in it.
void IncrementalCholesky::place(const Front& front) {
  int row = 0;
  for (const std::vector<int>* blocks : {&front.pivots, &front.rows}) {
    for (const int b : *blocks) {
      local_[at(b)] = row;
      row += dof(b);
    }
  }
  for (const int e : front.elements) {
    Element& element = elements_[at(e)];
    element.places.clear();
    for (const int b : element.blocks) element.places.emplace_back(local_[at(b)], dof(b));
  }
  for (const int c : front.children) {
    Front& child = fronts_[at(c)];
    child.in_parent.clear();
    for (const int b : child.rows) child.in_parent.add(local_[at(b)], dof(b), front.p);
    child.in_parent.finish(front.p);
  }
  for (const std::vector<int>* blocks : {&front.pivots, &front.rows}) {
    for (const int b : *blocks) local_[at(b)] = -1;
  }
}

/// Orders the blocks of dissolved fronts and makes fronts of them. Attaches the loose subtrees and elements to these.
void IncrementalCholesky::rebuildTop() {
  std::erase_if(loose_blocks_, [&](int b) { return blocks_[at(b)].dof == 0; });
  std::erase_if(loose_elements_, [&](int e) { return elements_[at(e)].blocks.empty(); });
  if (loose_blocks_.empty()) return;
  // The order is canonical: the same set of blocks gives the same order, whatever its history.
  std::sort(loose_blocks_.begin(), loose_blocks_.end(),
            [&](int a, int b) { return blocks_[at(a)].age < blocks_[at(b)].age; });
  const BlockGraph graph = looseGraph();
  const Fronts shapes = frontsWithNewestLast(graph);
  const std::vector<int> index = makeLooseFronts(shapes);
  for (std::size_t i = 0; i < index.size(); ++i)
    attach(index[i], shapes.front[i].parent < 0 ? -1 : index[at(shapes.front[i].parent)]);
  for (const int f : loose_subtrees_) {
    const std::vector<int>& rows = fronts_[at(f)].rows;
    attach(f, rows.empty() ? -1 : blocks_[at(firstOf(rows))].front);
  }
  std::sort(loose_elements_.begin(), loose_elements_.end());
  for (const int e : loose_elements_) {
    Element& element = elements_[at(e)];
    element.front = blocks_[at(firstOf(element.blocks))].front;
    fronts_[at(element.front)].elements.push_back(e);
  }
  for (const int f : index) place(fronts_[at(f)]);
  work_.blocks_ordered += graph.size();
  loose_blocks_.clear();
  loose_elements_.clear();
  loose_subtrees_.clear();
}

}  // namespace slom
