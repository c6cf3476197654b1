#include "normal_equations.hpp"

#include <algorithm>
#include <unordered_map>

#include "base/index.hpp"
#include "partitions.hpp"
#include "solve/dense/kernels.hpp"
#include "solve/dense/prefetch.hpp"

namespace slom {

namespace {
/// Clears an array. Faster for short arrays than std::fill_n, which calls memset.
void clear(double* x, int n) { Eigen::Map<Eigen::VectorXd>(x, n).setZero(); }

void addTo(double* sum, const double* x, int n) {
  Eigen::Map<Eigen::VectorXd>(sum, n) += Eigen::Map<const Eigen::VectorXd>(x, n);
}
}  // namespace

void NormalEquations::layOut(const BlockStructure& structure, const BlockGraph& graph,
                             const std::vector<int>& position) {
  structure_ = &structure;
  H_.layOut(graph, position);
  gradient_ = Eigen::VectorXd::Zero(structure.unknowns());
  offset_.resize(position.size());
  place_.resize(position.size());
  for (int b = 0; b < graph.size(); ++b) {
    const int column = position[at(b)];
    offset_[at(column)] = structure.offset[at(b)];
    place_[at(b)] = {column, H_.values(H_.begin(column)), gradient_.data() + structure.offset[at(b)]};
  }
  layOutMeasurements();
}

void NormalEquations::layOutMeasurements() {
  partitions_ = choosePartitions(*structure_);
  findDestinations();
}

/// Finds the destination of each measurement. The first partition that meets a block adds to H and g, each later one to
/// a private accumulator.
void NormalEquations::findDestinations() {
  const int blocks = H_.begin(H_.columns()), count = structure_->blockCount();
  destination_.assign(structure_->groups.size(), {});
  place_of_.assign(partitions_.empty() ? 0 : structure_->groups.size(), {});
  accumulators_.clear();
  accumulator_size_ = 0;
  std::vector<signed char> met(at(count), -1), touched(at(blocks), -1);  // last partitions that did
  std::vector<int> place(at(count));                  // place of each block met, in that partition
  std::unordered_map<int, int> accumulator_of_block;  // the latest one of each block off the diagonal
  const auto make_accumulator = [&](int block, int column, int size) {
    accumulators_.push_back({block, column, accumulator_size_});
    accumulator_size_ += at(size);
    return static_cast<int>(accumulators_.size()) - 1;
  };
  int partition = 0;
  for (int g = 0; g < static_cast<int>(structure_->groups.size()); ++g) {
    const MeasurementGroup& group = structure_->groups[at(g)];
    destination_[at(g)].reserve(at(group.size()) * at(group.arity * (group.arity - 1) / 2));
    if (!partitions_.empty()) place_of_[at(g)].reserve(group.blocks.size());
    for (int m = 0; m < group.size(); ++m) {
      partition = partitionOf(partitions_, partition, {g, m});
      const int* block = group.blocks.data() + at(m) * at(group.arity);
      for (int k = 0; k < group.arity; ++k) {
        const int b = block[k];
        if (b >= 0 && met[at(b)] != partition) {
          const int dof = structure_->dof(b);
          place[at(b)] = met[at(b)] < 0
                             ? b
                             : count + make_accumulator(H_.begin(position(b)), position(b), dof * (dof + 1));
          met[at(b)] = static_cast<signed char>(partition);
        }
        if (!partitions_.empty()) place_of_[at(g)].push_back(b < 0 ? b : place[at(b)]);
      }
      for (int k = 0; k < group.arity; ++k) {
        for (int l = k + 1; l < group.arity; ++l) {
          if (block[k] < 0 || block[l] < 0) {
            destination_[at(g)].push_back({-1, 0});
            continue;
          }
          const int a = position(block[k]), b = position(block[l]);
          if (a == b) {
            const int accumulator = place[at(block[k])] - count;
            destination_[at(g)].push_back({accumulator < 0 ? H_.begin(a) : blocks + accumulator, 0});
            continue;
          }
          const int found = H_.find(std::max(a, b), std::min(a, b));
          const int before = std::exchange(touched[at(found)], static_cast<signed char>(partition));
          if (before >= 0 && before != partition)
            accumulator_of_block[found] =
                blocks + make_accumulator(found, std::min(a, b), H_.dof(a) * H_.dof(b));
          const auto accumulator =
              accumulator_of_block.empty() ? accumulator_of_block.end() : accumulator_of_block.find(found);
          destination_[at(g)].push_back(
              {accumulator == accumulator_of_block.end() ? found : accumulator->second, before < 0});
        }
      }
    }
  }
  placeAccumulators();
  clearUntouched(touched);
}

/// Makes places for accumulators of diagonal blocks, after those of the blocks of the structure.
void NormalEquations::placeAccumulators() {
  accumulator_values_.resize(accumulator_size_);
  if (accumulators_.empty()) place_of_.clear();
  place_.resize(at(structure_->blockCount()));
  for (const Accumulator& accumulator : accumulators_) {
    double* const values = accumulator_values_.data() + accumulator.start;
    const bool is_diagonal = H_.row(accumulator.block) == accumulator.column;
    place_.push_back(is_diagonal ? Place{accumulator.column, values,
                                         values + H_.dof(accumulator.column) * H_.dof(accumulator.column)}
                                 : Place{});
  }
}

/// Sets the blocks off the diagonal to which no measurement adds to 0, once. `partition`: the last one that adds to
/// each block, or -1.
void NormalEquations::clearUntouched(const std::vector<signed char>& partition) {
  for (int j = 0; j < H_.columns(); ++j) {
    for (int k = H_.begin(j) + 1; k < H_.begin(j + 1); ++k) {
      if (partition[at(k)] < 0) clear(H_.values(k), H_.dof(j) * H_.dof(H_.row(k)));
    }
  }
}

/// Sets H and g to zero. The first measurement that adds to a block off the diagonal clears it, while it is in the
/// cache.
void NormalEquations::setZero() {
  std::fill_n(H_.values(0), H_.diagonalSize(), 0.0);
  std::fill_n(accumulator_values_.data(), accumulator_size_, 0.0);
  gradient_.setZero();
}

void NormalEquations::addUp() {
  for (const Accumulator& accumulator : accumulators_) {
    const int dof = H_.dof(accumulator.column), row = H_.row(accumulator.block);
    const double* const values = accumulator_values_.data() + accumulator.start;
    addTo(H_.values(accumulator.block), values, dof * H_.dof(row));
    if (row == accumulator.column) addTo(gradient_.data() + offset_[at(row)], values + dof * dof, dof);
  }
  diagonal_.resize(gradient_.size());
  for (int j = 0; j < H_.columns(); ++j) {
    const double* const block = H_.values(H_.begin(j));
    for (int i = 0; i < H_.dof(j); ++i) diagonal_[offset_[at(j)] + i] = block[i * H_.dof(j) + i];
  }
}

/// Returns the entries of a block of H, or of a private accumulator; accumulators are numbered after the blocks.
const double* NormalEquations::values(int block) const {
  const int blocks = H_.begin(H_.columns());
  return block < blocks ? H_.values(block)
                        : accumulator_values_.data() + accumulators_[at(block - blocks)].start;
}

/// Returns the entries of a block off the diagonal, set to zero if nothing has been added to it yet.
double* NormalEquations::begun(Destination destination, int size) {
  double* const entries = values(destination.block);
  if (destination.is_first) clear(entries, size);
  return entries;
}

const int* NormalEquations::placesOf(int group) const {
  return place_of_.empty() ? structure_->groups[at(group)].blocks.data() : place_of_[at(group)].data();
}

/// Measurements of two free variables, of the same shape, that one call of a kernel adds.
struct NormalEquations::Pairs {
  static constexpr int kMost = 8;
  int rows = 0, later_dof = 0, earlier_dof = 0, count = 0;
  bool has_kernel = false;
  dense::PairProduct pair[kMost];
};

/// Appends a measurement to those that are added together, with the same bits as product by product. Returns false if
/// no kernel does that, or if its shape differs from theirs.
bool NormalEquations::append(const dense::Kernels& kernel, int rows, const int* places, const int* dof,
                             Destination destination, const double* J, const double* r, Pairs& pairs) {
  if (places[0] < 0 || places[1] < 0 || places[0] == places[1]) return false;
  const Place &first = place_[at(places[0])], &second = place_[at(places[1])];
  const bool is_first_later = first.column > second.column;
  const Place &later = is_first_later ? first : second, &earlier = is_first_later ? second : first;
  const int later_dof = dof[is_first_later ? 0 : 1], earlier_dof = dof[is_first_later ? 1 : 0];
  if (pairs.rows != rows || pairs.later_dof != later_dof || pairs.earlier_dof != earlier_dof) {
    if (pairs.count > 0) return false;
    pairs.rows = rows;
    pairs.later_dof = later_dof;
    pairs.earlier_dof = earlier_dof;
    pairs.has_kernel = kernel.addPairs(rows, later_dof, earlier_dof, 0, nullptr);
  }
  if (!pairs.has_kernel) return false;
  const double* const J_second = J + static_cast<std::ptrdiff_t>(rows) * dof[0];
  double* const block = values(destination.block);
  pairs.pair[pairs.count++] = {is_first_later ? J : J_second,
                               is_first_later ? J_second : J,
                               r,
                               later.diagonal,
                               earlier.diagonal,
                               block,
                               later.gradient,
                               earlier.gradient,
                               destination.is_first != 0};
  dense::prefetch(later.diagonal, later.diagonal + 1);
  dense::prefetch(earlier.diagonal, earlier.diagonal + 1);
  dense::prefetch(block, block + later_dof * earlier_dof);
  return true;
}

void NormalEquations::addAll(const dense::Kernels& kernel, Pairs& pairs) {
  if (pairs.count > 0)
    kernel.addPairs(pairs.rows, pairs.later_dof, pairs.earlier_dof, pairs.count, pairs.pair);
  pairs.count = 0;
}

/// Adds the products of a measurement one by one.
void NormalEquations::addEach(const dense::Kernels& kernel, int arity, int rows, const int* places,
                              const int* dof, const Destination* destination, const double* J,
                              const double* r) {
  const auto add_product = kernel.addProduct;
  for (int k = 0; k < arity; ++k) {
    const double* const Jk = J;
    J += static_cast<std::ptrdiff_t>(rows) * dof[k];
    if (places[k] < 0) {
      destination += arity - 1 - k;
      continue;
    }
    const Place& place = place_[at(places[k])];
    add_product(rows, dof[k], 1, Jk, r, place.gradient);
    add_product(rows, dof[k], dof[k], Jk, Jk, place.diagonal);
    const double* Jl = J;
    for (int l = k + 1; l < arity; ++l, ++destination) {
      const double* const Jl_here = Jl;
      Jl += static_cast<std::ptrdiff_t>(rows) * dof[l];
      if (places[l] < 0) continue;
      const int other = place_[at(places[l])].column;
      double* const H = begun(*destination, dof[k] * dof[l]);
      if (other >= place.column) add_product(rows, dof[l], dof[k], Jl_here, Jk, H);
      if (other <= place.column) add_product(rows, dof[k], dof[l], Jk, Jl_here, H);
    }
  }
}

/// The shape of measurements of the same variables, such as all points of a curve. Their rows are put below each other,
/// and one product adds them.
struct NormalEquations::Stack {
  static constexpr int kMostRows = 64, kMostColumns = 16, kFewest = 4;
  int arity = 0, rows = 0, width = 0, columns = 0;  ///< columns: those of free variables

