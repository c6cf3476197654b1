#include "distributed/block_assembly.hpp"

#include <algorithm>
#include <string>
#include <tuple>

#include "distributed/bytes.hpp"
#include "distributed/index.hpp"

namespace slom::distributed {

namespace {
bool isBefore(const BlockAssembly::Entry& a, const BlockAssembly::Entry& b) {
  return std::tie(a.row, a.column) < std::tie(b.row, b.column);
}
}  // namespace

std::size_t BlockAssembly::entryOf(const Head& head) const {
  const Entry wanted{head.row, head.column, head.rows, head.columns, 0};
  return std::lower_bound(entries_.begin(), entries_.end(), wanted, isBefore)->start;
}

void BlockAssembly::plan(const Processes& processes, const std::vector<Block>& blocks) {
  const int own = processes.rank();
  std::vector<std::string> heads(at(processes.size()));
  entries_.clear();
  routes_.clear();
  const auto route = [&](const Head& head, int owner, int& send) {
    if (owner == own) {
      entries_.push_back({head.row, head.column, head.rows, head.columns, 0});
    } else {
      append(heads[at(owner)], head);
      send = owner;
    }
  };
  for (const Block& block : blocks) {
    Route& now = routes_.emplace_back();
    now.rows = block.rows;
    now.columns = block.columns;
    now.size = block.rows * block.columns;
    route({block.row, block.column, block.rows, block.columns}, block.row_owner, now.send_as_is);
    if (block.row != block.column)
      route({block.column, block.row, block.columns, block.rows}, block.column_owner, now.send_transposed);
  }
  std::vector<std::vector<Head>> received;
  for (const std::string& bytes : processes.exchange(heads)) {
    for (const Head& head : received.emplace_back(valuesOf<Head>(bytes)))
      entries_.push_back({head.row, head.column, head.rows, head.columns, 0});
  }
  std::sort(entries_.begin(), entries_.end(), isBefore);
  const auto same = [](const Entry& a, const Entry& b) { return a.row == b.row && a.column == b.column; };
  entries_.erase(std::unique(entries_.begin(), entries_.end(), same), entries_.end());
  std::size_t size = 0;
  for (Entry& entry : entries_) {
    entry.start = size;
    size += at(entry.rows * entry.columns);
  }
  values_.assign(size, 0.0);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const Block& block = blocks[i];
    if (block.row_owner == own) routes_[i].as_is = entryOf({block.row, block.column, 0, 0});
    if (block.row != block.column && block.column_owner == own)
      routes_[i].transposed = entryOf({block.column, block.row, 0, 0});
  }
  outgoing_.assign(at(processes.size()), {});
  incoming_.assign(at(processes.size()), {});
  for (std::size_t p = 0; p < received.size(); ++p) {
    for (const Head& head : received[p]) incoming_[p].emplace_back(entryOf(head), head.rows * head.columns);
  }
}

void BlockAssembly::begin() {
  std::fill(values_.begin(), values_.end(), 0.0);
  for (std::vector<double>& values : outgoing_) values.clear();
  next_ = 0;
}

/// Adds a column-major block to row-major values.
void BlockAssembly::addTo(double* sum, const double* values, const Route& route, bool is_transposed) {
  for (int j = 0; j < route.columns; ++j) {
    for (int i = 0; i < route.rows; ++i)
      sum[is_transposed ? j * route.rows + i : i * route.columns + j] += *values++;
  }
}

void BlockAssembly::add(const double* values) {
  const Route& route = routes_[next_++];
  if (route.as_is != kNowhere) addTo(&values_[route.as_is], values, route, false);
  if (route.transposed != kNowhere) addTo(&values_[route.transposed], values, route, true);
  for (const bool is_transposed : {false, true}) {
    const int process = is_transposed ? route.send_transposed : route.send_as_is;
    if (process < 0) continue;
    std::vector<double>& to = outgoing_[at(process)];
    to.resize(to.size() + at(route.size), 0.0);
    addTo(to.data() + (to.size() - at(route.size)), values, route, is_transposed);
  }
}

void BlockAssembly::finish(const Processes& processes) {
  if (processes.isAlone()) return;
  std::vector<std::string> bytes;
  for (const std::vector<double>& values : outgoing_)
    bytes.emplace_back(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
  std::vector<std::size_t> sizes;
  for (const auto& blocks : incoming_) {
    std::size_t count = 0;
    for (const auto& [start, size] : blocks) count += at(size);
    sizes.push_back(count * sizeof(double));
  }
  const std::vector<std::string> received = processes.exchange(std::move(bytes), sizes);
  for (std::size_t p = 0; p < received.size(); ++p) {
    const std::vector<double> values = valuesOf<double>(received[p]);
    const double* value = values.data();
    for (const auto& [start, size] : incoming_[p]) {
      for (int i = 0; i < size; ++i) values_[start + at(i)] += *value++;
    }
  }
}

}  // namespace slom::distributed
