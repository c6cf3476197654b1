// The dense kernels of every instruction set that this processor has, against Eigen; AVX-512 to the bits of AVX2.
#include "../../src/solve/dense/kernels.hpp"

#include <algorithm>
#include <functional>
#include <random>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "../../src/solve/dense/child_rows.hpp"

namespace slom::dense {

extern const Kernels kPortableKernels;
#if defined(__x86_64__)
extern const Kernels kAvx2Kernels, kAvx512Kernels;
#endif

namespace {

using Eigen::MatrixXd;
using Numbers = std::vector<double>;

std::vector<const Kernels*> available() {
  std::vector<const Kernels*> all{&kPortableKernels};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) all.push_back(&kAvx2Kernels);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq")) {
    all.push_back(&kAvx512Kernels);
  }
#endif
  return all;
}

/// Results of all sets: near each other, and of the last two the same.
void expectAlike(const std::vector<Numbers>& results, const char* what) {
  for (std::size_t k = 1; k < results.size(); ++k) {
    for (std::size_t i = 0; i < results[0].size(); ++i) {
      ASSERT_NEAR(results[k][i], results[0][i], 1e-11 * (1 + std::abs(results[0][i])))
          << what << " " << available()[k]->name;
    }
  }
  if (results.size() == 3) {
    EXPECT_EQ(results[1], results[2]) << what;
  }
}

struct Random {
  std::mt19937_64 engine{1};
  std::normal_distribution<double> normal;
  double operator()() { return normal(engine); }
  MatrixXd matrix(int rows, int cols) {
    MatrixXd m(rows, cols);
    for (double& x : m.reshaped()) x = (*this)();
    return m;
  }
};

std::size_t panelAt(int p, int i, int j) {
  return static_cast<std::size_t>(kStripe * p * (i / kStripe) + kStripe * j + i % kStripe);
}
Numbers panelOf(const MatrixXd& m) {
  const int rows = static_cast<int>(m.rows()), p = static_cast<int>(m.cols());
  Numbers panel(panelSize(rows, p));
  for (int j = 0; j < p; ++j) {
    for (int i = 0; i < rows; ++i) panel[panelAt(p, i, j)] = m(i, j);
  }
  return panel;
}

TEST(Kernels, FactoriseFrontsAsEigenDoes) {
  Random random;
  for (const int p : {1, 2, 3, 4, 5, 8, 9, 11, 12, 13, 24, 31, 48}) {
    for (const int u : {1, 4, 5, 7, 12, 13, 30}) {
      const MatrixXd G = random.matrix(p, p), A = G * G.transpose() + p * MatrixXd::Identity(p, p),
                     B = random.matrix(u, p);
      const MatrixXd L = A.llt().matrixL();
      const MatrixXd X = L.triangularView<Eigen::Lower>().solve(B.transpose()).transpose();
      const Numbers least(static_cast<std::size_t>(p), 0.0);
      std::vector<Numbers> factors, panels, updates;
      for (const Kernels* kernels : available()) {
        Numbers D = panelOf(A), inverse(static_cast<std::size_t>(p)), below = panelOf(B),
                U(updateSize(u) + kStripe);
        double pivot = 0;
        ASSERT_EQ(kernels->factorize(D.data(), p, least.data(), inverse.data(), &pivot), p);
        kernels->solveStripes(D.data(), inverse.data(), p, below.data(), u, 0, stripesOf(u));
        kernels->updateStripes(below.data(), p, u, U.data(), 0, stripesOf(u));
        for (int j = 0; j < p; ++j) {
          EXPECT_NEAR(inverse[static_cast<std::size_t>(j)] * L(j, j), 1, 1e-12);
          for (int i = j; i < p; ++i) ASSERT_NEAR(D[panelAt(p, i, j)], L(i, j), 1e-12 * p) << kernels->name;
          for (int i = 0; i < u; ++i)
            ASSERT_NEAR(below[panelAt(p, i, j)], X(i, j), 1e-12 * p) << kernels->name;
        }
        Numbers triangle;
        for (int j = 0; j < u; ++j) {
          for (int i = j; i < u; ++i) {
            triangle.push_back(
                U[updateOffset(i / kStripe) + static_cast<std::size_t>(kStripe * j + i % kStripe)]);
            ASSERT_NEAR(triangle.back(), -X.row(i).dot(X.row(j)), 1e-11 * p)
                << kernels->name << " p " << p << " u " << u;
          }
        }
        factors.push_back(inverse);
        panels.push_back(below);
        updates.push_back(triangle);
      }
      expectAlike(factors, "pivots");
      expectAlike(panels, "panel");
      expectAlike(updates, "update");
    }
  }
}

