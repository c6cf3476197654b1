// Linear least squares with random numbers in a given structure of blocks.
#pragma once

#include <slom/solve/linear_solver.hpp>

#include <cmath>
#include <random>
#include <vector>

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

  /// `cliques`: the blocks of each measurement, all of the same number; -1 is a fixed variable of 2 dof.
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
    for (std::size_t g = 0; g < batches.size(); ++g) {
      const Batch& b = batches[g];
      solver.add({static_cast<int>(g), 0, static_cast<int>(b.rows.size()), b.rows.data(), b.dof.data(), b.r.data(), b.J.data()});
    }
    solver.endLinearization();
  }
};
