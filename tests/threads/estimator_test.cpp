// Whole fits on several threads: the same bits as on one thread and, under the thread sanitizer, no race.
#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>
#include <slom/solve/block_qr.hpp>
#include <slom/solve/block_solver.hpp>

namespace {

using Pose = mtk::trafo<mtk::SO2<>>;
using Point = mtk::vect<2>;

/// Poses on a way that returns to itself, and landmarks that several of them see.
struct Map {
  slom::Estimator est;
  std::vector<slom::VarID<Pose>> poses;
  std::vector<slom::VarID<Point>> points;

  Map(int pose_count, int point_count) {
    std::mt19937 engine(3);
    std::normal_distribution<double> normal;
    for (int i = 0; i < pose_count; ++i) {
      const double turn = 2 * M_PI * i / pose_count;
      poses.push_back(
          est.insertRV(Pose(mtk::SO2<>(turn), Point(10 * std::cos(turn), 10 * std::sin(turn))), i > 0));
    }
    for (int i = 0; i < point_count; ++i)
      points.push_back(est.insertRV(Point(12 * normal(engine), 12 * normal(engine))));
    const auto noisy = [&](const Pose& pose) {
      const Point shift = 0.1 * Point(normal(engine), normal(engine));
      return Pose(mtk::SO2<>(pose.orient.angle() + 0.02 * normal(engine)), pose.pos + shift);
    };
    for (int i = 0; i < pose_count; ++i) {
      for (const int ahead : {1, 2, pose_count / 2}) {
        const auto &a = poses[std::size_t(i)], &b = poses[std::size_t((i + ahead) % pose_count)];
        est.insertMeasurement(slom::RelativePose(), a, b, slom::measured(noisy(a->inverse() * *b)),
                              slom::StandardDeviation(0.1), slom::Huber(2));
      }
    }
    for (int i = 0; i < point_count; ++i) {
      for (int k = 0; k < 4; ++k) {
        const auto& a = poses[std::size_t((i + 7 * k) % pose_count)];
        const Point z = a->inverse() * *points[std::size_t(i)] + 0.1 * Point(normal(engine), normal(engine));
        est.insertMeasurement(slom::Landmark(), a, points[std::size_t(i)], slom::measured(z));
      }
    }
  }
};

struct Outcome {
  double rss = 0;
  std::vector<double> numbers;
  bool operator==(const Outcome&) const = default;
};

Outcome fitted(int pose_count, int point_count, std::unique_ptr<slom::LinearSolver> solver, int threads) {
  Map map(pose_count, point_count);
  map.est.setThreads(threads);
  if (solver != nullptr) map.est.changeSolver(std::move(solver));
  slom::Options options;
  options.max_iterations = 5;
  Outcome outcome;
  outcome.rss = map.est.optimize(options).final_rss;
  const slom::Marginals marginals = map.est.marginals();
  for (const auto& pose : map.poses) {
    outcome.numbers.insert(outcome.numbers.end(), {pose->pos[0], pose->pos[1], pose->orient.angle()});
    for (const double s : marginals.standardDeviation(pose)) outcome.numbers.push_back(s);
  }
  for (const auto& group : slom::outliers(map.est).groups) outcome.numbers.push_back(group.redundancy);
  return outcome;
}

void expectTheSame(int pose_count, int point_count, const auto& solver) {
  const Outcome alone = fitted(pose_count, point_count, solver(), 1);
  for (const int threads : {2, 4})
    EXPECT_TRUE(fitted(pose_count, point_count, solver(), threads) == alone) << threads << " threads";
}

const auto defaultSolver = [] { return std::unique_ptr<slom::LinearSolver>(); };

TEST(Threads, FitPoseGraphsToTheSameBits) { expectTheSame(1500, 0, defaultSolver); }

TEST(Threads, FitPointsThatAreEliminatedToTheSameBits) { expectTheSame(20, 1500, defaultSolver); }

TEST(Threads, FitByQrToTheSameBits) {
  expectTheSame(150, 100, [] { return std::make_unique<slom::BlockQR>(); });
}

TEST(Threads, FitByConjugateGradientsToTheSameBits) {
  using Options = slom::BlockSolverOptions;
  for (const auto preconditioner :
       {Options::Preconditioner::schur_jacobi, Options::Preconditioner::power_series}) {
    const auto fit = [&](int threads) {
      Map map(20, 600);
      map.est.setThreads(threads);
      map.est.changeSolver(std::make_unique<slom::BlockSolver>(
          Options{.method = Options::Method::conjugate_gradients, .preconditioner = preconditioner}));
      slom::Options options;
      options.max_iterations = 3;
      return map.est.optimize(options).final_rss;
    };
    const double alone = fit(1);
    for (const int threads : {2, 4}) EXPECT_EQ(fit(threads), alone);
  }
}

}  // namespace
