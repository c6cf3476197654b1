// The sparse solvers against dense QR on random block structures.
#include <algorithm>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/solve/block_qr.hpp>
#include <slom/solve/block_solver.hpp>
#include <slom/solve/cholmod.hpp>
#include <slom/solve/dense_qr.hpp>

#include "solve/random_problem.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

using Options = slom::BlockSolverOptions;

/// Conjugate gradients that go on until there is nothing to gain.
Options patient(Options::Preconditioner preconditioner) {
  return {.method = Options::Method::conjugate_gradients,
          .preconditioner = preconditioner,
          .forcing = 1e-14,
          .max_iterations = 5000};
}

std::vector<std::unique_ptr<slom::LinearSolver>> allSolvers() {
  std::vector<std::unique_ptr<slom::LinearSolver>> solvers;
  solvers.push_back(std::make_unique<slom::BlockSolver>());
  solvers.push_back(std::make_unique<slom::BlockSolver>(Options{.elimination = Options::Elimination::none}));
  solvers.push_back(std::make_unique<slom::BlockQR>());
  for (const auto preconditioner :
       {Options::Preconditioner::schur_jacobi, Options::Preconditioner::block_jacobi,
        Options::Preconditioner::power_series}) {
    solvers.push_back(std::make_unique<slom::BlockSolver>(patient(preconditioner)));
  }
  if (slom::Cholmod::isAvailable()) solvers.push_back(std::make_unique<slom::Cholmod>());
  return solvers;
}

/// The solution by dense QR, which is itself compared with the normal equations.
struct Oracle {
  slom::DenseQR dense;
  std::vector<VectorXd> dampings, steps;
  MatrixXd inverse;
  explicit Oracle(const RandomProblem& problem) {
    problem.linearizeInto(dense);
    const int n = problem.structure.unknowns();
    dampings = {VectorXd(), VectorXd(0.1 * dense.diagonal()), VectorXd(VectorXd::Constant(n, 1e3))};
    const MatrixXd undamped = dense.jacobian().transpose() * dense.jacobian();
    for (const VectorXd& damping : dampings) {
      VectorXd y;
      EXPECT_TRUE(dense.solve(damping, y).ok);
      MatrixXd H = undamped;
      if (damping.size() > 0) H.diagonal() += damping;
      EXPECT_LT((H * y + dense.gradient()).norm(), 1e-9 * (1 + dense.gradient().norm()));
      steps.push_back(y);
    }
    inverse = undamped.inverse();
    MatrixXd Y;
    EXPECT_TRUE(dense.solveFor(MatrixXd::Identity(n, n), Y).ok);
    EXPECT_LT((Y - inverse).norm(), 1e-8 * inverse.norm());
  }
};

