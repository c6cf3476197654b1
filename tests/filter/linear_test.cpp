// Linear problems: every filter is the Kalman filter, and every smoother the estimator's fit of all states at once.
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include <slom/filter.hpp>
#include <slom/slom.hpp>

#include "random_matrices.hpp"
#include "support/fresh_seed.hpp"

namespace slom::testing {

constexpr int N = 4, M = 2;
using State = mtk::vect<N>;
using MatrixN = Eigen::Matrix<double, N, N>;

/// x' = F x + u + w, z = H x + v.
struct LinearStep {
  MatrixN F, Q;
  Eigen::Matrix<double, M, N> H;
  Eigen::Matrix2d R;
  State u;
  mtk::vect<M> z;
};

struct Motion {
  auto operator()(const auto& x, const MatrixN& F, const State& u) const {
    using S = mtk::scalar_t<std::remove_cvref_t<decltype(x)>>;
    mtk::vect<N, S> y(u);
    for (int i = 0; i < N; ++i) {
      for (int j = 0; j < N; ++j) y[i] += F(i, j) * x[j];
    }
    return y;
  }
};
struct Observation {
  auto operator()(const auto& x, const Eigen::Matrix<double, M, N>& H, const mtk::vect<M>& z) const {
    using S = mtk::scalar_t<std::remove_cvref_t<decltype(x)>>;
    mtk::vect<M, S> r(-z);
    for (int i = 0; i < M; ++i) {
      for (int j = 0; j < N; ++j) r[i] += H(i, j) * x[j];
    }
    return r;
  }
};

class LinearFilters : public ::testing::Test {
 protected:
  LinearFilters() : random_(freshSeed()), x0_(random_.vector<N>()), P0_(random_.covariance<N>()) {
    State x(x0_ + random_.sample<N>(P0_));
    for (int k = 0; k < 30; ++k) {
      LinearStep s;
      s.F = MatrixN::Identity() + 0.2 * random_.matrix<N, N>();
      s.Q = random_.covariance<N>(0.3);
      s.H = random_.matrix<M, N>();
      s.R = random_.covariance<M>(0.5);
      s.u = random_.vector<N>();
      x = State(s.F * x + s.u + random_.sample<N>(s.Q));
      s.z = mtk::vect<M>(s.H * x + random_.sample<M>(s.R));
      steps_.push_back(s);
    }
  }

  template <class Filter>
  void expectKalman(Filter filter) {
    Eigen::Vector4d x = x0_;
    MatrixN P = P0_;
    for (const LinearStep& s : steps_) {
      x = s.F * x + s.u;
      P = (s.F * P * s.F.transpose() + s.Q).eval();
      ASSERT_TRUE(filter.predict(Motion(), Covariance(s.Q), s.F, s.u));
      EXPECT_LT((filter.state() - x).norm(), 1e-12 * (1 + x.norm()));
      EXPECT_LT((filter.covariance() - P).norm(), 1e-12 * P.norm());

      const Eigen::Matrix2d S = s.H * P * s.H.transpose() + s.R;
      const Eigen::Matrix<double, N, M> K = P * s.H.transpose() * S.inverse();
      const Eigen::Vector2d innovation = s.z - s.H * x;
      x += K * innovation;
      P = ((MatrixN::Identity() - K * s.H) * P).eval();
      const auto update = filter.update(Observation(), s.H, s.z, Covariance(s.R));
      ASSERT_TRUE(update);
      EXPECT_LT((filter.state() - x).norm(), 1e-12 * (1 + x.norm()));
      EXPECT_LT((filter.covariance() - P).norm(), 1e-12 * (1 + P.norm()));
      EXPECT_NEAR(update.nis, innovation.dot(S.inverse() * innovation), 1e-11 * (1 + update.nis));
      EXPECT_LT((update.innovation + innovation).norm(), 1e-12 * (1 + x.norm()));
    }
  }

  template <class Filter>
  void expectBatch(const Filter& filter) {
    Estimator est;
    std::vector<VarID<State>> ids{est.insertRV(x0_)};
    est.insertMeasurement(Prior(), ids[0], measured(x0_), Covariance(P0_));
    RtsSmoother run(filter);
    for (const LinearStep& s : steps_) {
      ids.push_back(est.insertRV(State()));
      est.insertMeasurement(
          [](const auto& x, const auto& next, const MatrixN& F, const State& u) {
            using S = mtk::scalar_t<std::remove_cvref_t<decltype(x)>>;
            return mtk::vect<N, S>(next - Motion()(x, F, u));
          },
          ids[ids.size() - 2], ids.back(), s.F, s.u, Covariance(s.Q));
      est.insertMeasurement(Observation(), ids.back(), s.H, s.z, Covariance(s.R));
      ASSERT_TRUE(run.predict(Motion(), Covariance(s.Q), s.F, s.u));
      ASSERT_TRUE(run.update(Observation(), s.H, s.z, Covariance(s.R)));
    }
    ASSERT_TRUE(est.optimize().converged);
    const auto smoothed = run.smoothed();
    ASSERT_EQ(smoothed.size(), ids.size());
    for (std::size_t k = 0; k < ids.size(); ++k) {
      EXPECT_LT((smoothed[k].state - *ids[k]).norm(), 1e-10 * (1 + ids[k]->norm())) << k;
      const Eigen::MatrixXd C = est.covariance(ids[k]);
      EXPECT_LT((smoothed[k].covariance - C).norm(), 1e-10 * C.norm()) << k;
    }
  }

