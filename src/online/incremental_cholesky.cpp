#include "online/incremental_cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "solve/dense/kernels.hpp"
#include "solve/symbolic/ordering.hpp"

namespace slom {

namespace {

using dense::kStripe;

/// Of the diagonal entry of H: a smaller pivot is rounding error.
constexpr double kLeastOnlinePivot = 1e-13;
/// All blocks are ordered anew when a factorisation of everything takes so many times the work for each block as when they were last.
constexpr double kMostGrowth = 2;
constexpr double kLittleWork = 1e5;
/// From here on nested dissection beats minimum degree: the tree stays shallow.
constexpr int kManyBlocks = 50;
constexpr double kNearlyAsGood = 1.2;  // by operations

int paddedToStripes(int rows) { return dense::stripesOf(rows) * kStripe; }

double flopsOf(double p, double u) { return p * p * p / 3 + p * p * u + p * u * u; }

double flopsOf(const Fronts& fronts) {
  return std::accumulate(fronts.front.begin(), fronts.front.end(), 0.0,
                         [](double sum, const Front& front) { return sum + flopsOf(front.p, front.u); });
}

/// Fronts that keep the factor sparse, with the last block, which what comes next will most likely touch, at the end. Few blocks, as where
/// a chain grows, are eliminated by age where that is nearly as good: then what is old does not stay at the top.
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
    if (flopsOf(by_age) <= kNearlyAsGood * flopsOf(fronts)) return by_age;
  }
  return fronts;
}

}  // namespace

// ---- blocks and elements ---------------------------------------------------------------------------------------

void IncrementalCholesky::insertBlock(int block, int dof) {
  if (block >= blockCount()) {
    blocks_.resize(at(block + 1));
    local_.resize(at(block + 1), -1);
  }
  blocks_[at(block)] = {dof, -1, 0, next_age_++};
  ++filled_blocks_;
  loose_blocks_.push_back(block);
}

void IncrementalCholesky::removeBlock(int block) {
  markPathFrom(block);
  std::erase(loose_blocks_, block);
  forgetUndetermined(block);
  blocks_[at(block)] = {};
  --filled_blocks_;
}

int IncrementalCholesky::insertElement(std::span<const int> blocks, int rows) {
  int e = static_cast<int>(elements_.size());
  if (free_elements_.empty()) {
    elements_.emplace_back();
  } else {
    e = free_elements_.back();
    free_elements_.pop_back();
  }
  Element& element = elements_[at(e)];
  element.blocks.assign(blocks.begin(), blocks.end());
  element.rows = rows;
  element.columns = 0;
  element.front = -1;
  for (const int b : blocks) {
    element.columns += dof(b);
    markPathFrom(b);
  }
  element.A.assign(at(rows) * at(element.columns), 0.0);
  element.g.assign(at(element.columns), 0.0);
  loose_elements_.push_back(e);
  return e;
}

void IncrementalCholesky::removeElement(int e) {
  Element& element = elements_[at(e)];
  for (const int b : element.blocks) markPathFrom(b);
  std::erase(loose_elements_, e);
  element = {};
  free_elements_.push_back(e);
}

void IncrementalCholesky::setA(int e, std::span<const double> A) {
  Element& element = elements_[at(e)];
  element.A.assign(A.begin(), A.end());
  if (element.front >= 0) touch(element.front, true);
}

void IncrementalCholesky::setGradient(int e, std::span<const double> g) {
  Element& element = elements_[at(e)];
  element.g.assign(g.begin(), g.end());
  if (element.front >= 0) touch(element.front, false);
}

/// The front and those above it are to be computed again.
void IncrementalCholesky::touch(int f, bool is_factor) {
  for (; f >= 0; f = fronts_[at(f)].parent) {
    Front& front = fronts_[at(f)];
    const bool is_known = !front.has_solution && (!front.has_factor || !is_factor);
    if (is_factor) front.has_factor = false;
    front.has_solution = false;
    if (is_known) return;  // and so are those above it
    pushDirty(f);
  }
}

void IncrementalCholesky::pushDirty(int f) {
  dirty_.emplace_back(fronts_[at(f)].order, f);
  std::push_heap(dirty_.begin(), dirty_.end(), std::greater<>());
}