void expectSameAsOracle(const RandomProblem& problem, const Oracle& oracle, slom::LinearSolver& sparse) {
  const slom::DenseQR& dense = oracle.dense;
  const MatrixXd& inverse = oracle.inverse;
  problem.linearizeInto(sparse);
  const int n = problem.structure.unknowns();
  EXPECT_LT((sparse.gradient() - dense.gradient()).norm(), 1e-12 * (1 + dense.gradient().norm()));
  EXPECT_LT((sparse.diagonal() - dense.diagonal()).norm(), 1e-12 * (1 + dense.diagonal().norm()));
  const VectorXd d = VectorXd::LinSpaced(n, -1, 2);
  EXPECT_NEAR(sparse.squaredNormOfJd(d), dense.squaredNormOfJd(d), 1e-11 * dense.squaredNormOfJd(d));

  for (std::size_t i = 0; i < oracle.dampings.size(); ++i) {
    VectorXd x;
    ASSERT_TRUE(sparse.solve(oracle.dampings[i], x).ok);
    EXPECT_LT((x - oracle.steps[i]).norm(), 1e-10 * (1 + oracle.steps[i].norm()));
  }
  MatrixXd X;
  ASSERT_TRUE(sparse.solveFor(MatrixXd::Identity(n, n), X).ok);
  VectorXd step;
  ASSERT_TRUE(sparse.solve({}, step).ok);  // with the factor that is there by now
  EXPECT_LT((step + inverse * dense.gradient()).norm(), 1e-8 * (1 + step.norm()));
  EXPECT_LT((X - inverse).norm(), 1e-8 * inverse.norm());
  std::unique_ptr<slom::InverseBlocks> blocks;
  ASSERT_TRUE(sparse.invertBlocks(problem.structure, blocks).ok);
  const auto compare = [&](int a, int b) {
    const auto offset = [&](int block) { return problem.structure.offset[static_cast<std::size_t>(block)]; };
    MatrixXd block(problem.structure.dof(a), problem.structure.dof(b));
    blocks->block(a, b, block.data());
    EXPECT_LT((block - inverse.block(offset(a), offset(b), block.rows(), block.cols())).norm(),
              1e-8 * inverse.norm());
  };
  for (int b = 0; b < problem.structure.blockCount(); ++b) {
    if (!problem.structure.isEmpty(b)) compare(b, b);
  }
  for (const slom::MeasurementGroup& group : problem.structure.groups) {
    for (int m = 0; m < group.size(); ++m) {
      const auto first = group.blocks.begin() + m * group.arity;
      for (auto a = first; a != first + group.arity; ++a) {
        for (auto b = first; b != first + group.arity; ++b) {
          if (*a >= 0 && *b >= 0) compare(*a, *b);
        }
      }
    }
  }
}

void expectSameAsOracle(const RandomProblem& problem, slom::LinearSolver& sparse) {
  expectSameAsOracle(problem, Oracle(problem), sparse);
}

void expectSameAsOracle(const RandomProblem& problem) {
  const Oracle oracle(problem);
  for (const auto& solver : allSolvers()) {
    expectSameAsOracle(problem, oracle, *solver);
    if (testing::Test::HasFailure()) FAIL() << solver->description();
  }
}

std::vector<int> randomSizes(int count, std::mt19937& rng) {
  std::vector<int> sizes;
  for (int i = 0; i < count; ++i) sizes.push_back(std::uniform_int_distribution<int>(1, 7)(rng));
  return sizes;
}

/// Adds a prior to every block, so that the system has full rank.
void addPriors(RandomProblem& problem) {
  std::vector<std::vector<int>> priors;
  for (int b = 0; b < problem.structure.blockCount(); ++b) priors.push_back({b});
  problem.addGroup(priors, 8);
}

TEST(Solvers, TakeNoNoticeOfEmptyBlocks) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    const RandomProblem problem = crowd(100, seed), with_empty = withEmptyBlocks(problem);
    expectSameAsOracle(with_empty);
    for (std::size_t i = 0; i < allSolvers().size(); ++i) {
      const auto a = std::move(allSolvers()[i]), b = std::move(allSolvers()[i]);
      problem.linearizeInto(*a);
      with_empty.linearizeInto(*b);
      VectorXd x, y;
      ASSERT_TRUE(a->solve({}, x).ok && b->solve({}, y).ok);
      EXPECT_EQ(x, y) << a->description();
      EXPECT_EQ(a->description(), b->description());
    }
  }
}

