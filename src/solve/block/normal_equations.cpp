#include "normal_equations.hpp"

#include <algorithm>
#include <unordered_map>

#include "base/index.hpp"
#include "solve/dense/kernels.hpp"
#include "solve/dense/prefetch.hpp"

namespace slom {

namespace {
/// Measurements after which what is fetched is needed.
constexpr int kMeasurementsAhead = 4;

/// Parts of the measurements: at most 2^kMostHalvings, each of kFewestInPart measurements or more, which begin at multiples of
/// what the linearisation takes at a time, and with so few numbers of their own for each product that is added.
constexpr int kMostHalvings = 4, kFewestInPart = 256, kPartAlignment = 64;
constexpr double kMostOwnPerProduct = 1.0 / 8;

/// For a few numbers faster than std::fill_n, which calls memset.
void clear(double* x, int n) { Eigen::Map<Eigen::VectorXd>(x, n).setZero(); }

void addTo(double* sum, const double* x, int n) {
  Eigen::Map<Eigen::VectorXd>(sum, n) += Eigen::Map<const Eigen::VectorXd>(x, n);
}

/// The products that measurement m adds to the blocks of H.
double productsOf(const BlockStructure& structure, const MeasurementGroup& group, int m) {
  double sum = 0, before = 0;
  for (int k = 0; k < group.arity; ++k) {
    const int block = group.blocks[at(m) * at(group.arity) + at(k)];
    const double dof = block < 0 ? 0 : structure.dof(block);
    sum += dof * (dof + before);
    before += dof;
  }
  return sum;
}

/// The part that the measurement is in, which is not before `part`.
int partOf(const std::vector<MeasurementPlace>& parts, int part, const MeasurementPlace& measurement) {
  const auto begins = [&](const MeasurementPlace& next) {
    return std::pair(next.group, next.index) <= std::pair(measurement.group, measurement.index);
  };
  while (at(part + 1) < parts.size() && begins(parts[at(part + 1)])) ++part;
  return part;
}

/// Cuts the measurements into at most `count` parts of about the same work; returns where they begin.
std::vector<MeasurementPlace> cut(const BlockStructure& structure, int count) {
  const auto workOf = [&](const MeasurementGroup& group) {
    return group.size() == 0 ? 0.0 : productsOf(structure, group, 0) * group.size();
  };
  double total = 0;
  for (const MeasurementGroup& group : structure.groups) total += workOf(group);
  std::vector<MeasurementPlace> parts{{0, 0}};
  double before = 0;
  for (int g = 0; g < static_cast<int>(structure.groups.size()); ++g) {
    const MeasurementGroup& group = structure.groups[at(g)];
    const double work = workOf(group);
    while (work > 0) {
      const double share = (total * static_cast<double>(parts.size()) / count - before) / work;
      const int index = static_cast<int>(share * group.size() / kPartAlignment) * kPartAlignment;
      if (share >= 1 || index >= group.size() || static_cast<int>(parts.size()) == count) break;
      parts.push_back({g, index});
    }
    before += work;
  }
  return parts;
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
  chooseParts();
  findDestinations();
}

/// The most parts that have few numbers of their own: one that first meets a block which an earlier part has met has some.
void NormalEquations::chooseParts() {
  parts_.clear();
  int measurements = 0;
  for (const MeasurementGroup& group : structure_->groups) measurements += group.size();
  int halvings = 0;
  while (halvings < kMostHalvings && measurements >> (halvings + 1) >= kFewestInPart) ++halvings;
  if (halvings == 0) return;
  const std::vector<MeasurementPlace> finest = cut(*structure_, 1 << halvings);
  double products = 0, own[kMostHalvings] = {};  // with a half, a quarter, ... of the parts
  std::vector<signed char> met(at(structure_->blockCount()), -1);
  int part = 0;
  for (int g = 0; g < static_cast<int>(structure_->groups.size()); ++g) {
    const MeasurementGroup& group = structure_->groups[at(g)];
    const int* block = group.blocks.data();
    for (int m = 0; m < group.size(); ++m) {
      part = partOf(finest, part, {g, m});
      products += productsOf(*structure_, group, m);
      for (int k = 0; k < group.arity; ++k, ++block) {
        if (*block < 0) continue;
        const int before = std::exchange(met[at(*block)], static_cast<signed char>(part));
        if (before < 0 || before == part) continue;
        const double dof = structure_->dof(*block);
        for (int s = 0; s < halvings && before >> s != part >> s; ++s) own[s] += dof * (dof + 1);
      }
    }
  }
  int s = 0;
  while (s < halvings && own[s] > kMostOwnPerProduct * products) ++s;
  if (s == halvings) return;
  for (std::size_t p = 0; p < finest.size(); p += std::size_t{1} << s) parts_.push_back(finest[p]);
}

void NormalEquations::findDestinations() {
  const int blocks = H_.begin(H_.columns()), count = structure_->blockCount();
  destination_.assign(structure_->groups.size(), {});
  place_of_.assign(parts_.empty() ? 0 : structure_->groups.size(), {});
  own_.clear();
  own_size_ = 0;
  std::vector<signed char> met(at(count), -1), touched(at(blocks), -1);  // by which part
  std::vector<int> place(at(count));                                     // for the part
  std::unordered_map<int, int> own_of_block;                             // off the diagonal, of the part
  const auto make_own = [&](int block, int column, int size) {
    own_.push_back({block, column, own_size_});
    own_size_ += at(size);
    return static_cast<int>(own_.size()) - 1;
  };
  int part = 0;
  for (int g = 0; g < static_cast<int>(structure_->groups.size()); ++g) {
    const MeasurementGroup& group = structure_->groups[at(g)];
    destination_[at(g)].reserve(at(group.size()) * at(group.arity * (group.arity - 1) / 2));
    if (!parts_.empty()) place_of_[at(g)].reserve(group.blocks.size());
    for (int m = 0; m < group.size(); ++m) {
      part = partOf(parts_, part, {g, m});
      const int* block = group.blocks.data() + at(m) * at(group.arity);
      for (int k = 0; k < group.arity; ++k) {
        const int b = block[k];
        if (b >= 0 && met[at(b)] != part) {
          const int dof = structure_->dof(b);
          place[at(b)] =
              met[at(b)] < 0 ? b : count + make_own(H_.begin(position(b)), position(b), dof * (dof + 1));
          met[at(b)] = static_cast<signed char>(part);
        }
        if (!parts_.empty()) place_of_[at(g)].push_back(b < 0 ? b : place[at(b)]);
      }
      for (int k = 0; k < group.arity; ++k) {
        for (int l = k + 1; l < group.arity; ++l) {
          if (block[k] < 0 || block[l] < 0) {
            destination_[at(g)].push_back({-1, 0});
            continue;
          }
          const int a = position(block[k]), b = position(block[l]);
          if (a == b) {
            const int own = place[at(block[k])] - count;
            destination_[at(g)].push_back({own < 0 ? H_.begin(a) : blocks + own, 0});
            continue;
          }
          const int found = H_.find(std::max(a, b), std::min(a, b));
          const int before = std::exchange(touched[at(found)], static_cast<signed char>(part));
          if (before >= 0 && before != part)
            own_of_block[found] = blocks + make_own(found, std::min(a, b), H_.dof(a) * H_.dof(b));
          const auto own = own_of_block.empty() ? own_of_block.end() : own_of_block.find(found);
          destination_[at(g)].push_back({own == own_of_block.end() ? found : own->second, before < 0});
        }
      }
    }
  }
  own_values_.resize(own_size_);
  if (own_.empty()) place_of_.clear();
  place_.resize(at(count));
  for (const Own& own : own_) {
    double* const values = own_values_.data() + own.start;
    const bool is_diagonal = H_.row(own.block) == own.column;
    place_.push_back(is_diagonal ? Place{own.column, values, values + H_.dof(own.column) * H_.dof(own.column)}
                                 : Place{});
  }
  for (int j = 0; j < H_.columns(); ++j) {  // what nothing is ever added to
    for (int k = H_.begin(j) + 1; k < H_.begin(j + 1); ++k) {
      if (touched[at(k)] < 0) clear(H_.values(k), H_.dof(j) * H_.dof(H_.row(k)));
    }
  }
}

/// The blocks off the diagonal get their zeros when something is added to them first: then they are in the
/// cache.
void NormalEquations::setZero() {
  std::fill_n(H_.values(0), H_.diagonalSize(), 0.0);
  std::fill_n(own_values_.data(), own_size_, 0.0);
  gradient_.setZero();
}

void NormalEquations::addUp() {
  for (const Own& own : own_) {
    const int dof = H_.dof(own.column), row = H_.row(own.block);
    const double* const values = own_values_.data() + own.start;
    addTo(H_.values(own.block), values, dof * H_.dof(row));
    if (row == own.column) addTo(gradient_.data() + offset_[at(row)], values + dof * dof, dof);
  }
  diagonal_.resize(gradient_.size());
  for (int j = 0; j < H_.columns(); ++j) {
    const double* const block = H_.values(H_.begin(j));
    for (int i = 0; i < H_.dof(j); ++i) diagonal_[offset_[at(j)] + i] = block[i * H_.dof(j) + i];
  }
}

/// The numbers of a block of H, or of one of a part's own.
const double* NormalEquations::values(int block) const {
  const int blocks = H_.begin(H_.columns());
  return block < blocks ? H_.values(block) : own_values_.data() + own_[at(block - blocks)].start;
}

/// The numbers of a block off the diagonal, which have a value.
double* NormalEquations::begun(Destination destination, int size) {
  double* const numbers = values(destination.block);
  if (destination.is_first) clear(numbers, size);
  return numbers;
}

const int* NormalEquations::placesOf(int group) const {
  return place_of_.empty() ? structure_->groups[at(group)].blocks.data() : place_of_[at(group)].data();
}

/// What a measurement of two free variables adds, at once, to the same bits as one after the other. Returns false, with
/// nothing added, where that is not possible.
bool NormalEquations::addPair(const dense::Kernels& kernel, int rows, const int* places, const int* dof,
                              Destination destination, const double* J, const double* r) {
  if (places[0] < 0 || places[1] < 0 || places[0] == places[1]) return false;
  const Place* const place[] = {&place_[at(places[0])], &place_[at(places[1])]};
  const int later = place[0]->column > place[1]->column ? 0 : 1, earlier = 1 - later;
  const dense::PairTarget to{place[later]->diagonal, place[earlier]->diagonal, values(destination.block),
                             place[later]->gradient, place[earlier]->gradient, destination.is_first != 0};
  const double* const of[] = {J, J + static_cast<std::ptrdiff_t>(rows) * dof[0]};
  return kernel.addPair(rows, dof[later], dof[earlier], of[later], of[earlier], r, to);
}

/// Where a measurement of two variables will add to.
void NormalEquations::prefetch(const int* places, Destination destination) const {
  for (int k = 0; k < 2; ++k) {
    if (places[k] < 0) return;
    const Place& place = place_[at(places[k])];
    dense::prefetch(place.diagonal, place.diagonal + 1);
  }
  if (destination.block < H_.begin(H_.columns()))
    dense::prefetch(H_.values(destination.block), H_.values(destination.block + 1));
}

void NormalEquations::add(const JacobianBatch& batch) {
  const dense::Kernels& kernel = dense::kernels();
  const auto add_product = kernel.addProduct;
  const int arity = structure_->groups[at(batch.group)].arity;
  const double* r = batch.r;
  const double* J = batch.J;
  const Destination* destination =
      destination_[at(batch.group)].data() + at(batch.first) * at(arity * (arity - 1) / 2);
  const int* places = placesOf(batch.group) + at(batch.first) * at(arity);
  const int* dof = batch.dof;
  for (int m = 0; m < batch.count; ++m, places += arity, dof += arity) {
    const int rows = batch.rows[m];
    if (arity == 2 && m + kMeasurementsAhead < batch.count)
      prefetch(places + 2 * kMeasurementsAhead, destination[kMeasurementsAhead]);
    if (arity == 2 && addPair(kernel, rows, places, dof, *destination, J, r)) {
      ++destination;
      J += static_cast<std::ptrdiff_t>(rows) * (dof[0] + dof[1]);
      r += rows;
      continue;
    }
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
    r += rows;
  }
}

double NormalEquations::squaredNormOfJd(const Eigen::VectorXd& d) const {
  return H_.squaredForm(offset_, d.data());
}

}  // namespace slom