std::size_t updateAt(int i, int j) {
  return updateOffset(i / kStripe) + static_cast<std::size_t>(kStripe * j + i % kStripe);
}

/// Adds a child's update, whose rows are at these places in the front, and compares entry by entry.
void expectAdded(int p, int u, const std::vector<int>& targets, const std::vector<int>& blocks) {
  Random random;
  const int n = static_cast<int>(targets.size());
  ChildRows rows;
  for (int row = 0, k = 0; row < n; row += blocks[static_cast<std::size_t>(k++)])
    rows.add(targets[static_cast<std::size_t>(row)], blocks[static_cast<std::size_t>(k)], p);
  rows.finish(p);
  ASSERT_EQ(rows.rows(), n);
  EXPECT_EQ(rows.is_sorted, std::is_sorted(targets.begin(), targets.end()));
  Numbers update(updateSize(n)), D(panelSize(p, p)), B(panelSize(u, p)), U(updateSize(u));
  for (Numbers* numbers : {&update, &D, &B, &U})
    std::generate(numbers->begin(), numbers->end(), std::ref(random));
  const auto entry = [&](Numbers& d, Numbers& b, Numbers& up, int i, int j) -> double& {
    return i < p ? d[panelAt(p, i, j)] : j < p ? b[panelAt(p, i - p, j)] : up[updateAt(i - p, j - p)];
  };
  Numbers expected_D = D, expected_B = B, expected_U = U;
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b <= a; ++b) {
      const auto [j, i] =
          std::minmax(targets[static_cast<std::size_t>(a)], targets[static_cast<std::size_t>(b)]);
      entry(expected_D, expected_B, expected_U, i, j) += update[updateAt(a, b)];
    }
  }
  for (const Kernels* kernels : available()) {
    for (const bool as_sorted : {false, true}) {
      if (as_sorted && !rows.is_sorted) continue;
      const ShuffledChild child = rows.child(update.data());
      Numbers d = D, b = B, up = U;
      (as_sorted ? kernels->addToPanel(child, d.data(), b.data(), p)
                 : kernels->addShuffledToPanel(child, d.data(), b.data(), p));
      EXPECT_EQ(up, U);
      EXPECT_EQ(d, expected_D) << kernels->name << " p=" << p << " u=" << u << " rows=" << n;
      EXPECT_EQ(b, expected_B) << kernels->name << " p=" << p << " u=" << u << " rows=" << n;
      d = D, b = B;
      (as_sorted ? kernels->addToUpdate(child, up.data(), p)
                 : kernels->addShuffledToUpdate(child, up.data(), p));
      EXPECT_EQ(d, D);
      EXPECT_EQ(b, B);
      EXPECT_EQ(up, expected_U) << kernels->name << " p=" << p << " u=" << u << " rows=" << n;
    }
  }
}

TEST(Kernels, AddUpdatesOfChildrenInAnyOrderOfTheirRows) {
  std::mt19937 engine(1);
  const auto draw = [&](int least, int most) {
    return std::uniform_int_distribution<int>(least, most)(engine);
  };
  for (int round = 0; round < 300; ++round) {
    // Blocks of the front, of which the child has some, in their order or in any.
    std::vector<std::pair<int, int>> front_blocks;  // first row, rows
    int p = 0, rows = 0;
    for (int k = draw(1, 12); k > 0; --k) {
      front_blocks.emplace_back(rows, round % 3 == 0 ? 6 : draw(1, 9));
      rows += front_blocks.back().second;
      if (p == 0 || draw(0, 2) == 0) p = rows;
    }
    if (round % 2 == 0) std::shuffle(front_blocks.begin(), front_blocks.end(), engine);
    std::vector<int> targets, blocks;
    for (const auto& [first, count] : front_blocks) {
      if (draw(0, 3) == 0) continue;
      blocks.push_back(count);
      for (int i = 0; i < count; ++i) targets.push_back(first + i);
    }
    expectAdded(p, rows - p, targets, blocks);
  }
}