TEST(Solvers, AgreeOnChainsStarsGridsCliquesAndIslands) {
  std::mt19937 rng(11);
  const unsigned seeds = slom::testing::hasSanitizers() ? 1 : 4;  // a hundred times slower
  for (unsigned seed = 0; seed < seeds; ++seed) {
    const int n = 25;
    RandomProblem chain(randomSizes(n, rng), seed), star(randomSizes(n, rng), seed),
        grid(randomSizes(n, rng), seed), clique(randomSizes(7, rng), seed),
        islands(randomSizes(n, rng), seed), dense(randomSizes(n, rng), seed);
    std::vector<std::vector<int>> steps, spokes, edges, pairs, near, random;
    for (int i = 0; i + 1 < n; ++i) steps.push_back({i, i + 1});
    for (int i = 1; i < n; ++i) spokes.push_back({i, 0});
    for (int i = 0; i < n; ++i) {
      if (i % 5 < 4) edges.push_back({i + 1, i});
      if (i + 5 < n) edges.push_back({i, i + 5});
      if (i % 5 < 3) near.push_back({i, i + 1});
    }
    for (int i = 0; i < 7; ++i)
      for (int j = 0; j < i; ++j) pairs.push_back({i, j});
    std::uniform_int_distribution<int> any(-1, n - 1);                              // -1: fixed
    for (int i = 0; i < 60; ++i) random.push_back({any(rng), any(rng), any(rng)});  // may repeat a block
    chain.addGroup(steps, 3);
    star.addGroup(spokes, 2);
    grid.addGroup(edges, 4);
    clique.addGroup(pairs, 2);
    islands.addGroup(near, 3);
    dense.addGroup(random, 2);
    for (RandomProblem* problem : {&chain, &star, &grid, &clique, &islands, &dense}) {
      addPriors(*problem);
      expectSameAsOracle(*problem);
    }
  }
}

/// Cameras of 9 unknowns, lenses of 2 and `points` points that only ever meet these.
RandomProblem manySmallBlocks(int points, int sight, unsigned seed) {
  std::vector<int> sizes;
  std::mt19937 rng(seed);
  std::vector<int> camera, lens, point;
  for (int i = 0; i < 9; ++i) sizes.push_back(i % 3 == 2 ? 2 : 9);
  for (int i = 0; i < points; ++i) sizes.push_back(3);
  std::shuffle(sizes.begin(), sizes.end(), rng);
  for (int b = 0; b < static_cast<int>(sizes.size()); ++b) {
    (sizes[static_cast<std::size_t>(b)] == 9   ? camera
     : sizes[static_cast<std::size_t>(b)] == 2 ? lens
                                               : point)
        .push_back(b);
  }
  RandomProblem problem(sizes, seed);
  std::vector<std::vector<int>> seen, between;
  for (std::size_t i = 0; i < point.size(); ++i) {
    for (int k = 0; k < sight; ++k) {
      const std::size_t c = (i % 4 + static_cast<std::size_t>(k)) % camera.size();
      seen.push_back({k == 2 ? -1 : camera[c], point[i], lens[c / 2]});  // one camera is fixed
    }
  }
  for (std::size_t c = 0; c + 1 < camera.size(); ++c) between.push_back({camera[c + 1], camera[c]});
  problem.addGroup(seen, 2);
  problem.addGroup(between, 9);
  addPriors(problem);
  return problem;
}

TEST(Solvers, EliminateManySmallBlocksFirst) {
  for (unsigned seed = 0; seed < 2; ++seed) {
    const RandomProblem problem = manySmallBlocks(66, 3, seed);
    expectSameAsOracle(problem);
    slom::BlockSolver sparse;
    problem.linearizeInto(sparse);
    EXPECT_EQ(
        sparse.description(),
        "reduced system 3 x 2 + 6 x 9 after elimination of 66 x 3, sparse Cholesky, minimum degree order");
  }
}

/// A ring of small blocks, and many smaller blocks with three neighbours each: enough to be eliminated in parts.
TEST(Solvers, EliminateManySmallBlocksInParts) {
  constexpr int kRing = 12, kBetween = 23, kPoints = kRing * kBetween;
  const auto ring = [](int c) { return c % kRing * (kBetween + 1); };
  const auto point = [](int p) { return p + p / kBetween + 1; };
  std::vector<int> sizes(kRing + kPoints);
  for (int p = 0; p < kPoints; ++p) sizes[static_cast<std::size_t>(point(p))] = p % 4 == 3 ? 2 : 1;
  for (int c = 0; c < kRing; ++c) sizes[static_cast<std::size_t>(ring(c))] = 2 + c % 2;
  RandomProblem problem(sizes, 1);
  std::vector<std::vector<int>> sights, priors;
  for (int p = 0; p < kPoints; ++p) {
    for (int k = 0; k < 3; ++k) sights.push_back({point(p), ring(7 * p + k)});
  }
  for (int c = 0; c < kRing; ++c) priors.push_back({ring(c)});
  std::shuffle(sights.begin(), sights.end(), problem.rng);
  problem.addGroup(sights, 2);
  problem.addGroup(priors, 4);
  slom::BlockSolver solver;
  expectSameAsOracle(problem, solver);
  EXPECT_EQ(solver.description(),
            "reduced system 6 x 2 + 6 x 3 after elimination of 207 x 1 + 69 x 2, dense Cholesky");
}

