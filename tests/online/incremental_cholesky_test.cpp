// The factor that follows its matrix equals, bit by bit, the one computed from scratch. Its inverse is that of the
// dense matrix.
#include "online/incremental_cholesky.hpp"

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "support/slow_with_sanitizers.hpp"

namespace slom {
namespace {

/// The smallest c with -c C <= D <= c C.
double largestShare(const Eigen::MatrixXd& D, const Eigen::MatrixXd& C) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(D, C).eigenvalues().cwiseAbs().maxCoeff();
}

TEST(IncrementalCholesky, IsTheFactorFromScratchBitByBitAndSolves) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    std::mt19937 random(seed);
    IncrementalCholesky factor;
    std::vector<int> elements, blocks;
    const auto index = [&](std::size_t n) {
      return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
    };
    const auto fill = [&](int e) {
      std::normal_distribution<double> normal;
      std::vector<double> A(factor.A(e).size()), g(A.size() / static_cast<std::size_t>(factor.rowsOf(e)));
      for (double& a : A) a = normal(random);
      for (double& x : g) x = normal(random);
      factor.setA(e, A);
      factor.setGradient(e, g);
    };
    for (int i = 0; i < (testing::hasSanitizers() ? 60 : 300); ++i) {
      const int b = static_cast<int>(blocks.size());
      factor.insertBlock(b, 1 + b % 3);
      blocks.push_back(b);
      const std::vector<int> own{b};
      elements.push_back(factor.insertElement(own, 3));
      fill(elements.back());
      for (int k = 0; k < 2 && b > 0; ++k) {
        const int other = k == 0 ? b - 1 : static_cast<int>(index(static_cast<std::size_t>(b)));
        if (k == 1 && (other == b - 1 || index(3) > 0)) continue;
        const std::vector<int> pair{other, b};
        elements.push_back(factor.insertElement(pair, 2));
        fill(elements.back());
      }
      if (index(4) == 0) {  // what is removed is not one of those that make blocks regular
        const std::size_t e = index(elements.size());
        if (factor.blocksOf(elements[e]).size() == 2) {
          factor.removeElement(elements[e]);
          elements.erase(elements.begin() + static_cast<std::ptrdiff_t>(e));
        }
      }
      if (index(3) == 0) fill(elements[index(elements.size())]);
      if (index(3) == 0) continue;
      factor.refactor();
      const std::vector<double> before = factor.content();
      const double promise = factor.promise();
      const int all = factor.frontCount();
      factor.resetWork();
      factor.recompute();
      EXPECT_EQ(factor.work().fronts_factorized, all);
      ASSERT_EQ(before, factor.content()) << "seed " << seed << ", block " << i;
      EXPECT_EQ(promise, factor.promise());

      if (i % 10 != 0) continue;
      // The step is that of a dense solver.
      std::vector<int> start{0};
      for (const int k : blocks) start.push_back(start.back() + factor.dof(k));
      Eigen::MatrixXd H = Eigen::MatrixXd::Zero(start.back(), start.back());
      Eigen::VectorXd g = Eigen::VectorXd::Zero(start.back());
      for (const int e : elements) {
        const int rows = factor.rowsOf(e);
        Eigen::MatrixXd wide = Eigen::MatrixXd::Zero(rows, start.back());
        const double* a = factor.A(e).data();
        const double* from = factor.gradient(e).data();
        for (const int k : factor.blocksOf(e)) {
          for (int c = 0; c < factor.dof(k); ++c, a += rows) {
            wide.col(start[static_cast<std::size_t>(k)] + c) = Eigen::Map<const Eigen::VectorXd>(a, rows);
            g[start[static_cast<std::size_t>(k)] + c] += *from++;
          }
        }
        H += wide.transpose() * wide;
      }
      const Eigen::VectorXd d = -H.ldlt().solve(g);
      EXPECT_NEAR(promise, -g.dot(d), 1e-9 * promise);
      Eigen::VectorXd online = Eigen::VectorXd::Zero(d.size());
      for (const auto& [block, step] : factor.solve(0)) {
        for (int c = 0; c < factor.dof(block); ++c)
          online[start[static_cast<std::size_t>(block)] + c] = step[c];
      }
      EXPECT_LT((online - d).norm(), 1e-8 * d.norm());
      const Eigen::MatrixXd C = H.inverse();
      for (const double tolerance : {0.2, 0.0}) {
        factor.updateInverse(tolerance);
        for (const int k : blocks) {
          const int first = start[static_cast<std::size_t>(k)], dof = factor.dof(k);
          Eigen::MatrixXd got(dof, dof);
          factor.writeInverse(k, got.data());
          const Eigen::MatrixXd expected = C.block(first, first, dof, dof);
          EXPECT_LT(largestShare(got - expected, got), tolerance + 1e-9) << k;
        }
      }
      for (int k = 0; k < 5; ++k) {
        const int a = blocks[index(blocks.size())], b = blocks[index(blocks.size())];
        const std::vector<double> block = factor.inverseBlock(a, b);
        const Eigen::Map<const Eigen::MatrixXd> got(block.data(), factor.dof(a), factor.dof(b));
        const auto expected = C.block(start[static_cast<std::size_t>(a)], start[static_cast<std::size_t>(b)],
                                      factor.dof(a), factor.dof(b));
        EXPECT_LT((got - expected).norm(), 1e-9 * C.norm()) << a << ", " << b;
      }
    }
  }
}

/// A growing chain: the covariance at its far end changes less and less.
TEST(IncrementalCholesky, InvertsAgainWhatHasChanged) {
  IncrementalCholesky factor;
  const auto insert = [&](const std::vector<int>& blocks, double weight) {
    const int e = factor.insertElement(blocks, 1);
    const std::vector<double> A =
        blocks.size() == 1 ? std::vector<double>{weight} : std::vector<double>{-weight, weight};
    factor.setA(e, A);
  };
  std::mt19937 random(3);
  std::uniform_real_distribution<double> weight(0.5, 2);
  constexpr int blocks = 1500;
  int inverted = 0, present = 0, all = 0;
  for (int b = 0; b < blocks; ++b) {
    factor.insertBlock(b, 1);
    insert({b}, weight(random));
    if (b > 0) insert({b - 1, b}, weight(random));
    factor.refactor();
    factor.resetWork();
    factor.updateInverse(1e-6);
    inverted += factor.work().fronts_inverted;
    present += all = factor.frontCount();
  }
  EXPECT_GT(all, 80);
  EXPECT_LT(inverted, present / 20);
  const auto allInverses = [&] {
    std::vector<double> result(blocks);
    for (int b = 0; b < blocks; ++b) factor.writeInverse(b, &result[static_cast<std::size_t>(b)]);
    return result;
  };
  const std::vector<double> approximate = allInverses();
  factor.updateInverse(0);
  const std::vector<double> exact = allInverses();
  factor.resetWork();
  factor.updateInverse(0);
  EXPECT_EQ(factor.work().fronts_inverted, 0);
  factor.recompute();
  factor.updateInverse(0);
  EXPECT_EQ(factor.work().fronts_inverted, all);
  EXPECT_EQ(exact, allInverses());  // bit by bit
  for (std::size_t b = 0; b < blocks; ++b) EXPECT_NEAR(approximate[b], exact[b], 1e-6 * exact[b]);
  EXPECT_NE(approximate, exact);
}

}  // namespace
}  // namespace slom