// ---- the top of the tree ------------------------------------------------------------------------------------

/// Dissolves the front of a block and all above it.
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
    if (!front.held.empty()) forgetUndetermined(b);
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
  factor_flops_ -= flopsOf(front.p, front.u);
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

/// The graph of the loose blocks, in their order, by loose elements and by what the loose subtrees leave.
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

/// The block of these that is eliminated first.
int IncrementalCholesky::firstOf(const std::vector<int>& blocks) const {
  return *std::min_element(blocks.begin(), blocks.end(),
                           [&](int a, int b) { return blocks_[at(a)].order < blocks_[at(b)].order; });
}

/// Fronts of these shapes, which eliminate the loose blocks. Returns their indices.
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
    factor_flops_ += flopsOf(front.p, front.u);
    pushDirty(f);
  }
  return index;
}

/// Orders the blocks of dissolved fronts, makes fronts of them, and gives these the loose subtrees and elements.
void IncrementalCholesky::rebuildTop() {
  std::erase_if(loose_blocks_, [&](int b) { return blocks_[at(b)].dof == 0; });
  std::erase_if(loose_elements_, [&](int e) { return elements_[at(e)].blocks.empty(); });
  if (loose_blocks_.empty()) return;
  // Canonical: the same set of blocks gives the same order, however it came together.
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
  work_.blocks_ordered += graph.size();
  loose_blocks_.clear();
  loose_elements_.clear();
  loose_subtrees_.clear();
}

// ---- numbers ------------------------------------------------------------------------------------------------

void IncrementalCholesky::refactor() {
  rebuildTop();
  const double growth = static_cast<double>(filled_blocks_) /
                        static_cast<double>(std::max<std::size_t>(1, blocks_when_ordered_));
  if (factor_flops_ > kLittleWork + kMostGrowth * growth * flops_when_ordered_) reorder();
  while (!dirty_.empty()) {
    std::pop_heap(dirty_.begin(), dirty_.end(), std::greater<>());
    const auto [order, f] = dirty_.back();
    dirty_.pop_back();
    const Front& front = fronts_[at(f)];
    if (front.order != order || front.has_solution) continue;
    if (!front.has_factor) factorizeFront(f);
    solveFront(f);
  }
}

void IncrementalCholesky::recompute() {
  rebuildTop();
  for (std::size_t f = 0; f < fronts_.size(); ++f) {
    Front& front = fronts_[f];
    if (front.pivots.empty()) continue;
    front.has_factor = front.has_solution = false;
    pushDirty(static_cast<int>(f));
  }
  refactor();
}

/// Says where each block of the front begins in it.
void IncrementalCholesky::place(const Front& front) {
  int offset = 0;
  for (const std::vector<int>* blocks : {&front.pivots, &front.rows}) {
    for (const int b : *blocks) {
      local_[at(b)] = offset;
      offset += blocks_[at(b)].dof;
    }
  }
}

void IncrementalCholesky::forgetPlaces(const Front& front) {
  for (const std::vector<int>* blocks : {&front.pivots, &front.rows}) {
    for (const int b : *blocks) local_[at(b)] = -1;
  }
}

/// Adds entries of blocks, one after the other, where these are placed.
void IncrementalCholesky::addByPlace(const std::vector<int>& blocks, const double* from,
                                     std::vector<double>& to) const {
  for (const int b : blocks) {
    for (int i = 0; i < dof(b); ++i) to[at(local_[at(b)] + i)] += *from++;
  }
}

void IncrementalCholesky::forgetUndetermined(int block) {
  undetermined_.erase(undetermined_.lower_bound({block, 0}), undetermined_.lower_bound({block + 1, 0}));
}

/// Where a row of the lower triangle begins, in the columns of the pivots or in the others: its entries are kStripe apart.
double* IncrementalCholesky::rowOf(Front& front, int row, bool to_panel) const {
  const auto inPanel = [&](double* panel, int i) {
    return panel + static_cast<std::ptrdiff_t>(kStripe) * front.p * (i / kStripe) + i % kStripe;
  };
  if (row < front.p) return inPanel(front.D.data(), row);
  const int i = row - front.p;
  if (to_panel) return inPanel(front.B.data(), i);
  return front.U.data() + dense::updateOffset(i / kStripe) + i % kStripe -
         static_cast<std::ptrdiff_t>(kStripe) * front.p;
}

