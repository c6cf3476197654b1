// The solver gives the same bits, and names the same unknown of a singular system, on any number of threads. This holds
// even if it was prepared for another number of threads, and in whatever order threads add their partitions.
#include <algorithm>
#include <atomic>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <slom/base/threads.hpp>
#include <slom/solve/block_solver.hpp>

#include "solve/random_problem.hpp"

namespace {

using Eigen::VectorXd;

/// A lattice of side^3 blocks of 3, each measured with its neighbours, and all of them by themselves.
RandomProblem lattice(int side, unsigned seed) {
  RandomProblem problem(std::vector<int>(static_cast<std::size_t>(side * side * side), 3), seed);
  const auto block = [&](int x, int y, int z) { return (z * side + y) * side + x; };
  std::vector<std::vector<int>> pairs, priors;
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        priors.push_back({block(x, y, z)});
        if (x > 0) pairs.push_back({block(x - 1, y, z), block(x, y, z)});
        if (y > 0) pairs.push_back({block(x, y - 1, z), block(x, y, z)});
        if (z > 0) pairs.push_back({block(x, y, z - 1), block(x, y, z)});
      }
    }
  }
  problem.addGroup(pairs, 3);
  problem.addGroup(priors, 3);
  return problem;
}

/// Points of 3 that some of a few blocks of 9 see, in no order.
RandomProblem scene(int cameras, int points, unsigned seed) {
  std::vector<int> sizes(static_cast<std::size_t>(cameras), 9);
  sizes.resize(static_cast<std::size_t>(cameras + points), 3);
  RandomProblem problem(sizes, seed);
  std::vector<std::vector<int>> sights;
  for (int p = 0; p < points; ++p) {
    for (int k = 0; k < 4; ++k) sights.push_back({(p + 5 * k * k) % cameras, cameras + p});
  }
  std::shuffle(sights.begin(), sights.end(), problem.rng);
  problem.addGroup(sights, 2);
  return problem;
}

/// Nothing changes with the first unknown of the block any more.
void makeSingular(RandomProblem& problem, int block) {
  for (std::size_t g = 0; g < problem.batches.size(); ++g) {
    const slom::MeasurementGroup& group = problem.structure.groups[g];
    double* J = problem.batches[g].J.data();
    for (const int b : group.blocks) {
      if (b == block) std::fill_n(J, 3, 0.0);
      J += 9;  // three rows, three unknowns
    }
  }
}

struct SolverOutcome {
  slom::SolveStatus status;
  VectorXd step, damped_step;
  Eigen::MatrixXd columns;  // H^-1 B; threads share the columns
  bool operator==(const SolverOutcome& other) const {
    return status.ok == other.status.ok && status.unknown == other.status.unknown &&
           status.pivot == other.status.pivot && step == other.step && damped_step == other.damped_step &&
           columns == other.columns;
  }
};

using Elimination = slom::BlockSolverOptions::Elimination;

SolverOutcome solved(const RandomProblem& problem, Elimination elimination, int threads_to_analyze,
                     int threads_to_solve) {
  slom::BlockSolver solver({.elimination = elimination});
  slom::withThreads(threads_to_analyze, [&] { problem.linearizeInto(solver); });
  SolverOutcome outcome;
  slom::withThreads(threads_to_solve, [&] {
    EXPECT_TRUE(solver.solve(VectorXd::Constant(problem.structure.unknowns(), 1e-3), outcome.damped_step).ok);
    outcome.status = solver.solve({}, outcome.step);
    const Eigen::MatrixXd B = Eigen::MatrixXd::Identity(problem.structure.unknowns(), 7);
    EXPECT_EQ(solver.solveFor(B, outcome.columns).ok, outcome.status.ok);
  });
  return outcome;
}

void expectTheSameOnAnyNumber(const RandomProblem& problem, bool ok,
                              Elimination elimination = Elimination::none) {
  const SolverOutcome alone = solved(problem, elimination, 1, 1);
  EXPECT_EQ(alone.status.ok, ok);
  for (const auto& [to_analyze, to_solve] : {std::pair{1, 2}, {2, 1}, {2, 2}}) {
    EXPECT_TRUE(solved(problem, elimination, to_analyze, to_solve) == alone)
        << to_analyze << " and " << to_solve << " threads";
  }
}

TEST(Threads, DoNotChangeABit) {
  expectTheSameOnAnyNumber(lattice(7, 3), true);
  expectTheSameOnAnyNumber(scene(6, 2000, 3), true, Elimination::automatic);  // points first, in partitions
}

TEST(Threads, MayAddTheirPartitionsInAnyOrder) {
  for (const RandomProblem& problem : {crowd(3000, 1), lattice(9, 2), scene(12, 2000, 3)}) {
    slom::BlockSolver in_order, at_once, reversed;
    problem.linearizeInto(in_order);
    const int partitions = static_cast<int>(in_order.partitions().size());
    ASSERT_GT(partitions, 1);
    at_once.analyze(problem.structure);
    at_once.beginLinearization();
    std::atomic<int> next = 0;
    const auto send = [&] {
      for (int partition = next.fetch_add(1, std::memory_order_relaxed); partition < partitions;
           partition = next.fetch_add(1, std::memory_order_relaxed)) {
        problem.sendTo(at_once, static_cast<std::size_t>(partition));
      }
    };
    std::thread other(send);
    send();
    other.join();
    at_once.endLinearization();
    reversed.analyze(problem.structure);
    for (int repetition = 0; repetition < 2; ++repetition) {
      reversed.beginLinearization();
      for (int partition = partitions; partition-- > 0;)
        problem.sendTo(reversed, static_cast<std::size_t>(partition));
      reversed.endLinearization();
    }
    VectorXd step;
    ASSERT_TRUE(in_order.solve({}, step).ok);
    for (slom::BlockSolver* other : {&at_once, &reversed}) {
      EXPECT_TRUE(other->gradient() == in_order.gradient());
      EXPECT_TRUE(other->diagonal() == in_order.diagonal());
      VectorXd same;
      ASSERT_TRUE(other->solve({}, same).ok);
      EXPECT_TRUE(same == step);
    }
  }
}

TEST(Threads, HaveNoPartitionsWhereAccumulatorsWouldCostTooMuch) {
  slom::BlockSolver solver;
  solver.analyze(crowd(300, 1).structure);
  EXPECT_TRUE(solver.partitions().empty());  // too few measurements
  RandomProblem shuffled(std::vector<int>(2000, 6), 2);
  std::vector<std::vector<int>> pairs;
  std::uniform_int_distribution<int> any(0, 1999);
  for (int i = 0; i < 3000; ++i) pairs.push_back({any(shuffled.rng), any(shuffled.rng)});
  shuffled.addGroup(pairs, 1);
  solver.analyze(shuffled.structure);
  EXPECT_TRUE(solver.partitions().empty());
}

TEST(Threads, DoNotChangeWhatIsNamedAsSingular) {
  constexpr int side = 6, count = side * side * side;
  std::mt19937 rng(5);
  for (int i = 0; i < 12; ++i) {
    RandomProblem problem = lattice(side, 4);
    for (int k = 0; k < 3; ++k) makeSingular(problem, std::uniform_int_distribution<int>(0, count - 1)(rng));
    expectTheSameOnAnyNumber(problem, false);
  }
}

}  // namespace
