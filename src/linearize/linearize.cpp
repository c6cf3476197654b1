#include "slom/linearize/linearize.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/index.hpp"
#include "base/threads.hpp"
#include "base/words.hpp"
#include "reweight.hpp"

namespace slom {

namespace {

/// Number of chunks in flight per thread. If threads wait for each other, few chunks stay in the second-level cache
/// until they are added up. A single thread needs only one chunk, which stays in the first-level cache.
constexpr int kChunksPerThread = 8;
int chunksInFlight(int threads) { return threads == 1 ? 1 : kChunksPerThread * threads; }

/// Returns the number of measurements in a chunk: at most 64, or fewer so that their Jacobians stay in the first-level
/// cache.
int perChunk(const MeasurementPool& pool) {
  constexpr int most = 64, least = 16, entries = 2048;
  const int of_one = std::max(1, pool.size() > 0 ? pool.rows(0) * pool.columns(0) : 1);
  return std::clamp(entries / of_one / 8 * 8, least, most);
}

double squaredNorm(const std::vector<double>& r) {
  return Eigen::Map<const Eigen::VectorXd>(r.data(), static_cast<Eigen::Index>(r.size())).squaredNorm();
}

}  // namespace

std::vector<Linearizer::Range> Linearizer::ranges(const Problem& problem,
                                                  std::span<const MeasurementPlace> partitions) {
  std::vector<Range> result;
  auto cut = partitions.begin();
  for (int g = 0; g < static_cast<int>(problem.pools().size()); ++g) {
    const int size = problem.pools()[at(g)]->size(), per_chunk = perChunk(*problem.pools()[at(g)]);
    for (int first = 0, last = 0; first < size; first = last) {
      while (cut != partitions.end() && (cut->group < g || (cut->group == g && cut->index <= first))) ++cut;
      last = std::min(first + per_chunk, size);
      if (cut != partitions.end() && cut->group == g) last = std::min(last, cut->index);
      result.push_back({g, first, last});
    }
  }
  return result;
}

void Linearizer::prepare(const Problem& problem, const Range& range, bool with_jacobian, Chunk& chunk) {
  const MeasurementPool& pool = *problem.pools()[at(range.group)];
  const int count = range.last - range.first;
  // A reused chunk always has a Jacobian.
  const bool is_laid_out =
      chunk.type == &pool.type() && pool.hasFixedSizes() && chunk.rows.size() >= at(count);
  chunk.type = &pool.type();
  chunk.group = range.group;
  chunk.first = range.first;
  chunk.last = range.last;
  chunk.forget();
  chunk.constrained.clear();
  if (is_laid_out) {
    chunk.r.resize(at(count) * at(chunk.rows.front()));
    return;
  }
  chunk.rows.resize(at(count));
  chunk.dof.resize(at(count) * at(pool.arity()));
  pool.sizes(range.first, range.last, chunk.rows.data(), chunk.dof.data());
  std::size_t residuals = 0, entries = 0;
  const int* dof = chunk.dof.data();
  for (const int rows : chunk.rows) {
    int columns = 0;
    for (int k = 0; k < pool.arity(); ++k) columns += *dof++;
    residuals += at(rows);
    entries += at(rows) * at(columns);
  }
  chunk.r.resize(residuals);
  if (with_jacobian) chunk.J.resize(entries);
}

/// Computes the chunk's RSS and, if derivatives are wanted, r and J for the sink.
void Linearizer::addLosses(const Problem& problem, bool with_jacobian, Chunk& chunk) const {
  const MeasurementPool& pool = *problem.pools()[at(chunk.group)];
  if (pool.lossCount() == 0) {
    chunk.rss = chunk.squared_norm = squaredNorm(chunk.r);
    return;
  }
  if (!with_jacobian) {
    chunk.rss = robustCost(pool, chunk.first, chunk.last, graduation_, chunk.r.data());
    return;
  }
  chunk.rss = reweight(problem, pool, chunk.first, chunk.last, graduation_, chunk.r.data(), chunk.J.data());
  chunk.squared_norm = squaredNorm(chunk.r);
}

std::vector<double> Linearizer::rssPerPool(const Problem& problem) {
  const std::vector<Range> all = ranges(problem);
  std::vector<double> sums(all.size());
  std::vector<std::optional<MeasurementThrew>> threw(all.size());
  detail::forEachIndex(static_cast<int>(all.size()), [&](int c) {
    Chunk chunk;
    prepare(problem, all[at(c)], false, chunk);
    try {
      problem.pools()[at(chunk.group)]->evaluate(chunk.first, chunk.last, chunk.r.data());
      addLosses(problem, false, chunk);
    } catch (const MeasurementThrew& event) {
      threw[at(c)] = event;
    }
    sums[at(c)] = chunk.rss;
  });
  for (std::size_t c = 0; c < all.size(); ++c) {
    if (threw[c]) problem.raiseThrew(*problem.pools()[at(all[c].group)], *threw[c]);
  }
  std::vector<double> result(problem.pools().size(), 0.0);
  for (std::size_t c = 0; c < all.size(); ++c) result[at(all[c].group)] += sums[c];
  return result;
}

double Linearizer::rss(const Problem& problem) {
  double sum = 0;
  for (const double part : rssPerPool(problem)) sum += part;
  return sum <= kLargestRss ? sum : std::numeric_limits<double>::quiet_NaN();
}

double Linearizer::largestLossArgument(const Problem& problem) {
  double largest = -1;
  for (const Range& range : ranges(problem)) {
    MeasurementPool& pool = *problem.pools()[at(range.group)];
    if (pool.lossCount() == 0) continue;
    Chunk chunk;
    prepare(problem, range, false, chunk);
    problem.naming(pool, [&] { pool.evaluate(range.first, range.last, chunk.r.data()); });
    largest = std::max(largest, slom::largestLossArgument(pool, range.first, range.last, chunk.r.data()));
  }
  return std::min(largest, std::numeric_limits<double>::max() / 4);  // so that twice the limit is finite
}

void Linearizer::residuals(const Problem& problem, double* r) {
  for (const auto& pool : problem.pools()) {
    problem.naming(*pool, [&] { pool->evaluate(0, pool->size(), r); });
    for (int i = 0; i < pool->size(); ++i) r += pool->rows(i);
  }
}

void Linearizer::linearizeChunk(const Problem& problem, const ActiveSet& active, const Range& range,
                                bool wants_plain, Chunk& chunk) const {
  prepare(problem, range, true, chunk);
  const bool has_constrained = !active.constrained().empty();
  try {
    MeasurementPool& pool = *problem.pools()[at(chunk.group)];
    chunk.bad = pool.linearize(chunk.first, chunk.last, chunk.r.data(), chunk.J.data());
    if (chunk.bad < 0) {
      if (wants_plain && pool.lossCount() > 0) {
        chunk.plain_r = chunk.r;
        chunk.plain_J = chunk.J;
        if (has_constrained)
          clearConstrained(problem, active, chunk, chunk.plain_r.data(), chunk.plain_J.data(), nullptr);
      }
      addLosses(problem, true, chunk);
      if (has_constrained)
        clearConstrained(problem, active, chunk, chunk.r.data(), chunk.J.data(), &chunk.constrained);
    }
  } catch (const MeasurementThrew& event) {
    chunk.threw = event;
  }
}

void Linearizer::requireGood(const Problem& problem, const Chunk& chunk) {
  if (chunk.threw) problem.raiseThrew(*problem.pools()[at(chunk.group)], *chunk.threw);
  if (chunk.bad >= 0) raiseNotFinite(problem, chunk.group, chunk.bad);
}

double Linearizer::linearize(const Problem& problem, const ActiveSet& active, JacobianSink& sink) {
  const std::span<const MeasurementPlace> partitions = sink.partitions();
  const std::vector<Range> all = ranges(problem, partitions);
  const int threads = detail::threadCount();
  const std::size_t per_wave = at(chunksInFlight(threads));
  std::vector<double> rss(all.size()), squared_norm(all.size());
  constrained_.clear();
  const bool wants_plain = sink.wantsUnweighted();
  sink.beginLinearization();
  const auto send = [&](std::size_t c, const Chunk& chunk) {
    rss[c] = chunk.rss;
    squared_norm[c] = chunk.squared_norm;
    sink.add(chunk.batch());
    if (wants_plain && problem.pools()[at(chunk.group)]->lossCount() > 0)
      sink.addUnweighted(chunk.plainBatch());
  };
  const auto addConstrained = [&](const std::vector<ConstrainedColumn>& constrained) {
    for (const ConstrainedColumn& part : constrained) {
      ConstrainedColumn& whole =
          constrained_.try_emplace({part.variable, part.component}, ConstrainedColumn{}).first->second;
      whole.gradient += part.gradient;
      whole.squared_norm += part.squared_norm;
    }
  };
  // Few chunks may still take long. If there are fewer partitions than threads, all threads work on the chunks.
  if (partitions.size() > 1 && (partitions.size() >= at(threads) || all.size() > per_wave)) {
    std::vector<std::size_t> first;
    for (const MeasurementPlace& begin : partitions) {
      const auto is_before = [&](const Range& range) {
        return std::pair(range.group, range.first) < std::pair(begin.group, begin.index);
      };
      first.push_back(
          at(static_cast<int>(std::partition_point(all.begin(), all.end(), is_before) - all.begin())));
    }
    first.push_back(all.size());
    chunks_.resize(threads == 1 ? 1 : partitions.size());
    for (Chunk& chunk : chunks_) chunk.forget();
    std::vector<std::vector<ConstrainedColumn>> constrained(partitions.size());
    detail::forEachIndex(static_cast<int>(partitions.size()), [&](int p) {
      Chunk& chunk = threads == 1 ? chunks_.front() : chunks_[at(p)];
      for (std::size_t c = first[at(p)]; c < first[at(p) + 1] && chunk.isGood(); ++c) {
        linearizeChunk(problem, active, all[c], wants_plain, chunk);
        if (!chunk.isGood()) return;
        send(c, chunk);
        constrained[at(p)].insert(constrained[at(p)].end(), chunk.constrained.begin(),
                                  chunk.constrained.end());
      }
    });
    for (const Chunk& chunk : chunks_) requireGood(problem, chunk);
    for (const auto& of_partition : constrained) addConstrained(of_partition);
  } else {
    chunks_.resize(std::min(all.size(), per_wave));
    for (std::size_t wave = 0; wave < all.size(); wave += per_wave) {
      const int count = static_cast<int>(std::min(per_wave, all.size() - wave));
      detail::forEachIndex(count, [&](int c) {
        linearizeChunk(problem, active, all[wave + at(c)], wants_plain, chunks_[at(c)]);
      });
      for (int c = 0; c < count; ++c) {
        const Chunk& chunk = chunks_[at(c)];
        requireGood(problem, chunk);
        send(wave + at(c), chunk);
        addConstrained(chunk.constrained);
      }
    }
  }
  if (!active.constrained().empty()) sendConstrained(problem, active, sink);
  sink.endLinearization();
  squared_norm_sent_ = std::accumulate(squared_norm.begin(), squared_norm.end(), 0.0);
  return std::accumulate(rss.begin(), rss.end(), 0.0);
}

JacobianBatch Linearizer::linearizeSome(const Problem& problem, const ActiveSet& active, int pool, int first,
                                        int last, double* cost) {
  if (chunks_.empty()) chunks_.resize(1);
  Chunk& chunk = chunks_.front();
  linearizeChunk(problem, active, {pool, first, last}, false, chunk);
  requireGood(problem, chunk);
  if (cost != nullptr) *cost = chunk.rss;
  return chunk.batch();
}

void Linearizer::clearConstrained(const Problem& problem, const ActiveSet& active, const Chunk& chunk,
                                  const double* r, double* J, std::vector<ConstrainedColumn>* constrained) {
  const MeasurementPool& pool = *problem.pools()[at(chunk.group)];
  for (int i = chunk.first; i < chunk.last; ++i) {
    const int rows = pool.rows(i);
    for (int k = 0; k < pool.arity(); ++k) {
      const int variable = pool.variables(i)[k];
      const VariableRecord& record = problem.variables()[at(variable)];
      for (int c = 0; c < record.dof; ++c, J += rows) {
        if (!active.isOptimized(variable) || !active.isFixedOrActive(variable, c)) continue;
        ConstrainedColumn column{variable, c, 0, 0};
        for (int row = 0; row < rows; ++row) {
          column.gradient += J[row] * r[row];
          column.squared_norm += J[row] * J[row];
        }
        if (constrained != nullptr) constrained->push_back(column);
        std::fill_n(J, rows, 0.0);
      }
    }
    r += rows;
  }
}

/// Sends the constrained components with the lengths of their cleared columns, so that scales stay the same.
void Linearizer::sendConstrained(const Problem& problem, const ActiveSet& active, JacobianSink& sink) const {
  const int group = static_cast<int>(problem.pools().size());
  int index = 0;
  for (const int variable : active.constrained()) {
    const VariableRecord& record = problem.variables()[at(variable)];
    if (!active.isOptimized(variable) || record.dof == 0) continue;
    const Eigen::VectorXd r = Eigen::VectorXd::Zero(record.dof);
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(record.dof, record.dof);
    for (int c = 0; c < record.dof; ++c) {
      const auto column = constrained_.find({variable, c});
      const bool has_length = column != constrained_.end() && column->second.squared_norm > 0;
      if (active.isFixedOrActive(variable, c))
        J(c, c) = has_length ? std::sqrt(column->second.squared_norm) : 1;
    }
    sink.add({group, index++, 1, &record.dof, &record.dof, r.data(), J.data()});
  }
}

double Linearizer::gradientOfConstrained(int variable, int component) const {
  const auto found = constrained_.find({variable, component});
  return found == constrained_.end() ? 0 : found->second.gradient;
}

}  // namespace slom