double* IncrementalCholesky::entry(Front& front, int row, int column) const {
  return rowOf(front, row, column < front.p) + static_cast<std::ptrdiff_t>(kStripe) * column;
}

/// Adds the products of elements to the columns of the pivots, or to the others.
void IncrementalCholesky::addElements(Front& front, bool to_panel) {
  for (const int e : front.elements) {
    const Element& element = elements_[at(e)];
    const int rows = element.rows;
    const double* A_k = element.A.data();
    for (const int k : element.blocks) {
      const int dof_k = dof(k), at_k = local_[at(k)];
      const double* A_l = element.A.data();
      for (const int l : element.blocks) {
        const int dof_l = dof(l), at_l = local_[at(l)];
        const double* const first = A_l;
        A_l += static_cast<std::ptrdiff_t>(rows) * dof_l;
        if (at_l > at_k || (at_l < front.p) != to_panel) continue;
        for (int i = 0; i < dof_k; ++i) {
          double* const to = rowOf(front, at_k + i, to_panel) + static_cast<std::ptrdiff_t>(kStripe) * at_l;
          const double* const a = A_k + static_cast<std::ptrdiff_t>(rows) * i;
          const int columns = at_l == at_k ? i + 1 : dof_l;
          for (int j = 0; j < columns; ++j) {
            const double* const b = first + static_cast<std::ptrdiff_t>(rows) * j;
            double sum = 0;
            for (int r = 0; r < rows; ++r) sum += a[r] * b[r];
            to[kStripe * j] += sum;
          }
        }
      }
      A_k += static_cast<std::ptrdiff_t>(rows) * dof_k;
    }
  }
}

/// Adds the update matrices of the children, block by block: in the order of the front's rows, which may not be that of the child's.
void IncrementalCholesky::addChildren(Front& front, bool to_panel) {
  struct Part {
    int to, from, dof;
  };
  std::vector<Part> parts;
  for (const int c : front.children) {
    Front& child = fronts_[at(c)];
    parts.clear();
    int from = 0;
    for (const int b : child.rows) {
      parts.push_back({local_[at(b)], from, dof(b)});
      from += dof(b);
    }
    std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.to < b.to; });
    const double* const U = child.U.data();
    const auto rowOfU = [&](int i) { return U + dense::updateOffset(i / kStripe) + i % kStripe; };
    for (std::size_t a = 0; a < parts.size(); ++a) {
      const Part& row = parts[a];
      // Rows that lie side by side, here and there.
      for (int i = 0, count = 0; i < row.dof; i += count) {
        const int to_row = row.to + i < front.p ? row.to + i : row.to + i - front.p;
        count = std::min({row.dof - i, kStripe - (row.from + i) % kStripe, kStripe - to_row % kStripe});
        double* const to = rowOf(front, row.to + i, to_panel);
        const double* const own = rowOfU(row.from + i);
        for (std::size_t b = 0; b <= a; ++b) {
          const Part& column = parts[b];
          if ((column.to < front.p) != to_panel) continue;
          double* const into = to + static_cast<std::ptrdiff_t>(kStripe) * column.to;
          if (a == b) {
            const double* const u = own + static_cast<std::ptrdiff_t>(kStripe) * column.from;
            for (int k = 0; k < count; ++k) {
              for (int j = 0; j <= i + k; ++j) into[kStripe * j + k] += u[kStripe * j + k];
            }
          } else if (column.from < row.from) {
            const double* const u = own + static_cast<std::ptrdiff_t>(kStripe) * column.from;
            for (int j = 0; j < column.dof; ++j) {
              for (int k = 0; k < count; ++k) into[kStripe * j + k] += u[kStripe * j + k];
            }
          } else {
            for (int j = 0; j < column.dof; ++j) {
              const double* const u =
                  rowOfU(column.from + j) + static_cast<std::ptrdiff_t>(kStripe) * (row.from + i);
              for (int k = 0; k < count; ++k) into[kStripe * j + k] += u[kStripe * k];
            }
          }
        }
      }
    }
  }
}