/// Returns a tree of these blocks with `closures` further edges at random. Without priors, measurements observe only
/// differences.
RandomProblem loopyTree(const std::vector<int>& sizes, int closures, unsigned seed) {
  RandomProblem problem(sizes, seed);
  const int n = static_cast<int>(sizes.size());
  std::vector<std::vector<int>> edges;
  const auto before = [&](int b) {
    return std::uniform_int_distribution<int>(std::max(0, b - 3), b - 1)(problem.rng);
  };
  for (int b = 1; b < n; ++b) edges.push_back({b, before(b)});
  for (int i = 0; i < closures; ++i) {
    const int b = std::uniform_int_distribution<int>(1, n - 1)(problem.rng);
    edges.push_back({std::uniform_int_distribution<int>(0, b - 1)(problem.rng), b});
  }
  problem.addGroup(edges, 3);
  return problem;
}

TEST(Solvers, EliminateBlocksWithFewNeighboursFirst) {
  std::mt19937 rng(4);
  const std::size_t n = 40;
  const std::vector<std::vector<int>> sizes{std::vector<int>(n, 3), std::vector<int>(n, 6),
                                            std::vector<int>(n, 2), randomSizes(static_cast<int>(n), rng)};
  for (const std::vector<int>& size : sizes) {
    for (const int closures : {0, 8, 24}) {
      RandomProblem problem = loopyTree(size, closures, static_cast<unsigned>(closures));
      addPriors(problem);
      slom::BlockSolver solver, plain({.elimination = Options::Elimination::none});
      expectSameAsOracle(problem, solver);
      expectSameAsOracle(problem, plain);
      EXPECT_NE(solver.description().find("blocks with few neighbours first"), std::string::npos)
          << solver.description();
      EXPECT_EQ(plain.description().find("few neighbours"), std::string::npos);
    }
  }
  RandomProblem tree = loopyTree(sizes[0], 0, 1);
  addPriors(tree);
  slom::BlockSolver solver;
  tree.linearizeInto(solver);
  EXPECT_EQ(solver.description(), "system 40 x 3, sparse Cholesky, 40 blocks with few neighbours first");
}

TEST(Solvers, NameWhatIsSingularAmongBlocksWithFewNeighbours) {
  // Blocks of 2 whose first components are observed by differences only. Second components are observed only by priors.
  RandomProblem problem = loopyTree(std::vector<int>(50, 2), 10, 8);
  for (std::size_t i = 0; i < problem.batches[0].J.size(); ++i) {
    if (i % 6 >= 3) problem.batches[0].J[i] = 0;
  }
  std::vector<std::vector<int>> priors;
  for (int b = 0; b < 50; ++b) {
    if (b != 17) priors.push_back({b});
  }
  problem.addGroup(priors, 2);
  slom::BlockSolver solver;
  problem.linearizeInto(solver);
  VectorXd step = VectorXd::Constant(1, 7);
  const slom::SolveStatus status = solver.solve({}, step);
  EXPECT_FALSE(status.ok);
  EXPECT_EQ(status.unknown, problem.structure.offset[17] + 1);
  EXPECT_EQ(step[0], 7);
  EXPECT_TRUE(solver.solve(VectorXd::Constant(100, 1e-3), step).ok);
}

