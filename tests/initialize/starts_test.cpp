// Start values of maps: exact without noise, the linear problems against dense QR, order and choice.
#include <Eigen/LU>
#include <Eigen/QR>
#include <gtest/gtest.h>

#include <slom/initialize.hpp>

#include "initialize/maps.hpp"
#include "support/message_of.hpp"

namespace slom::testing {
namespace {

using initialize::Start;

template <class Pose>
void expectTruth() {
  const auto truth = ring<Pose>(14, 0, 1);
  for (const Start start : {Start::odometry, Start::spanning_tree, Start::chordal, Start::build_up}) {
    auto map = scrambled(truth);
    initialize::findStart(map, start);
    EXPECT_LT(distance(map, truth), 1e-9) << toString(start);
    EXPECT_LT(initialize::rssOf(map), 1e-15) << toString(start);
  }
}
TEST(Starts, FindTheTruthInThePlane) { expectTruth<Pose2>(); }
TEST(Starts, FindTheTruthInSpace) { expectTruth<Pose3>(); }

TEST(Starts, RssIsThatOfTheFieldsResidual) {
  auto map = ring<Pose2>(9, 0.2, 2);
  double rss = 0;
  for (const auto& edge : map.edges) {
    const Pose2 error = edge.measured.inverse() * (map.poses[std::size_t(edge.from)].value.inverse() *
                                                   map.poses[std::size_t(edge.to)].value);
    Eigen::Vector3d e(error.pos[0], error.pos[1], error.orient.angle());
    rss += e.dot(edge.information * e);
  }
  for (const auto& sighting : map.sightings) {
    const Eigen::Vector2d e = map.poses[std::size_t(sighting.from)].value.inverse() *
                                  map.landmarks[std::size_t(sighting.to)].value -
                              sighting.measured;
    rss += e.dot(sighting.information * e);
  }
  EXPECT_NEAR(initialize::rssOf(map), rss, 1e-10 * rss);
}

/// min |sqrt(w) (X_j - M X_i - C)| over blocks without a value, by QR of the dense matrix.
class DenseRelaxation {
 public:
  DenseRelaxation(int rows, int columns) : rows_(rows), columns_(columns) {}
  void addBlock(const double* value = nullptr) {
    fixed_.push_back(value != nullptr);
    values_.push_back(value ? Eigen::MatrixXd(Eigen::Map<const Eigen::MatrixXd>(value, rows_, columns_))
                            : Eigen::MatrixXd::Zero(rows_, columns_));
  }
  void add(double w, int i, int j, const double* M, const double* C) {
    terms_.push_back({std::sqrt(w), i, j, Eigen::Map<const Eigen::MatrixXd>(M, rows_, rows_),
                      Eigen::Map<const Eigen::MatrixXd>(C, rows_, columns_)});
  }
  std::vector<Eigen::MatrixXd> solve() {
    std::vector<int> column_of(fixed_.size(), -1);
    int columns = 0;
    for (std::size_t k = 0; k < fixed_.size(); ++k) {
      if (!fixed_[k]) column_of[k] = rows_ * columns++;
    }
    if (columns == 0) return values_;
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(rows_ * int(terms_.size()), rows_ * columns);
    Eigen::MatrixXd B(A.rows(), columns_);
    for (int t = 0; t < int(terms_.size()); ++t) {
      const Term& term = terms_[std::size_t(t)];
      B.middleRows(rows_ * t, rows_) = term.w * term.C;
      const auto addBlock = [&](int block, const Eigen::MatrixXd& factor) {
        const int column = column_of[std::size_t(block)];
        if (column >= 0) {
          A.block(rows_ * t, column, rows_, rows_) += factor;
        } else {
          B.middleRows(rows_ * t, rows_) -= factor * values_[std::size_t(block)];
        }
      };
      addBlock(term.j, term.w * Eigen::MatrixXd::Identity(rows_, rows_));
      addBlock(term.i, -term.w * term.M);
    }
    const Eigen::MatrixXd X = A.colPivHouseholderQr().solve(B);
    for (std::size_t k = 0; k < fixed_.size(); ++k) {
      if (!fixed_[k]) values_[k] = X.middleRows(column_of[k], rows_);
    }
    return values_;
  }