void IncrementalCholesky::assemblePanel(Front& front) {
  std::fill_n(front.D.data(), dense::panelSize(front.p, front.p), 0.0);
  std::fill_n(front.B.data(), dense::panelSize(front.u, front.p), 0.0);
  addElements(front, true);
  addChildren(front, true);
  for (int i = 0; i < static_cast<int>(front.held.size()); ++i) {
    if (front.held[at(i)] == 0) continue;
    for (int j = 0; j <= i; ++j) *entry(front, i, j) = 0;
    for (int k = i; k < front.p + front.u; ++k) *entry(front, k, i) = 0;
    *entry(front, i, i) = 1;
  }
}

void IncrementalCholesky::factorizeFront(int f) {
  Front& front = fronts_[at(f)];
  const auto& kernel = dense::kernels();
  place(front);
  // The diagonal of H: of elements here and below.
  std::vector<double> diagonal(at(front.p + front.u), 0.0);
  for (const int e : front.elements) {
    const Element& element = elements_[at(e)];
    const double* a = element.A.data();
    for (const int b : element.blocks) {
      for (int i = 0; i < dof(b); ++i) {
        for (int r = 0; r < element.rows; ++r, ++a) diagonal[at(local_[at(b)] + i)] += *a * *a;
      }
    }
  }
  for (const int c : front.children) {
    const Front& child = fronts_[at(c)];
    addByPlace(child.rows, child.diagonal_below.data(), diagonal);
  }
  if (!front.held.empty())
    std::for_each(front.pivots.begin(), front.pivots.end(), [&](int b) { forgetUndetermined(b); });
  front.held.clear();
  std::vector<double> least(at(front.p));
  for (int i = 0; i < front.p; ++i)
    least[at(i)] = std::max(kLeastOnlinePivot * diagonal[at(i)], std::numeric_limits<double>::min());
  front.inverse.resize(at(paddedToStripes(front.p)));
  for (;;) {
    assemblePanel(front);
    double pivot = 0;
    const int done = kernel.factorize(front.D.data(), front.p, least.data(), front.inverse.data(), &pivot);
    if (done == front.p) break;
    hold(front, done);
    least[at(done)] = 0;
  }
  const int stripes = dense::stripesOf(front.u);
  if (stripes > 0) {
    kernel.solveStripes(front.D.data(), front.inverse.data(), front.p, front.B.data(), front.u, 0, stripes);
    kernel.updateStripes(front.B.data(), front.p, front.u, front.U.data(), 0, stripes);
    addElements(front, false);
    addChildren(front, false);
  }
  front.diagonal_below.assign(diagonal.begin() + front.p, diagonal.end());
  front.has_factor = true;
  ++work_.fronts_factorized;
  work_.flops += flopsOf(front.p, front.u);
  forgetPlaces(front);
}

/// Nothing determines the pivot: it stays where it is.
void IncrementalCholesky::hold(Front& front, int pivot) {
  front.held.resize(at(front.p), 0);
  front.held[at(pivot)] = 1;
  int offset = 0;
  for (const int b : front.pivots) {
    if (pivot < offset + dof(b)) {
      undetermined_.emplace(b, pivot - offset);
      return;
    }
    offset += dof(b);
  }
}

/// y := L^-1 g of the pivots; what they take from the rows goes to the parent.
void IncrementalCholesky::solveFront(int f) {
  Front& front = fronts_[at(f)];
  const auto& kernel = dense::kernels();
  place(front);
  std::vector<double> g(at(front.p + front.u), 0.0);
  for (const int e : front.elements) {
    const Element& element = elements_[at(e)];
    addByPlace(element.blocks, element.g.data(), g);
  }
  front.promise_below = 0;
  for (const int c : front.children) {
    const Front& child = fronts_[at(c)];
    addByPlace(child.rows, child.below.data(), g);
    front.promise_below += child.own_promise + child.promise_below;
  }
  front.y.assign(at(paddedToStripes(front.p)), 0.0);
  std::copy_n(g.begin(), front.p, front.y.begin());
  for (std::size_t i = 0; i < front.held.size(); ++i) {
    if (front.held[i] != 0) front.y[i] = 0;
  }
  kernel.forwardPivots(front.D.data(), front.inverse.data(), front.p, front.y.data());
  rows_.assign(at(paddedToStripes(front.u)), 0.0);
  if (front.u > 0) kernel.forwardRows(front.B.data(), front.p, front.u, front.y.data(), rows_.data());
  front.below.resize(at(front.u));
  for (int i = 0; i < front.u; ++i) front.below[at(i)] = g[at(front.p + i)] + rows_[at(i)];
  front.own_promise = 0;
  for (int i = 0; i < front.p; ++i) front.own_promise += front.y[at(i)] * front.y[at(i)];
  front.has_solution = front.has_news = true;
  ++work_.fronts_solved;
  forgetPlaces(front);
}

