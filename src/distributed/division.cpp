#include "distributed/division.hpp"

#include <algorithm>
#include <numeric>

#include "distributed/index.hpp"
#include "distributed/messages.hpp"
#include "distributed/partition.hpp"

namespace slom::distributed {

namespace {

struct SampleOfIds {
  std::uint64_t id, count;
};

/// Returns the place of an id in an ascending list; -1 if it is not there.
std::int64_t placeIn(const std::vector<std::uint64_t>& ids, std::uint64_t id) {
  const auto found = std::lower_bound(ids.begin(), ids.end(), id);
  return found == ids.end() || *found != id ? -1 : found - ids.begin();
}

void sortUnique(std::vector<std::uint64_t>& ids) {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

}  // namespace

IdRanges::IdRanges(const Processes& processes, std::vector<std::uint64_t> ids) {
  constexpr std::size_t most_samples = 1024;
  std::sort(ids.begin(), ids.end());
  std::vector<SampleOfIds> own;
  const std::size_t samples = std::min(most_samples, ids.size());
  for (std::size_t i = 0; i < samples; ++i) {
    const std::size_t begin = ids.size() * i / samples, end = ids.size() * (i + 1) / samples;
    own.push_back({ids[begin], end - begin});
  }
  std::vector<SampleOfIds> all = gathered(processes, own);
  std::stable_sort(all.begin(), all.end(),
                   [](const SampleOfIds& a, const SampleOfIds& b) { return a.id < b.id; });
  std::uint64_t total = 0, before = 0;
  for (const SampleOfIds& sample : all) total += sample.count;
  for (const SampleOfIds& sample : all) {
    const auto P = std::uint64_t(processes.size());
    while (first_.size() + 1 < P && before >= total * (first_.size() + 1) / P) first_.push_back(sample.id);
    before += sample.count;
  }
}

int IdRanges::processOf(std::uint64_t id) const {
  return int(std::upper_bound(first_.begin(), first_.end(), id) - first_.begin());
}

/// Sorts ids, and returns what the processes of their ranges answer to each.
template <class F>
std::vector<std::int64_t> Division::ask(std::vector<std::uint64_t>& ids, const F& answer) const {
  sortUnique(ids);
  std::vector<std::vector<std::uint64_t>> asked(at(processes_.size()));
  for (const std::uint64_t id : ids) asked[at(ranges_.processOf(id))].push_back(id);
  std::vector<std::vector<std::int64_t>> answers;
  for (const auto& part : exchanged(processes_, asked)) {
    std::vector<std::int64_t>& to = answers.emplace_back();
    for (const std::uint64_t id : part) to.push_back(answer(id));
  }
  // Ranges ascend with the processes, so the answers come in the order of the ids.
  std::vector<std::int64_t> all;
  for (const auto& part : exchanged(processes_, answers)) all.insert(all.end(), part.begin(), part.end());
  return all;
}

Division::Division(const Processes& processes, const std::vector<std::uint64_t>& vertices,
                   const std::vector<Edge>& edges)
    : processes_(processes), ranges_(processes, vertices) {
  std::vector<std::vector<std::uint64_t>> to_each(at(processes.size()));
  for (const std::uint64_t id : vertices) to_each[at(ranges_.processOf(id))].push_back(id);
  for (const auto& part : exchanged(processes, to_each))
    vertices_.insert(vertices_.end(), part.begin(), part.end());
  sortUnique(vertices_);
  const std::vector<std::int64_t> counts =
      gathered(processes, std::vector<std::int64_t>{std::int64_t(vertices_.size())});
  const std::int64_t first =
      std::accumulate(counts.begin(), counts.begin() + processes.rank(), std::int64_t{0});
  std::vector<std::uint64_t> ends;
  for (const auto& [from, to] : edges) ends.insert(ends.end(), {from, to});
  const std::vector<std::int64_t> numbers = ask(ends, [&](std::uint64_t id) {
    const std::int64_t place = placeIn(vertices_, id);
    return place < 0 ? -1 : first + place;
  });
  std::vector<Link> links;
  for (const auto& [from, to] : edges) {
    const std::int64_t a = numbers[std::size_t(placeIn(ends, from))],
                       b = numbers[std::size_t(placeIn(ends, to))];
    if (a < 0 || b < 0) continue;
    links.push_back({a, a});
    links.push_back({b, b});
    if (a != b) links.push_back({a, b});
  }
  process_of_vertex_ = partitioned(processes, std::int64_t(vertices_.size()), links);
}

void Division::learn(const std::vector<std::uint64_t>& ids) {
  std::vector<std::uint64_t> unknown;
  for (const std::uint64_t id : ids) {
    if (process_of_.count(id) == 0) unknown.push_back(id);
  }
  const std::vector<std::int64_t> found = ask(unknown, [&](std::uint64_t id) {
    const std::int64_t place = placeIn(vertices_, id);
    return std::int64_t(place < 0 ? processes_.rank() : process_of_vertex_[std::size_t(place)]);
  });
  for (std::size_t i = 0; i < unknown.size(); ++i) process_of_.emplace(unknown[i], int(found[i]));
}

}  // namespace slom::distributed