 private:
  struct Term {
    double w;
    int i, j;
    Eigen::MatrixXd M, C;
  };
  int rows_, columns_;
  std::vector<bool> fixed_;
  std::vector<Eigen::MatrixXd> values_;
  std::vector<Term> terms_;
};

TEST(LinearRelaxation, EqualsDenseQr) {
  std::mt19937_64 random(3);
  const auto any = [&](int least, int most) {
    return std::uniform_int_distribution<int>(least, most)(random);
  };
  for (int trial = 0; trial < 30; ++trial) {
    const int rows = any(1, 3), columns = any(1, 3), blocks = any(1, 40);
    initialize::LinearRelaxation sparse(rows, columns);
    DenseRelaxation dense(rows, columns);
    for (int k = 0; k < blocks; ++k) {
      const Eigen::MatrixXd value = Eigen::MatrixXd::Random(rows, columns);
      const double* fixed = k == 0 || any(0, 9) == 0 ? value.data() : nullptr;
      sparse.addBlock(fixed);
      dense.addBlock(fixed);
    }
    const auto add = [&](int i, int j) {
      const Eigen::MatrixXd M = Eigen::MatrixXd::Random(rows, rows).householderQr().householderQ();
      const Eigen::MatrixXd C = Eigen::MatrixXd::Random(rows, columns);
      const double w = std::exp(std::uniform_real_distribution<double>(-3, 3)(random));
      sparse.add(w, i, j, M.data(), C.data());
      dense.add(w, i, j, M.data(), C.data());
    };
    for (int k = 1; k < blocks; ++k) add(any(0, k - 1), k);
    for (int k = 0; blocks > 1 && k < blocks; ++k) {
      const int i = any(0, blocks - 2);
      add(any(i + 1, blocks - 1), i);
    }
    ASSERT_TRUE(sparse.solve());
    const auto oracle = dense.solve();
    for (int k = 0; k < blocks; ++k) {
      const Eigen::Map<const Eigen::MatrixXd> X(sparse.value(k), rows, columns);
      EXPECT_LT((X - oracle[std::size_t(k)]).norm(), 1e-9) << "trial " << trial << ", block " << k;
    }
  }
}

TEST(LinearRelaxation, WhatNothingDeterminesIsNotSolved) {
  initialize::LinearRelaxation relaxation(1, 1);
  const double one = 1, two = 2;
  relaxation.addBlock(&one);
  relaxation.addBlock();
  relaxation.addBlock();
  relaxation.add(1, 0, 1, &one, &two);
  EXPECT_FALSE(relaxation.solve());
  EXPECT_EQ(*relaxation.value(1), 0);
}

TEST(NearestRotation, IsTheOneOfTheLeastDistance) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::Matrix3d M = Eigen::Matrix3d::Random(), R = M;
    initialize::detail::nearestRotation(3, R.data());
    ASSERT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    ASSERT_GT(R.determinant(), 0);
    for (int k = 0; k < 20; ++k) {
      mtk::SO3<> other(R);
      other.boxplus(randomTangent<mtk::vect<3>>(random, 0.3, 0.3, 3));
      EXPECT_GE((M - Eigen::Matrix3d(other.toRotationMatrix())).norm(), (M - R).norm() - 1e-12);
    }
    Eigen::Matrix2d N = Eigen::Matrix2d::Random(), Q = N;
    initialize::detail::nearestRotation(2, Q.data());
    for (double a = -3; a < 3; a += 0.1)
      EXPECT_GE((N - Eigen::Matrix2d(mtk::SO2<>(a).toRotationMatrix())).norm(), (N - Q).norm() - 1e-12);
  }
}