double IncrementalCholesky::promise() const {
  double sum = 0;
  for (const int f : roots_) sum += fronts_[at(f)].own_promise + fronts_[at(f)].promise_below;
  return sum;
}

// ---- steps --------------------------------------------------------------------------------------------------

const std::vector<IncrementalCholesky::Move>& IncrementalCholesky::solve(double threshold, bool everywhere) {
  moves_.clear();
  step_.clear();
  to_visit_.clear();
  for (const int f : roots_) {
    const Front& front = fronts_[at(f)];
    if (front.own_promise + front.promise_below > threshold) to_visit_.push_back(f);
  }
  while (!to_visit_.empty()) {
    const int f = to_visit_.back();
    to_visit_.pop_back();
    goDown(f, threshold, everywhere);
  }
  for (Move& move : moves_) move.d = step_.data() + std::exchange(local_[at(move.block)], -1);
  return moves_;
}

/// d of the front's pivots, given that of its rows, unless it promises next to nothing. Children follow whose rows have moved, or in
/// whose subtrees something is left.
void IncrementalCholesky::goDown(int f, double threshold, bool everywhere) {
  Front& front = fronts_[at(f)];
  const auto& kernel = dense::kernels();
  std::vector<double> d(at(paddedToStripes(front.p)), 0.0);
  for (int i = 0; i < front.p; ++i) d[at(i)] = -front.y[at(i)];
  if (front.u > 0) {
    rows_.assign(at(paddedToStripes(front.u)), 0.0);
    int i = 0;
    for (const int b : front.rows) {
      const int place = local_[at(b)];  // in the step, where the block has moved
      if (place >= 0) std::copy_n(step_.data() + place, dof(b), rows_.data() + i);
      i += dof(b);
    }
    kernel.backwardRows(front.B.data(), front.p, front.u, rows_.data(), d.data());
  }
  double promised = 0;
  for (int i = 0; i < front.p; ++i) promised += d[at(i)] * d[at(i)];
  if (promised > threshold) {
    kernel.backwardPivots(front.D.data(), front.inverse.data(), front.p, d.data());
    int i = 0;
    for (const int b : front.pivots) {
      local_[at(b)] = static_cast<int>(step_.size());
      moves_.push_back({b, nullptr});
      for (int c = 0; c < dof(b); ++c, ++i) {
        const bool is_held = !front.held.empty() && front.held[at(i)] != 0;
        step_.push_back(is_held ? 0 : d[at(i)]);
      }
    }
  }
  front.has_news = false;
  for (const int c : front.children) {
    const Front& child = fronts_[at(c)];
    const bool has_more =
        (everywhere || child.has_news) && child.own_promise + child.promise_below > threshold;
    if (has_more ||
        std::any_of(child.rows.begin(), child.rows.end(), [&](int b) { return local_[at(b)] >= 0; }))
      to_visit_.push_back(c);
  }
}

std::vector<double> IncrementalCholesky::content() const {
  std::set<std::pair<std::uint64_t, int>> all;
  for (std::size_t f = 0; f < fronts_.size(); ++f) {
    if (!fronts_[f].pivots.empty()) all.emplace(fronts_[f].order, static_cast<int>(f));
  }
  std::vector<double> numbers;
  for (const auto& [order, f] : all) {
    const Front& front = fronts_[at(f)];
    numbers.insert(numbers.end(), front.D.data(), front.D.data() + dense::panelSize(front.p, front.p));
    numbers.insert(numbers.end(), front.B.data(), front.B.data() + dense::panelSize(front.u, front.p));
    numbers.insert(numbers.end(), front.y.begin(), front.y.end());
    numbers.insert(numbers.end(), front.below.begin(), front.below.end());
  }
  return numbers;
}

}  // namespace slom
