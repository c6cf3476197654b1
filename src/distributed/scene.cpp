#include "slom/distributed/scene.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "distributed/container.hpp"
#include "distributed/countable.hpp"
#include "distributed/index.hpp"
#include "distributed/messages.hpp"
#include "distributed/partition.hpp"
#include "mtk/error.hpp"
#include "slom/io/bal_part.hpp"
#include "slom/io/numbered_lines.hpp"

namespace slom::distributed {

namespace {

using io::BalNumber;
using io::BalObservation;

/// The division of `count` items with numbers from 0 into equal ranges.
struct EqualRanges {
  std::int64_t count, processes;
  int processOf(int item) const {
    return int((std::int64_t(item) * processes) / std::max<std::int64_t>(count, 1));
  }
};

class SceneReader {
 public:
  SceneReader(const Processes& processes, const std::string& file) : processes_(processes), file_(file) {}

  ScenePart read() {
    bool is_container = false;
    processes_.agree([&] { is_container = io::isContainer(file_); });
    if (is_container) {
      readOwnPartOfContainer();
    } else {
      readOwnPartOfText();
    }
    const std::vector<mtk::vect<3>> points = placePoints();
    placeCameras();
    return finish(points);
  }

 private:
  void readOwnPartOfContainer() {
    processes_.agree([&] {
      const io::Container container(file_);
      counts_ = io::readBalCounts(container);
    });
    requireCountable(file_, 2 * counts_.observations, "residuals", "give a smaller scene");
    requireWhole(processes_, file_);
    processes_.agree(
        [&] { own_ = io::readBalPart(io::Container(file_), processes_.rank(), processes_.size()); });
  }

  void readOwnPartOfText() {
    io::PartOfFile part;
    processes_.agree([&] { part = io::readLinesOfPart(file_, processes_.rank(), processes_.size()); });
    const auto [lines_before, lines] = countBefore(part.line_count);
    requireCountable(file_, lines, "lines", "give a container with the same numbers");
    part.lines.shift(int(lines_before));
    io::BalPlace place;
    std::tie(place.first_word, place.word_count) = countBefore(io::countBalWords(part.lines));
    if (place.word_count == 0) io::refuseEmptyBal(file_);
    processes_.agree([&] {
      if (place.first_word == 0 && part.lines.size() > 0) counts_ = io::readBalCounts(file_, part.lines);
    });
    counts_.cameras = int(processes_.max(counts_.cameras));
    counts_.points = int(processes_.max(counts_.points));
    counts_.observations = std::int64_t(processes_.max(double(counts_.observations)));
    place.counts = counts_;
    requireCountable(file_, 2 * counts_.observations, "residuals", "give a smaller scene");
    processes_.agree([&] { io::parseBal(file_, part.lines, place, own_); });
  }

  /// Returns the sums of the counts of the processes before this one, and of all.
  std::pair<std::int64_t, std::int64_t> countBefore(std::int64_t count) const {
    const std::vector<std::int64_t> all = gathered(processes_, std::vector<std::int64_t>{count});
    return {std::accumulate(all.begin(), all.begin() + processes_.rank(), std::int64_t{0}),
            std::accumulate(all.begin(), all.end(), std::int64_t{0})};
  }

  /// Divides the cameras among the processes, such that cameras with common points stay together. `collected`: all
  /// observations of some points, point by point.
  void divideCameras(const std::vector<BalObservation>& collected) {
    constexpr std::size_t linked = 4;  // a camera is linked with the next ones that see the point
    std::map<std::pair<int, int>, std::int64_t> weights;
    for (std::size_t i = 0; i < collected.size(); ++i) {
      ++weights[{collected[i].camera, collected[i].camera}];
      for (std::size_t k = i + 1; k < std::min(collected.size(), i + 1 + linked); ++k) {
        const int a = collected[i].camera, b = collected[k].camera;
        if (collected[k].point == collected[i].point && a != b) ++weights[{std::min(a, b), std::max(a, b)}];
      }
    }
    std::vector<Link> links;
    for (const auto& [cameras, weight] : weights) links.push_back({cameras.first, cameras.second, weight});
    const EqualRanges rows{counts_.cameras, processes_.size()};
    std::int64_t count = 0;
    for (int camera = 0; camera < counts_.cameras; ++camera)
      count += rows.processOf(camera) == processes_.rank();
    process_of_camera_ = gathered(processes_, partitioned(processes_, count, links));
  }