TEST(Kernels, EliminatePointsAsEigenDoes) {
  Random random;
  struct Shape {
    int d, k, l;
  };
  for (const auto& [d, k, l] : {Shape{3, 9, 9},
                                {3, 9, 6},
                                {3, 9, 4},
                                {3, 6, 6},
                                {3, 6, 9},
                                {2, 3, 3},
                                {2, 3, 5},
                                {1, 2, 2},
                                {3, 7, 7}}) {
    const MatrixXd G = random.matrix(d, d),
                   L = (G * G.transpose() + MatrixXd::Identity(d, d)).llt().matrixL();
    MatrixXd packed = L;
    packed.diagonal() = L.diagonal().cwiseInverse();
    const MatrixXd W = random.matrix(k, d), V = random.matrix(l, d), H = random.matrix(k, l);
    const MatrixXd Yw = L.triangularView<Eigen::Lower>().solve(W.transpose()).transpose();
    const MatrixXd Yv = L.triangularView<Eigen::Lower>().solve(V.transpose()).transpose();
    const MatrixXd left = H - 3 * Yw * Yv.transpose();
    std::vector<Numbers> results;
    for (const Kernels* kernels : available()) {
      const auto size = static_cast<std::size_t>(paddedRows(k) * d);
      Numbers Y(size + static_cast<std::size_t>(paddedRows(l) * d) + 8), to(H.data(), H.data() + H.size());
      kernels->solveRight(d, k, packed.data(), W.data(), Y.data());
      kernels->solveRight(d, l, packed.data(), V.data(), Y.data() + size);
      const Pair pair{0, static_cast<std::uint32_t>(size / kRowPadding)};
      const Pair pairs[] = {pair, pair, pair};
      kernels->subtractOuters(d, k, l, 3, pairs, Y.data(), to.data());
      EXPECT_LT((Eigen::Map<const MatrixXd>(to.data(), k, l) - left).norm(), 1e-12 * left.norm())
          << kernels->name;
      results.push_back(to);
    }
    expectAlike(results, "outer products");
  }
}

TEST(Kernels, MultiplyStackedRowsAsEigenDoes) {
  Random random;
  for (const int rows : {kGramRows, 3 * kGramRows, 8 * kGramRows}) {
    for (const int columns : {1, 2, 4, 17}) {
      const MatrixXd S = random.matrix(rows + 5, columns);
      const MatrixXd expected = S.topRows(rows).transpose() * S.topRows(rows);
      std::vector<Numbers> results;
      for (const Kernels* kernels : available()) {
        Numbers P(static_cast<std::size_t>(columns * columns), 0.0);
        kernels->gram(rows, columns, rows + 5, S.data(), P.data());
        for (int i = 0; i < columns; ++i) {
          for (int j = 0; j <= i; ++j)
            EXPECT_NEAR(P[static_cast<std::size_t>(i * columns + j)], expected(i, j), 1e-13 * rows)
                << kernels->name;
        }
        results.push_back(P);
      }
      expectAlike(results, "S^T S");
    }
  }
}

TEST(Kernels, AddWhatAMeasurementOfTwoVariablesDoes) {
  Random random;
  struct Shape {
    int rows, k, l;
  };
  for (const auto& [rows, k, l] : {Shape{2, 9, 3}, {2, 6, 3}, {3, 6, 3}, {6, 6, 6}, {3, 3, 3}, {2, 3, 2}}) {
    const MatrixXd A = random.matrix(rows, k), B = random.matrix(rows, l), r = random.matrix(rows, 1);
    const MatrixXd AA = random.matrix(k, k), BB = random.matrix(l, l), AB = random.matrix(k, l);
    const MatrixXd Ar = random.matrix(k, 1), Br = random.matrix(l, 1);
    for (const bool is_new : {false, true}) {
      const MatrixXd before = is_new ? MatrixXd(MatrixXd::Zero(k, l)) : AB;
      std::vector<Numbers> results;
      for (const Kernels* kernels : available()) {
        MatrixXd aa = AA, bb = BB, ab = AB, ar = Ar, br = Br;
        const PairProduct pair{A.data(),  B.data(),  r.data(),  aa.data(), bb.data(),
                               ab.data(), ar.data(), br.data(), is_new};
        ASSERT_TRUE(kernels->addPairs(rows, k, l, 1, &pair));
        EXPECT_LT((aa - AA - A.transpose() * A).norm() + (bb - BB - B.transpose() * B).norm() +
                      (ab - before - A.transpose() * B).norm() + (ar - Ar - A.transpose() * r).norm() +
                      (br - Br - B.transpose() * r).norm(),
                  1e-12)
            << kernels->name;
        Numbers all;
        for (const MatrixXd* m : {&aa, &bb, &ab, &ar, &br})
          all.insert(all.end(), m->data(), m->data() + m->size());
        results.push_back(all);
      }
      expectAlike(results, "J^T J");
    }
  }
}

}  // namespace
}  // namespace slom::dense
