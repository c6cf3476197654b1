// The summary of a fit by several processes: what each of them knows of its part, put together. All get the same.
#include <algorithm>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "analyze/fit_tables.hpp"
#include "analyze/misfit.hpp"
#include "estimator/state.hpp"
#include "problem/stated_noise.hpp"

namespace slom {

namespace {

/// Bytes that are written and read in the same order, by processes on machines of one kind.
class Bytes {
 public:
  Bytes() = default;
  explicit Bytes(std::string bytes) : bytes_(std::move(bytes)) {}

  template <class T>
  void put(const T& number) {
    bytes_.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  void put(const std::string& text) {
    put(text.size());
    bytes_ += text;
  }
  template <class T>
  T get() {
    T number;
    std::memcpy(&number, bytes_.data() + at_, sizeof number);
    at_ += sizeof number;
    return number;
  }
  std::string text() {
    const auto size = get<std::size_t>();
    at_ += size;
    return bytes_.substr(at_ - size, size);
  }
  bool isAtEnd() const { return at_ == bytes_.size(); }
  const std::string& all() const { return bytes_; }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

void put(Bytes& bytes, const GroupSummary& group) {
  bytes.put(group.name);
  bytes.put(group.measurements);
  bytes.put(group.residuals);
  bytes.put(group.initial_rss);
  bytes.put(group.final_rss);
  bytes.put(group.derivatives);
  bytes.put(group.losses.size());
  for (const LossSummary& loss : group.losses) {
    bytes.put(loss.loss);
    bytes.put(loss.measurements);
    bytes.put(loss.down_weighted);
    bytes.put(loss.weightless);
  }
}

GroupSummary takeGroup(Bytes& bytes) {
  GroupSummary group;
  group.name = bytes.text();
  group.measurements = bytes.get<int>();
  group.residuals = bytes.get<int>();
  group.initial_rss = bytes.get<double>();
  group.final_rss = bytes.get<double>();
  group.derivatives = bytes.text();
  for (auto losses = bytes.get<std::size_t>(); losses > 0; --losses) {
    LossSummary& loss = group.losses.emplace_back();
    loss.loss = bytes.text();
    loss.measurements = bytes.get<int>();
    loss.down_weighted = bytes.get<int>();
    loss.weightless = bytes.get<int>();
  }
  return group;
}

void addTo(std::vector<LossSummary>& losses, const LossSummary& more) {
  const auto same = [&](const LossSummary& loss) { return loss.loss == more.loss; };
  const auto found = std::find_if(losses.begin(), losses.end(), same);
  if (found == losses.end()) {
    losses.push_back(more);
    return;
  }
  found->measurements += more.measurements;
  found->down_weighted += more.down_weighted;
  found->weightless += more.weightless;
}

/// Returns the groups of all processes, those with one name and kind of derivatives as one.
std::vector<GroupSummary> allGroups(const Collective& processes, const std::vector<GroupSummary>& own) {
  Bytes bytes;
  for (const GroupSummary& group : own) put(bytes, group);
  std::vector<GroupSummary> all;
  for (std::string& text : processes.gather(bytes.all())) {
    Bytes part(std::move(text));
    while (!part.isAtEnd()) {
      const GroupSummary more = takeGroup(part);
      const auto found = std::find_if(all.begin(), all.end(), [&](const GroupSummary& group) {
        return group.name == more.name && group.derivatives == more.derivatives;
      });
      if (found == all.end()) {
        all.push_back(more);
        continue;
      }
      found->measurements += more.measurements;
      found->residuals += more.residuals;
      found->initial_rss += more.initial_rss;
      found->final_rss += more.final_rss;
      for (const LossSummary& loss : more.losses) addTo(found->losses, loss);
    }
  }
  return all;
}

/// Returns the lines of all processes, each once.
std::vector<std::string> allLines(const Collective& processes, const std::vector<std::string>& own) {
  Bytes bytes;
  for (const std::string& line : own) bytes.put(line);
  std::vector<std::string> all;
  for (std::string& text : processes.gather(bytes.all())) {
    Bytes part(std::move(text));
    while (!part.isAtEnd()) {
      std::string line = part.text();
      if (std::find(all.begin(), all.end(), line) == all.end()) all.push_back(std::move(line));
    }
  }
  return all;
}

/// Returns the first text of a process that has one.
std::string firstText(const Collective& processes, const std::string& own) {
  for (std::string& text : processes.gather(own)) {
    if (!text.empty()) return std::move(text);
  }
  return own;
}

}  // namespace

void Estimator::State::raiseNeedsAll() {
  throw Error(
      "slom.needs-all",
      "this analysis needs the whole problem, but each of the processes that fit it has a part; read the "
      "fitted values in a single process and analyse them there");
}

void Estimator::State::completeTogether(Summary& summary, const Options& options, const RankAtEnd& rank) {
  const Collective& processes = evaluator.collective();
  processes.agree(
      [&] { fillGroups(problem, run([&] { return linearizer.rssPerPool(problem); }), summary, false); });
  summary.groups = allGroups(processes, summary.groups);
  const BlockStructure& system = evaluator.structure().system;
  int variables = 0;
  for (int b = 0; b < system.blockCount(); ++b)
    variables += !system.isEmpty(b) && processes.counts(b) ? 1 : 0;
  summary.solver = evaluator.solver().description();
  summary.variables = static_cast<int>(processes.sum(variables));
  summary.measurements = evaluator.residuals();
  summary.unknowns = evaluator.unknowns() - evaluator.fixedOrActiveCount();
  summary.redundancy = summary.measurements - summary.unknowns;
  summary.parameters_not_shown = summary.unknowns;
  summary.sigma_is_estimated = sigma == Sigma::estimated;
  const bool states_all = processes.all(statesAllNoise(problem));
  const bool states_any = processes.any(std::any_of(problem.pools().begin(), problem.pools().end(),
                                                    [](const auto& pool) { return statesNoise(*pool); }));
  summary.stated_noise = states_all ? StatedNoise::all : states_any ? StatedNoise::some : StatedNoise::none;
  const bool is_singular = summary.stop_reason == StopReason::rank_deficient;
  const bool has_message = !is_singular || rank.singular_at.unknown >= 0;
  const std::string message = has_message ? messageFor(summary, options, rank) : "";
  summary.message = firstText(processes, message);
  if (summary.message.empty()) summary.message = messageFor(summary, options, rank);
  summary.active_bounds = allLines(processes, activeBounds(problem));
  std::vector<std::string> warnings;
  processes.agree([&] { given_derivatives.check(problem, warnings); });
  for (std::string& warning : allLines(processes, warnings)) summary.warnings.push_back(std::move(warning));
  for (std::string& warning : misfits(problem, summary)) summary.warnings.push_back(std::move(warning));
}

}  // namespace slom