TEST(Solvers, AddUpThePartitionsOfManyMeasurements) {
  for (unsigned seed = 0; seed < 2; ++seed) {
    const RandomProblem problem = crowd(1000, seed);
    slom::BlockSolver solver;
    solver.analyze(problem.structure);
    EXPECT_GT(solver.partitions().size(), 1u);
    expectSameAsOracle(problem, solver);
  }
}

/// Returns a problem whose measurements come in runs of the same variables: some fixed, some twice in a measurement.
RandomProblem runs(int count, unsigned seed) {
  std::mt19937 rng(seed);
  const auto any = [&](int first, int last) { return std::uniform_int_distribution<int>(first, last)(rng); };
  RandomProblem problem(randomSizes(8, rng), seed);
  for (const int arity : {1, 2, 3, 4}) {
    for (const int rows : {1, 2, 5, 16, 17}) {
      std::vector<std::vector<int>> cliques;
      for (int i = 0; i < count; ++i) {
        std::vector<int> clique;
        for (int k = 0; k < arity; ++k) clique.push_back(any(-1, 7));
        constexpr int lengths[] = {1, 3, 4, 5, 63, 64, 65, 130};
        cliques.insert(cliques.end(), static_cast<std::size_t>(lengths[any(0, rows > 4 ? 3 : 7)]), clique);
      }
      problem.addGroup(cliques, rows);
    }
  }
  addPriors(problem);
  return problem;
}

TEST(Solvers, AddRunsOfMeasurementsOfTheSameVariables) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    const RandomProblem problem = runs(4, seed);
    slom::BlockSolver solver, by_elimination(Options{.elimination = Options::Elimination::none});
    const Oracle oracle(problem);
    expectSameAsOracle(problem, oracle, solver);
    expectSameAsOracle(problem, oracle, by_elimination);
  }
}

TEST(Solvers, HandleOneGiantBlockAndEmptyGroups) {
  RandomProblem problem({120, 1, 1}, 3);
  problem.addGroup({{0, 1}, {0, 2}, {1, 0}}, 60);
  problem.addGroup({}, 2);
  expectSameAsOracle(problem);
}

TEST(Solvers, HandleBlocksThatNeverMeet) {
  RandomProblem problem({11, 4, 2, 6, 13, 12}, 9);
  std::vector<std::vector<int>> priors;
  for (int b = 0; b < 6; ++b) priors.push_back({b});
  problem.addGroup(priors, 15);
  expectSameAsOracle(problem);
}

std::vector<std::unique_ptr<slom::LinearSolver>> exactSolvers() {
  std::vector<std::unique_ptr<slom::LinearSolver>> solvers;
  solvers.push_back(std::make_unique<slom::DenseQR>());
  for (auto& solver : allSolvers()) {
    const auto* const block = dynamic_cast<const slom::BlockSolver*>(solver.get());
    if (block == nullptr || block->isExact()) solvers.push_back(std::move(solver));
  }
  return solvers;
}

TEST(Solvers, NameAnUnknownOfTheSingularPart) {
  // Blocks 0 - 1 - 2 are determined only against each other, 3 is determined, 4 is in no measurement.
  for (const bool unseen : {false, true}) {
    RandomProblem problem(unseen ? std::vector<int>{2, 2, 2, 2, 2} : std::vector<int>{2, 2, 2, 2}, 5);
    problem.addGroup({{0, 1}, {1, 2}, {2, 0}}, 2);
    for (std::size_t m = 0; m < 3; ++m) {  // r = x_a - x_b
      for (int i = 0; i < 8; ++i)
        problem.batches[0].J[8 * m + static_cast<std::size_t>(i)] = i < 4 ? (i % 3 == 0) : -(i % 3 == 1);
    }
    problem.addGroup({{3}}, 3);
    for (const auto& solver : exactSolvers()) {
      problem.linearizeInto(*solver);
      VectorXd step = VectorXd::Constant(1, 7);
      const slom::SolveStatus status = solver->solve({}, step);
      EXPECT_FALSE(status.ok);
      EXPECT_EQ(step, VectorXd(VectorXd::Constant(1, 7))) << "untouched on failure";
      EXPECT_TRUE(status.unknown < 6 || status.unknown >= 8) << status.unknown;
      EXPECT_LT(status.pivot, 1e-12);
      // Damped, it can be solved.
      const VectorXd damping = VectorXd::Constant(problem.structure.unknowns(), 0.5);
      EXPECT_TRUE(solver->solve(damping, step).ok);
      EXPECT_EQ(step.size(), problem.structure.unknowns());
    }
  }
}