  RandomMatrices random_;
  State x0_;
  MatrixN P0_;
  std::vector<LinearStep> steps_;
};

TEST_F(LinearFilters, ExtendedIsTheKalmanFilter) {
  expectKalman(ErrorStateFilter(x0_, Covariance(P0_)));
  expectKalman(ErrorStateFilter(x0_, Covariance(P0_), square_root));
}
TEST_F(LinearFilters, UnscentedIsTheKalmanFilter) {
  expectKalman(UnscentedFilter(x0_, Covariance(P0_)));
  expectKalman(UnscentedFilter(x0_, Covariance(P0_), square_root));
  expectKalman(UnscentedFilter(x0_, Covariance(P0_), SigmaSpread(1)));
  expectKalman(UnscentedFilter(x0_, Covariance(P0_), square_root, SigmaSpread(2.5)));
}
TEST_F(LinearFilters, SmoothersAreTheBatchFit) {
  expectBatch(ErrorStateFilter(x0_, Covariance(P0_)));
  expectBatch(ErrorStateFilter(x0_, Covariance(P0_), square_root));
  expectBatch(UnscentedFilter(x0_, Covariance(P0_)));
  expectBatch(UnscentedFilter(x0_, Covariance(P0_), square_root));
}
TEST_F(LinearFilters, NoiseAsAnArgumentIsTheSameWhereItIsAdded) {
  const auto with_noise = [](const auto& x, const auto& w, const MatrixN& F, const State& u) {
    using S = mtk::scalar_t<std::remove_cvref_t<decltype(x)>>;
    return mtk::vect<N, S>(Motion()(x, F, u) + w);
  };
  const auto expectSame = [&](auto filter) {
    auto other = filter;
    for (const LinearStep& s : steps_) {
      ASSERT_TRUE(filter.predict(Motion(), Covariance(s.Q), s.F, s.u));
      ASSERT_TRUE(other.predict(with_noise, noiseArgument<N>(Covariance(s.Q)), s.F, s.u));
      EXPECT_LT((filter.state() - other.state()).norm(), 1e-12 * (1 + filter.state().norm()));
      EXPECT_LT((filter.covariance() - other.covariance()).norm(), 1e-12 * filter.covariance().norm());
    }
  };
  expectSame(ErrorStateFilter(x0_, Covariance(P0_)));
  expectSame(ErrorStateFilter(x0_, Covariance(P0_), square_root));
  expectSame(UnscentedFilter(x0_, Covariance(P0_)));
  expectSame(UnscentedFilter(x0_, Covariance(P0_), square_root));
}
TEST_F(LinearFilters, FormsOfNoiseAreOneNoise) {
  const Eigen::Vector4d sigma = (0.5 + random_.matrix<N, 1>().array().abs()).matrix();
  const MatrixN L = P0_.llt().matrixL();
  const auto expectCovariance = [&](const auto& noise, const MatrixN& P) {
    EXPECT_LT((ErrorStateFilter(x0_, noise).covariance() - P).norm(), 1e-12 * P.norm());
    EXPECT_LT((ErrorStateFilter(x0_, noise, square_root).covariance() - P).norm(), 1e-12 * P.norm());
  };
  const MatrixN variances = sigma.cwiseAbs2().asDiagonal();
  expectCovariance(Covariance(P0_), P0_);
  expectCovariance(StandardDeviation(L), P0_);
  expectCovariance(InvCovariance(P0_.inverse().eval().selfadjointView<Eigen::Lower>().toDenseMatrix()), P0_);
  expectCovariance(InvStandardDeviation(MatrixN(L.inverse().triangularView<Eigen::Lower>())), P0_);
  expectCovariance(StandardDeviation(sigma), variances);
  expectCovariance(Covariance(Eigen::Vector4d(sigma.cwiseAbs2())), variances);
  expectCovariance(InvCovariance(Eigen::Vector4d(sigma.cwiseAbs2().cwiseInverse())), variances);
  expectCovariance(InvStandardDeviation(Eigen::Vector4d(sigma.cwiseInverse())), variances);
  expectCovariance(StandardDeviation(Eigen::VectorXd(sigma)), variances);
  expectCovariance(Covariance(Eigen::MatrixXd(P0_)), P0_);
  expectCovariance(StandardDeviation(2), 4 * MatrixN::Identity());
}

}  // namespace slom::testing