TEST(Growth, TakesTheSmallestIndexByTheNearestEdge) {
  // 0 - 3 - 1, 3 - 2, 1 - 2
  const std::vector<initialize::Ends> edges{{0, 3}, {1, 3}, {3, 2}, {1, 2}};
  const auto tree = initialize::growth({1, 0, 0, 0}, edges);
  ASSERT_EQ(tree.size(), 3u);
  const auto expectStep = [&](std::size_t k, int edge, int parent, int child, bool is_forward) {
    EXPECT_EQ(tree[k].edge, edge);
    EXPECT_EQ(tree[k].parent, parent);
    EXPECT_EQ(tree[k].child, child);
    EXPECT_EQ(tree[k].is_forward, is_forward);
  };
  expectStep(0, 0, 0, 3, true);
  expectStep(1, 1, 3, 1, false);
  expectStep(2, 2, 3, 2, true);
}

TEST(Starts, NoisyMapsEndInTheSameMinimum) {
  for (const std::uint64_t seed : {5, 6, 7}) {
    const auto map = scrambled(ring<Pose3>(40, 0.02, seed));
    double rss = 0;
    for (const Start start : {Start::chordal, Start::build_up}) {
      auto here = map;
      initialize::findStart(here, start);
      const double found = initialize::rssOf(here);
      if (start == Start::chordal) {
        rss = found;
      } else {
        EXPECT_LE(found, rss);  // which has been fitted
        EXPECT_GT(found, 0.1 * rss);
      }
    }
  }
}

TEST(Starts, WhatIsFixedStays) {
  auto map = ring<Pose2>(14, 0.05, 8);
  map.poses[7].fixed = true;
  map.landmarks[1].fixed = true;
  for (const Start start : {Start::odometry, Start::spanning_tree, Start::chordal, Start::build_up}) {
    auto here = scrambled(map);
    initialize::findStart(here, start);
    EXPECT_EQ(mtk::difference(here.poses[7].value, map.poses[7].value).norm(), 0) << toString(start);
    EXPECT_EQ((here.landmarks[1].value - map.landmarks[1].value).norm(), 0) << toString(start);
  }
}

TEST(Starts, WithoutAFixedPoseTheFirstOneStays) {
  auto map = ring<Pose2>(8, 0, 9);
  map.poses[0].fixed = false;
  const auto truth = map;
  for (std::size_t p = 1; p < map.poses.size(); ++p) map.poses[p].value = Pose2();
  for (const Start start : {Start::odometry, Start::spanning_tree, Start::chordal, Start::build_up}) {
    auto here = map;
    initialize::findStart(here, start);
    EXPECT_LT(distance(here, truth), 1e-9) << toString(start);
  }
}

TEST(BestStart, IsTheOneOfTheLowestRss) {
  const auto map = scrambled(ring<Pose3>(30, 0.1, 10));
  auto best = map;
  const initialize::Choice choice = initialize::findBestStart(best);
  ASSERT_EQ(choice.costs.size(), 4u);
  for (const auto& [start, rss] : choice.costs) {
    auto here = map;
    initialize::findStart(here, start);
    EXPECT_NEAR(initialize::rssOf(here), rss, 1e-9 * rss) << toString(start);
    EXPECT_LE(initialize::rssOf(best), rss * (1 + 1e-12));
    if (start == choice.start) {
      EXPECT_EQ(initialize::rssOf(here), initialize::rssOf(best));
    }
  }
}

TEST(BestStart, LeavesOutWhatCannotBeFound) {
  Map<Pose2> map;
  const int a = map.addPose(Pose2(), true), c = map.addPose(), b = map.addPose();
  map.addEdge(a, b, Pose2(mtk::vect<2>(1, 0)));
  map.addEdge(b, c, Pose2(mtk::vect<2>(1, 0)));
  map.edges.erase(map.edges.begin() + 1);
  map.addEdge(a, c, Pose2(mtk::vect<2>(2, 0)));
  const initialize::Choice choice = initialize::findBestStart(map);
  ASSERT_EQ(choice.costs.size(), 3u);
  EXPECT_EQ(choice.costs[0].first, Start::odometry);
  EXPECT_EQ(choice.costs[0].second, std::numeric_limits<double>::infinity());
  EXPECT_EQ(choice.start, Start::spanning_tree);
  EXPECT_EQ(map.poses[1].value.pos, (mtk::vect<2>(2, 0)));
}