TEST(Solvers, FindTheRankWhateverTheUnits) {
  for (const double unit : {1e-9, 1.0, 1e9}) {
    RandomProblem problem({2, 1}, 9);
    problem.addGroup({{0, 1}, {0, 1}, {0, 1}}, 2);
    for (std::size_t m = 0; m < 3; ++m) {
      for (std::size_t i = 0; i < 2; ++i) {
        double* J = problem.batches[0].J.data() + 6 * m;
        J[i] *= unit;
        J[4 + i] = J[i] / unit + 2 * J[2 + i];  // the third column is a combination of the others
      }
    }
    VectorXd step;
    RandomProblem regular = problem;
    regular.batches[0].J[5] += 1e-3;  // now it is not
    for (const auto& solver : exactSolvers()) {
      problem.linearizeInto(*solver);
      EXPECT_FALSE(solver->solve({}, step).ok) << unit << ", " << solver->description();
      regular.linearizeInto(*solver);
      EXPECT_TRUE(solver->solve({}, step).ok) << unit << ", " << solver->description();
    }
  }
}

TEST(Solvers, QrKeepsTheDigitsThatNormalEquationsLose) {
  // r = A x - b with Lauchli's A: ones above, epsilon on the diagonal below. Condition about 1e9, so that of A^T A is
  // beyond double precision. Each unknown is a block.
  constexpr int n = 4;
  constexpr double epsilon = 1e-9;
  RandomProblem problem(std::vector<int>(n, 1), 1);
  problem.addGroup({{0, 1, 2, 3}}, n + 1);
  auto& batch = problem.batches[0];
  const VectorXd truth = VectorXd::LinSpaced(n, 1, 2);
  MatrixXd A = MatrixXd::Zero(n + 1, n);
  A.row(0).setOnes();
  A.bottomRows(n).diagonal().setConstant(epsilon);
  Eigen::Map<MatrixXd>(batch.J.data(), n + 1, n) = A;
  Eigen::Map<VectorXd>(batch.r.data(), n + 1) = -A * truth;
  slom::BlockQR qr;
  VectorXd x;
  problem.linearizeInto(qr);
  ASSERT_TRUE(qr.solve({}, x).ok);
  EXPECT_LT((x - truth).norm(), 1e-6);
  slom::BlockSolver cholesky;
  problem.linearizeInto(cholesky);
  EXPECT_FALSE(cholesky.solve({}, x).ok);
}

/// Six unknowns in each node of a random graph of six edges a node, which has no small separators.
slom::BlockStructure expander(int nodes) {
  slom::BlockStructure structure{{0}, {{.arity = 2, .blocks = {}}}};
  for (int b = 0; b < nodes; ++b) structure.offset.push_back(6 * b + 6);
  std::mt19937 rng(1);
  std::uniform_int_distribution<int> any(0, nodes - 1);
  for (int e = 0; e < 6 * nodes; ++e) structure.groups[0].blocks.push_back(any(rng));
  return structure;
}

TEST(Solvers, IterateWhereAFactorWouldBeTooLarge) {
  slom::BlockSolver solver;
  solver.analyze(expander(300));
  EXPECT_TRUE(solver.isExact());
  EXPECT_GT(solver.flops(), 1e6);
  EXPECT_NE(solver.description().find("Cholesky"), std::string::npos);
  solver.analyze(expander(8000));
  EXPECT_FALSE(solver.isExact());
  EXPECT_EQ(solver.flops(), 0);
  EXPECT_EQ(solver.description(), "system 8000 x 6, conjugate gradients with block Jacobi preconditioner");
  slom::BlockSolver forced({.method = Options::Method::conjugate_gradients});
  forced.analyze(expander(300));
  EXPECT_FALSE(forced.isExact());
}

