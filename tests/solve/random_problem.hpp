// Linear least squares with random numbers in a given structure of blocks.
#pragma once

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <slom/solve/linear_solver.hpp>

/// Blocks of the given sizes; groups of measurements with random rows that touch the given blocks.
struct RandomProblem {
  slom::BlockStructure structure;
  struct Batch {
    std::vector<int> rows, dof;
    std::vector<double> r, J;
  };
  std::vector<Batch> batches;
  std::mt19937 rng;

  RandomProblem(const std::vector<int>& sizes, unsigned seed) : rng(seed) {
    structure.offset.push_back(0);
    for (const int size : sizes) structure.offset.push_back(structure.offset.back() + size);
  }
  double normal() { return std::normal_distribution<double>()(rng); }

  /// Adds a group. `cliques`: the blocks of each measurement, equal in number; -1 is a fixed variable of 2 dof.
  void addGroup(const std::vector<std::vector<int>>& cliques, int rows) {
    slom::MeasurementGroup group;
    Batch batch;
    group.arity = cliques.empty() ? 1 : static_cast<int>(cliques[0].size());
    for (const auto& clique : cliques) {
      group.blocks.insert(group.blocks.end(), clique.begin(), clique.end());
      batch.rows.push_back(rows);
      for (const int block : clique) {
        const int dof = block < 0 ? 2 : structure.dof(block);
        batch.dof.push_back(dof);
        for (int i = 0; i < rows * dof; ++i) batch.J.push_back(block < 0 ? NAN : normal());
      }
      for (int i = 0; i < rows; ++i) batch.r.push_back(normal());
    }
    structure.groups.push_back(group);
    batches.push_back(batch);
  }
  void linearizeInto(slom::LinearSolver& solver) const {
    solver.analyze(structure);
    sendTo(solver);
  }
  void sendTo(slom::LinearSolver& solver) const {
    solver.beginLinearization();
    for (std::size_t g = 0; g < batches.size(); ++g) sendTo(solver, g, 0, batches[g].rows.size());
    solver.endLinearization();
  }
  /// The measurements [first, last) of a group.
  void sendTo(slom::LinearSolver& solver, std::size_t group, std::size_t first, std::size_t last) const {
    const Batch& b = batches[group];
    const auto arity = static_cast<std::size_t>(structure.groups[group].arity);
    const double *r = b.r.data(), *J = b.J.data();
    for (std::size_t m = 0; m < first; ++m) {
      for (std::size_t k = 0; k < arity; ++k) J += b.rows[m] * b.dof[m * arity + k];
      r += b.rows[m];
    }
    solver.add({static_cast<int>(group), static_cast<int>(first), static_cast<int>(last - first),
                b.rows.data() + first, b.dof.data() + first * arity, r, J});
  }
  /// One of the solver's partitions.
  void sendTo(slom::LinearSolver& solver, std::size_t partition) const {
    const auto begin = [&](std::size_t p, std::size_t group) -> std::size_t {
      if (p == solver.partitions().size()) return batches[group].rows.size();
      const slom::MeasurementPlace& place = solver.partitions()[p];
      const auto of = static_cast<std::size_t>(place.group);
      return of < group ? 0 : of > group ? batches[group].rows.size() : static_cast<std::size_t>(place.index);
    };
    for (std::size_t g = 0; g < batches.size(); ++g) {
      if (begin(partition, g) < begin(partition + 1, g))
        sendTo(solver, g, begin(partition, g), begin(partition + 1, g));
    }
  }
};

/// The same problem with empty blocks before, among and after those that it has.
inline RandomProblem withEmptyBlocks(RandomProblem problem) {
  std::vector<int> offset{0}, number;
  for (int b = 0; b < problem.structure.blockCount(); ++b) {
    for (int empty = 0; empty < (b + 1) % 3; ++empty) offset.push_back(offset.back());
    number.push_back(static_cast<int>(offset.size()) - 1);
    offset.push_back(offset.back() + problem.structure.dof(b));
  }
  offset.push_back(offset.back());
  problem.structure.offset = offset;
  for (slom::MeasurementGroup& group : problem.structure.groups) {
    for (int& block : group.blocks) block = block < 0 ? block : number[static_cast<std::size_t>(block)];
  }
  return problem;
}

/// Returns a few blocks of 1 to 7 that all measurements depend on: on one, two, the same one twice, three, and fixed
/// ones.
inline RandomProblem crowd(int measurements, unsigned seed) {
  std::mt19937 rng(seed);
  const auto any = [&](int first, int last) { return std::uniform_int_distribution<int>(first, last)(rng); };
  constexpr int count = 12;
  std::vector<int> sizes;
  for (int b = 0; b < count; ++b) sizes.push_back(any(1, 7));
  RandomProblem problem(sizes, seed);
  std::vector<std::vector<int>> ones, pairs, triples;
  for (int b = 0; b < count; ++b) ones.push_back({b});
  for (int i = 0; i < measurements; ++i) pairs.push_back({any(-1, count - 1), any(-1, count - 1)});
  for (int i = 0; i < measurements / 4; ++i)
    triples.push_back({any(0, count - 1), any(-1, count - 1), any(0, count - 1)});
  problem.addGroup(pairs, 3);
  problem.addGroup(triples, 2);
  problem.addGroup(ones, 8);
  return problem;
}