  /// Brings the points to the processes that have most of their cameras, with their observations. Returns their values.
  std::vector<mtk::vect<3>> placePoints() {
    // First to a process that collects all of a point.
    const auto P = std::size_t(processes_.size());
    const EqualRanges collectors{counts_.points, processes_.size()};
    std::vector<std::vector<BalObservation>> seen_to(P);
    for (const BalObservation& seen : own_.observations)
      seen_to[at(collectors.processOf(seen.point))].push_back(seen);
    own_.observations = {};
    std::vector<std::vector<BalNumber>> entries_to(P);
    for (const BalNumber& entry : own_.points)
      entries_to[at(collectors.processOf(entry.item))].push_back(entry);
    own_.points = {};
    std::vector<BalObservation> collected = joined(exchanged(processes_, std::move(seen_to)));
    const std::vector<BalNumber> entries = joined(exchanged(processes_, std::move(entries_to)));
    std::sort(collected.begin(), collected.end(), [](const BalObservation& a, const BalObservation& b) {
      return std::pair(a.point, a.number) < std::pair(b.point, b.number);
    });
    divideCameras(collected);
    // Then to its own process.
    seen_to.assign(P, {});
    entries_to.assign(P, {});
    std::vector<std::pair<int, int>> process_of;  // point and its process, by point
    for (std::size_t begin = 0, end = 0; begin < collected.size(); begin = end) {
      std::vector<int> votes(P, 0);
      for (; end < collected.size() && collected[end].point == collected[begin].point; ++end)
        ++votes[at(process_of_camera_[at(collected[end].camera)])];
      const auto process = std::max_element(votes.begin(), votes.end()) - votes.begin();
      process_of.emplace_back(collected[begin].point, int(process));
      auto& to = seen_to[std::size_t(process)];
      to.insert(to.end(), collected.begin() + std::ptrdiff_t(begin), collected.begin() + std::ptrdiff_t(end));
    }
    collected = {};
    processes_.agree([&] {
      for (const BalNumber& entry : entries) {
        const auto found = std::lower_bound(process_of.begin(), process_of.end(), std::pair(entry.item, 0));
        if (found == process_of.end() || found->first != entry.item) refuseUnseen("point", entry.item);
        entries_to[at(found->second)].push_back(entry);
      }
    });
    own_.observations = joined(exchanged(processes_, std::move(seen_to)));
    std::sort(own_.observations.begin(), own_.observations.end(),
              [](const BalObservation& a, const BalObservation& b) { return a.number < b.number; });
    for (const BalObservation& seen : own_.observations) part_.points.push_back(seen.point);
    makeUnique(part_.points);
    std::vector<mtk::vect<3>> values(part_.points.size());
    for (const BalNumber& entry : joined(exchanged(processes_, std::move(entries_to))))
      values[placeOf(part_.points, entry.item)][entry.part] = entry.value;
    return values;
  }