TEST(Solvers, TightenConjugateGradientsAsTheGradientVanishes) {
  RandomProblem problem = manySmallBlocks(66, 3, 1);
  slom::DenseQR dense;
  problem.linearizeInto(dense);
  VectorXd exact, step;
  ASSERT_TRUE(dense.solve({}, exact).ok);
  slom::BlockSolver solver({.method = Options::Method::conjugate_gradients});
  EXPECT_EQ(solver.description(), "block solver that has solved nothing yet");
  solver.analyze(problem.structure);
  const auto error = [&](double scale) {  // error of the step when all residuals are multiplied by this
    RandomProblem scaled = problem;
    for (auto& batch : scaled.batches) {
      for (double& r : batch.r) r *= scale;
    }
    scaled.sendTo(solver);
    EXPECT_TRUE(solver.solve({}, step).ok);
    return (step - scale * exact).norm() / (scale * exact.norm());
  };
  const double rough = error(1), fine = error(1e-12);
  EXPECT_GT(rough, 1e-4);
  EXPECT_LT(rough, 0.5);
  EXPECT_LT(fine, 1e-4);
  EXPECT_LT(solver.gradient().dot(step), 0);
  EXPECT_EQ(
      solver.description().substr(0, 98),
      "reduced system 3 x 2 + 6 x 9 after elimination of 66 x 3, conjugate gradients with Schur-Jacobi pr");
}

std::string refusal(const Options& options) {
  try {
    slom::BlockSolver solver(options);
  } catch (const mtk::Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Solvers, BlockSolverAsksForAStructureFirst) {
  slom::BlockSolver solver;
  EXPECT_EQ(solver.description(), "block solver that has solved nothing yet");
  EXPECT_TRUE(solver.isExact());
  EXPECT_EQ(solver.flops(), 0);
  VectorXd step = VectorXd::Ones(1);
  MatrixXd X = MatrixXd::Ones(1, 1);
  std::unique_ptr<slom::InverseBlocks> blocks;
  const std::vector<std::function<void()>> calls{
      [&] { solver.beginLinearization(); }, [&] { std::ignore = solver.solve({}, step); },
      [&] { std::ignore = solver.solveFor(X, X); }, [&] { std::ignore = solver.invertBlocks({}, blocks); }};
  for (const auto& call : calls) {
    try {
      call();
      ADD_FAILURE() << "accepted";
    } catch (const mtk::Error& error) {
      EXPECT_STREQ(error.what(),
                   "[slom.not-analyzed] the block solver knows no structure yet; call analyze() first");
    }
  }
  EXPECT_EQ(step, VectorXd::Ones(1));
  EXPECT_EQ(X, MatrixXd::Ones(1, 1));
}

TEST(Solvers, RefuseImpossibleOptions) {
  EXPECT_EQ(refusal({.forcing = 1.5}),
            "[slom.bad-option] forcing is 1.500000; pass a number between 0 and 1, such as 0.1");
  EXPECT_EQ(refusal({.forcing = NAN}),
            "[slom.bad-option] forcing is nan; pass a number between 0 and 1, such as 0.1");
  EXPECT_EQ(
      refusal({.max_iterations = 0}),
      "[slom.bad-option] max_iterations of conjugate gradients is 0; pass a positive number, such as 500");
  if (slom::Cholmod::isAvailable()) return;
  try {
    slom::Cholmod solver;
    FAIL() << "this build is without CHOLMOD";
  } catch (const mtk::Error& error) {
    EXPECT_STREQ(error.what(),
                 "[slom.no-cholmod] this build of SLoM is without CHOLMOD; configure it with "
                 "-DSLOM_WITH_CHOLMOD=ON, or use the default solver");
  }
}

}  // namespace