TEST(Starts, MistakesAreNamed) {
  Map<Pose2> map;
  map.addPose(Pose2(), true);
  map.addPose();
  EXPECT_EQ(messageOf([&] { initialize::alongSpanningTree(map); }),
            "[slom.unreached-pose] no edges lead from a fixed pose to pose 1; add an edge between poses, or "
            "fix a pose of each part of the graph");
  for (const Start start : {Start::odometry, Start::chordal, Start::build_up}) {
    EXPECT_THROW(initialize::findStart(map, start), initialize::Unreached) << toString(start);
  }
  EXPECT_THROW(initialize::findBestStart(map), initialize::Unreached);
  map.addEdge(0, 1, Pose2(), Eigen::Matrix3d::Zero());
  EXPECT_EQ(messageOf([&] { initialize::chordal(map); }),
            "[slom.bad-information] the mean information of an edge is 0; pass positive definite matrices");
  map.addEdge(0, 2, Pose2());
  const char* const no_pose =
      "[slom.no-such-node] edge 1 leads to 2, but there are 2 nodes, numbered from 0; add the nodes before "
      "the edges";
  EXPECT_EQ(messageOf([&] { initialize::alongOdometry(map); }), no_pose);
  EXPECT_EQ(messageOf([&] { initialize::rssOf(map); }), no_pose);
  EXPECT_EQ(messageOf([&] { initialize::buildUp(map); }), no_pose);
  EXPECT_EQ(messageOf([&] { initialize::findBestStart(map); }), no_pose);
  map.edges.pop_back();
  map.addSighting(-1, 0, mtk::vect<2>());
  EXPECT_EQ(messageOf([&] { initialize::alongOdometry(map); }),
            "[slom.no-such-node] sighting 0 leads from -1, but there are 2 nodes, numbered from 0; add the "
            "nodes before the edges");
}

TEST(Starts, OfNothingAreNothing) {
  Map<Pose2> none;
  for (const Start start : {Start::odometry, Start::spanning_tree, Start::chordal, Start::build_up})
    initialize::findStart(none, start);
  EXPECT_EQ(initialize::rssOf(none), 0);
}

// A pose of a user's own: a plane that slides along a rail, without rotation.
struct OnRail {
  double place = 0;

  OnRail inverse() const { return {-place}; }
  friend OnRail operator*(const OnRail& a, const OnRail& b) { return {a.place + b.place}; }
  friend double operator*(const OnRail& a, double point) { return a.place + point; }
};

TEST(Starts, TakeAnyPosesThatComposeAndInvert) {
  initialize::PoseGraph<OnRail, double> map;
  map.addPose({2}, true);
  for (int i = 1; i < 40; ++i) {
    map.addPose();
    map.addEdge(i - 1, i, {1.0 + 0.01 * (i % 3)});
  }
  map.addLandmark();
  map.addSighting(0, 0, 10.0);
  map.addSighting(39, 0, -30.0);
  auto tree = map, built = map;
  initialize::alongSpanningTree(tree);
  EXPECT_DOUBLE_EQ(tree.poses[2].value.place, 2 + 1.01 + 1.02);
  EXPECT_DOUBLE_EQ(tree.landmarks[0].value, 12);
  initialize::buildUp(built);
  // The way of 39.39 is 40 by the landmark: 39 edges and 2 sightings share the difference.
  EXPECT_NEAR(built.poses[39].value.place, 2 + 39.39 + 39 * (40 - 39.39) / 41, 1e-9);
}

}  // namespace
}  // namespace slom::testing