  /// Fetches the cameras that see the points of this process.
  void placeCameras() {
    const auto P = std::size_t(processes_.size());
    std::vector<std::vector<BalNumber>> entries_to(P);
    for (const BalNumber& entry : own_.cameras)
      entries_to[at(process_of_camera_[at(entry.item)])].push_back(entry);
    own_.cameras = {};
    std::unordered_map<int, std::array<double, io::bal_camera_size>> known;
    for (const auto& part : exchanged(processes_, std::move(entries_to))) {
      for (const BalNumber& entry : part) known[entry.item][at(entry.part)] = entry.value;
    }
    for (const BalObservation& seen : own_.observations) part_.cameras.push_back(seen.camera);
    makeUnique(part_.cameras);
    std::vector<std::vector<int>> wanted(P);
    for (const int camera : part_.cameras) wanted[at(process_of_camera_[at(camera)])].push_back(camera);
    struct Reply {
      int camera;
      std::array<double, io::bal_camera_size> numbers;
    };
    std::vector<std::vector<Reply>> replies(P);
    std::unordered_map<int, char> is_seen;
    const auto requested = exchanged(processes_, wanted);
    for (std::size_t p = 0; p < P; ++p) {
      for (const int camera : requested[p]) {
        is_seen[camera] = 1;
        replies[p].push_back({camera, known.at(camera)});
      }
    }
    processes_.agree([&] {
      int unseen = std::numeric_limits<int>::max();
      for (const auto& [camera, numbers] : known) {
        if (is_seen.count(camera) == 0) unseen = std::min(unseen, camera);
      }
      if (unseen < std::numeric_limits<int>::max()) refuseUnseen("camera", unseen);
    });
    part_.scene.cameras.resize(part_.cameras.size());
    for (const auto& part : exchanged(processes_, replies)) {
      for (const Reply& reply : part) {
        part_.scene.cameras[placeOf(part_.cameras, reply.camera)] = io::cameraFromBal(reply.numbers);
      }
    }
    for (const int camera : part_.cameras)
      part_.own_cameras.push_back(process_of_camera_[at(camera)] == processes_.rank());
  }

  ScenePart finish(const std::vector<mtk::vect<3>>& points) {
    part_.scene.file = file_;
    part_.scene.points = points;
    part_.scene.observations.reserve(own_.observations.size());
    part_.observations.reserve(own_.observations.size());
    for (const BalObservation& seen : own_.observations) {
      io::Observation& observation = part_.scene.observations.emplace_back();
      observation.camera = int(placeOf(part_.cameras, seen.camera));
      observation.point = int(placeOf(part_.points, seen.point));
      observation.line = seen.line;
      observation.pixel = mtk::vect<2>(seen.u, seen.v);
      part_.observations.push_back(seen.number);
    }
    part_.camera_count = counts_.cameras;
    part_.point_count = counts_.points;
    part_.observation_count = counts_.observations;
    return std::move(part_);
  }

  [[noreturn]] void refuseUnseen(const char* kind, int number) const {
    throw mtk::Error(
        "slom.io.bad-scene",
        fmt::format("{}: {} {} has no observation, so nothing determines it; add observations, or remove it",
                    file_, kind, number),
        file_);
  }
  /// Returns the lists one after another.
  template <class T>
  static std::vector<T> joined(std::vector<std::vector<T>> lists) {
    std::vector<T> all;
    std::size_t size = 0;
    for (const std::vector<T>& list : lists) size += list.size();
    all.reserve(size);
    for (std::vector<T>& list : lists) {
      all.insert(all.end(), list.begin(), list.end());
      list = {};
    }
    return all;
  }
  /// Sorts the numbers and keeps each once.
  static void makeUnique(std::vector<int>& numbers) {
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    numbers.shrink_to_fit();
  }
  static std::size_t placeOf(const std::vector<int>& numbers, int number) {
    return std::size_t(std::lower_bound(numbers.begin(), numbers.end(), number) - numbers.begin());
  }

  const Processes& processes_;
  const std::string& file_;
  io::BalCounts counts_;
  io::BalPart own_;  // numbers that are here on their way
  std::vector<int> process_of_camera_;
  ScenePart part_;
};

}  // namespace

ScenePart readScene(const Processes& processes, const std::string& file) {
  return SceneReader(processes, file).read();
}

}  // namespace slom::distributed