  /// Takes the shape of a measurement. Returns whether such measurements can be stacked.
  bool take(int own_arity, int own_rows, const int* places, const int* dof) {
    *this = {own_arity, own_rows};
    for (int k = 0; k < arity; ++k) {
      width += dof[k];
      if (places[k] < 0) continue;
      columns += dof[k];
      for (int l = 0; l < k; ++l) {
        if (places[l] == places[k]) return false;
      }
    }
    return rows > 0 && rows * kFewest <= kMostRows && columns <= kMostColumns;
  }
  int most() const { return kMostRows / rows; }
};

/// Adds `count` measurements, not more than stack.most(), at once.
void NormalEquations::addStack(const dense::Kernels& kernel, const Stack& stack, int count, const int* places,
                               const int* dof, const Destination* destination, const double* J,
                               const double* r) {
  constexpr int stride = Stack::kMostRows;
  alignas(64) double S[(Stack::kMostColumns + 1) * stride];
  double P[(Stack::kMostColumns + 1) * (Stack::kMostColumns + 1)];
  const int rows = count * stack.rows, n = stack.columns + 1;
  const int padded = (rows + dense::kGramRows - 1) / dense::kGramRows * dense::kGramRows;
  double* to = S;
  const double* from = J;
  for (int k = 0; k < stack.arity; from += stack.rows * dof[k++]) {
    for (int c = 0; places[k] >= 0 && c < dof[k]; ++c, to += stride) {
      const double* entry = from + c * stack.rows;
      for (int m = 0; m < count; ++m, entry += stack.rows * stack.width)
        for (int i = 0; i < stack.rows; ++i) to[m * stack.rows + i] = entry[i];
    }
  }
  std::copy_n(r, rows, to);
  for (int c = 0; c < n; ++c) std::fill(S + c * stride + rows, S + c * stride + padded, 0.0);
  kernel.gram(padded, n, stride, S, P);

  const auto product = [&](int i, int j) { return P[std::max(i, j) * n + std::min(i, j)]; };
  for (int k = 0, a = 0; k < stack.arity; ++k) {
    const bool is_free = places[k] >= 0;
    const Place* const place = is_free ? &place_[at(places[k])] : nullptr;
    for (int j = 0; is_free && j < dof[k]; ++j) {
      place->gradient[j] += product(n - 1, a + j);
      for (int i = 0; i < dof[k]; ++i) place->diagonal[j * dof[k] + i] += product(a + i, a + j);
    }
    int b = a + (is_free ? dof[k] : 0);
    for (int l = k + 1; l < stack.arity; ++l, ++destination) {
      if (places[l] < 0) continue;
      if (is_free) {
        const bool is_below = place_[at(places[l])].column > place->column;
        double* H = begun(*destination, dof[k] * dof[l]);
        const int rows_first = is_below ? b : a, columns_first = is_below ? a : b;
        for (int j = 0; j < dof[is_below ? k : l]; ++j)
          for (int i = 0; i < dof[is_below ? l : k]; ++i) *H++ += product(rows_first + i, columns_first + j);
      }
      b += dof[l];
    }
    if (is_free) a += dof[k];
  }
}

/// Returns how many measurements have the variables and the shape of the first, up to `count`.
static int alike(const int* places, const int* dof, const int* rows, int arity, int count) {
  int n = 1;
  while (n < count && rows[n] == rows[0] && std::equal(places, places + arity, places + n * arity) &&
         std::equal(dof, dof + arity, dof + n * arity))
    ++n;
  return n;
}

void NormalEquations::add(const JacobianBatch& batch) {
  const dense::Kernels& kernel = dense::kernels();
  const int arity = structure_->groups[at(batch.group)].arity, products = arity * (arity - 1) / 2;
  const double* r = batch.r;
  const double* J = batch.J;
  const Destination* destination = destination_[at(batch.group)].data() + at(batch.first) * at(products);
  const int* places = placesOf(batch.group) + at(batch.first) * at(arity);
  const int* dof = batch.dof;
  Pairs pairs;
  Stack stack;
  for (int m = 0, count = 1; m < batch.count; m += count) {
    const int rows = batch.rows[m];
    count = alike(places, dof, batch.rows + m, arity, batch.count - m);
    if (count >= Stack::kFewest && stack.take(arity, rows, places, dof)) {
      addAll(kernel, pairs);
      count = std::min(count, stack.most());
      addStack(kernel, stack, count, places, dof, destination, J, r);
    } else {
      count = 1;
      if (arity != 2 || !append(kernel, rows, places, dof, *destination, J, r, pairs)) {
        addAll(kernel, pairs);
        if (arity != 2 || !append(kernel, rows, places, dof, *destination, J, r, pairs))
          addEach(kernel, arity, rows, places, dof, destination, J, r);
      }
      if (pairs.count == Pairs::kMost) addAll(kernel, pairs);
    }
    for (int k = 0; k < arity; ++k) J += static_cast<std::ptrdiff_t>(count) * rows * dof[k];
    r += count * rows;
    places += count * arity;
    dof += count * arity;
    destination += count * products;
  }
  addAll(kernel, pairs);
}

double NormalEquations::squaredNormOfJd(const Eigen::VectorXd& d) const {
  return H_.squaredForm(offset_, d.data());
}

}  // namespace slom
