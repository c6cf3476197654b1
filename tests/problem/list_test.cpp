// Measurements over lists of variables: the same fit as typed ones, on any number of threads; handles of any type;
// errors.
#include <numeric>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include <slom/archive.hpp>
#include <slom/measurements.hpp>
#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace slom::testing {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Variables = std::span<const VariableView>;
using SO3 = mtk::SO3<>;
using SE3 = mtk::trafo<SO3>;
using Vec3 = mtk::vect<3>;

/// The distances from a pose to all points behind it, less the scale times the measured ones.
struct Distances {
  VectorXd operator()(Variables x, const VectorXd& measured) const {
    VectorXd r(measured.size());
    const double scale = x[1].as<double>();
    for (Eigen::Index i = 0; i < r.size(); ++i)
      r[i] = (x[0].as<SE3>().inverse() * x[static_cast<std::size_t>(i) + 2].as<Vec3>()).norm() -
             scale * measured[i];
    return r;
  }
};

/// The same problem twice: with run-time kinds, and with typed measurements only.
struct Twin {
  Estimator est;
  std::vector<VarID<SE3>> poses;
  std::vector<VarID<Vec3>> points;
  VarID<double> scale;
  VarID<Eigen::VectorXd> numbers;

  explicit Twin(bool at_run_time, int pose_count = 6) {
    std::mt19937 engine(11);
    std::normal_distribution<double> normal;
    const auto vector = [&](double size) {
      const double x = size * normal(engine), y = size * normal(engine), z = size * normal(engine);
      return Vec3(x, y, z);
    };
    for (int i = 0; i < pose_count; ++i) {
      const SE3 pose(SO3::exp(vector(0.5)), vector(3));
      poses.push_back(est.insertRV(pose));
      if (at_run_time) {
        est.insertMeasurement(GaussianPrior({poses.back()}, 2 * MatrixXd::Identity(6, 6)));
      } else {
        est.prior(poses.back(), pose, 0.5);
      }
    }
    for (int j = 0; j < 8; ++j) points.push_back(est.insertRV(vector(8)));
    scale = est.insertRV(1.1);
    numbers = est.insertRV(Eigen::VectorXd(VectorXd::LinSpaced(3, 0, 1)));
    est.prior(scale, 1.0, 0.1);
    est.prior(numbers, VectorXd::Ones(3), 2.0);
    for (int j = 0; j < 8; ++j) est.prior(points[static_cast<std::size_t>(j)], vector(8), 1.0);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const int count = 1 + static_cast<int>(engine() % 4), first = static_cast<int>(engine() % 4);
      VectorXd distances(count);
      for (double& d : distances) d = 5 + normal(engine);
      insertDistances(at_run_time, i, static_cast<std::size_t>(first), distances);
      insertSum(at_run_time, i);
    }
  }

  void insertDistances(bool at_run_time, std::size_t i, std::size_t first, const VectorXd& distances) {
    const StandardDeviation sigma(0.3);
    if (at_run_time) {
      std::vector<AnyVarID> variables{poses[i], scale};
      for (Eigen::Index k = 0; k < distances.size(); ++k)
        variables.emplace_back(points[first + static_cast<std::size_t>(k)]);
      est.insertMeasurement(Distances(), variables, distances, sigma, Huber(3));
      return;
    }
    const auto one = [](const SE3& pose, const double& s, const Vec3& point, double d) {
      return (pose.inverse() * point).norm() - s * d;
    };
    if (distances.size() == 1) {
      est.insertMeasurement(one, poses[i], scale, points[first], distances[0], sigma, Huber(3));
    } else if (distances.size() == 2) {
      est.insertMeasurement(
          [one](const SE3& pose, const double& s, const Vec3& a, const Vec3& b, const VectorXd& d) {
            return VectorXd(Eigen::Vector2d(one(pose, s, a, d[0]), one(pose, s, b, d[1])));
          },
          poses[i], scale, points[first], points[first + 1], distances, sigma, Huber(3));
    } else if (distances.size() == 3) {
      est.insertMeasurement(
          [one](const SE3& pose, const double& s, const Vec3& a, const Vec3& b, const Vec3& c,
                const VectorXd& d) {
            return VectorXd(
                Eigen::Vector3d(one(pose, s, a, d[0]), one(pose, s, b, d[1]), one(pose, s, c, d[2])));
          },
          poses[i], scale, points[first], points[first + 1], points[first + 2], distances, sigma, Huber(3));
    } else {
      est.insertMeasurement(
          [one](const SE3& pose, const double& s, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& e,
                const VectorXd& d) {
            return VectorXd(Eigen::Vector4d(one(pose, s, a, d[0]), one(pose, s, b, d[1]),
                                            one(pose, s, c, d[2]), one(pose, s, e, d[3])));
          },
          poses[i], scale, points[first], points[first + 1], points[first + 2], points[first + 3], distances,
          sigma, Huber(3));
    }
  }

  /// A number, of a dynamic-size variable and of one variable twice.
  void insertSum(bool at_run_time, std::size_t i) {
    const double target = static_cast<double>(i);
    if (at_run_time) {
      est.insertMeasurement(
          [](Variables x, double z) {
            return x[0].as<Eigen::VectorXd>().sum() + x[1].as<double>() * x[2].as<double>() - z;
          },
          {numbers, scale, scale}, target);
    } else {
      est.insertMeasurement([](const Eigen::VectorXd& v, const double& a, const double& b,
                               double z) { return v.sum() + a * b - z; },
                            numbers, scale, scale, target);
    }
  }

  VectorXd values() const {
    std::vector<double> all{*scale, (*numbers)[0], (*numbers)[1], (*numbers)[2]};
    for (const auto& pose : poses) {
      for (int i = 0; i < 3; ++i) all.push_back(pose->pos[i]);
      for (int i = 0; i < 4; ++i) all.push_back(pose->orient.coeffs()[i]);
    }
    for (const auto& point : points) {
      for (int i = 0; i < 3; ++i) all.push_back((*point)[i]);
    }
    return Eigen::Map<VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
  }
};

TEST(RunTimeKinds, FitAsTypedOnesDo) {
  Twin run_time(true), typed(false);
  EXPECT_NEAR(run_time.est.getRSS(), typed.est.getRSS(), 1e-12 * typed.est.getRSS());
  EXPECT_EQ(run_time.est.getM(), typed.est.getM());
  for (Twin* twin : {&run_time, &typed}) {
    EXPECT_TRUE(twin->est.optimize().converged);
    for (int i = 0; i < 10; ++i) twin->est.optimizeStep();
  }
  EXPECT_LT((run_time.values() - typed.values()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(run_time.est.getRSS(), typed.est.getRSS(), 1e-12 * typed.est.getRSS());
  EXPECT_LT((run_time.est.covariance(run_time.poses[2]) - typed.est.covariance(typed.poses[2])).norm(), 1e-8);
}

TEST(RunTimeKinds, GiveTheSameBitsOnAnyNumberOfThreads) {
  VectorXd first;
  for (const int threads : {1, 2, 4}) {
    Twin twin(true, 200);
    twin.est.setThreads(threads);
    twin.est.optimize();
    if (threads == 1) first = twin.values();
    EXPECT_EQ(twin.values(), first) << threads;
  }
}

TEST(RunTimeKinds, AreOneGroupWithNumericDerivatives) {
  Twin twin(true);
  const Summary summary = twin.est.optimize();
  const auto group = std::find_if(summary.groups.begin(), summary.groups.end(),
                                  [](const GroupSummary& g) { return g.name == "Distances"; });
  ASSERT_NE(group, summary.groups.end()) << summary;
  EXPECT_EQ(group->measurements, 6);
  EXPECT_EQ(group->derivatives, "numeric");
  EXPECT_EQ(std::count_if(summary.groups.begin(), summary.groups.end(),
                          [](const GroupSummary& g) { return g.name.rfind("Distances", 0) == 0; }),
            1);
}

TEST(RunTimeKinds, AreRemoved) {
  Twin with(true), without(true);
  std::vector<MeasID<ListMeasurement<Distances, VectorXd>>> ids;
  for (std::size_t k = 1; k < 5; ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      std::vector<AnyVarID> variables{with.poses[i], with.scale};
      for (std::size_t j = 0; j < k; ++j) variables.emplace_back(with.points[j]);
      ids.push_back(with.est.insertMeasurement(Distances(), variables,
                                               VectorXd(VectorXd::Ones(static_cast<Eigen::Index>(k)))));
    }
  }
  EXPECT_EQ(with.est.residual(ids[4]).size(), 2);
  for (const std::size_t i : {4u, 0u, 11u, 2u, 1u, 3u, 10u, 5u, 9u, 7u, 6u, 8u})
    with.est.removeMeasurement(ids[i]);
  EXPECT_EQ(
      messageOf([&] { with.est.removeMeasurement(ids[4]); }),
      "[slom.stale-handle] the MeasID<Distances> refers to a measurement that has been removed; keep the MeasID that "
      "insertMeasurement returned last");
  EXPECT_EQ(with.est.getRSS(), without.est.getRSS());
  EXPECT_EQ(messageOf([&] { with.est.removeRV(with.numbers); }),
            "[slom.variable-in-use] variable " + with.est.nameOf(with.numbers) +
                " cannot be removed: 7 measurements depend on it; remove them first");
}

TEST(AnyVarID, KnowsItsType) {
  Estimator est;
  const auto a = est.insertRV(1.5, "a");
  const auto b = est.insertRV(Vec3(1, 2, 3), "b");
  AnyVarID any = a;
  EXPECT_TRUE(any.is<double>());
  EXPECT_FALSE(any.is<Vec3>());
  EXPECT_EQ(any.as<double>(), 1.5);
  EXPECT_EQ(any.dof(), 1);
  EXPECT_TRUE(any.id<double>() == a);
  est.reinitRV(a, 2.5);
  EXPECT_EQ(any.as<double>(), 2.5);
  EXPECT_FALSE(any == AnyVarID(b));
  any = b;
  EXPECT_TRUE(any == AnyVarID(b));
  EXPECT_EQ(any.dof(), 3);
  EXPECT_EQ(
      messageOf([&] { any.as<double>(); }),
      "[slom.wrong-type] the variable is a vect<3>, it was asked for as a double; ask for it by its own type, "
      "as<vect<3>>()");
  EXPECT_EQ(
      messageOf([&] { any.id<SE3>(); }),
      "[slom.wrong-type] the variable is a vect<3>, it was asked for as a trafo<SO3>; ask for it by its own type, "
      "as<vect<3>>()");
  est.removeRV(b);
  EXPECT_FALSE(any.isValid());
  EXPECT_EQ(
      messageOf([&] { any.as<Vec3>(); }),
      "[slom.stale-handle] the VarID<vect<3>> refers to a variable that has been removed; keep the VarID that "
      "insertRV returned last");
  EXPECT_EQ(messageOf([&] { AnyVarID(VarID<double>()).as<double>(); }),
            "[slom.stale-handle] the AnyVarID refers to no variable; assign it the result of insertRV first");
}

TEST(RunTimeKinds, ErrorsLeaveTheEstimatorAsItWas) {
  Estimator est, other;
  const auto x = est.insertRV(1.0, "x"), y = est.insertRV(2.0, "y");
  const auto foreign = other.insertRV(1.0);
  const auto gone = est.insertRV(3.0);
  est.removeRV(gone);
  const auto sum = [](Variables v) {
    double all = 0;
    for (const VariableView& one : v) all += one.as<double>();
    return all;
  };
  EXPECT_EQ(
      messageOf([&] { est.insertMeasurement(sum, std::vector<AnyVarID>()); }),
      "[slom.no-variables] the measurement over a list has no variables, its list is empty; pass the VarID of at "
      "least one");
  EXPECT_EQ(
      messageOf([&] {
        est.insertMeasurement(sum, {x, gone});
      }),
      "[slom.stale-handle] the VarID<double> refers to a variable that has been removed; keep the VarID that "
      "insertRV returned last");
  EXPECT_EQ(
      messageOf([&] {
        est.insertMeasurement(sum, {x, foreign});
      }),
      "[slom.foreign-handle] the VarID<double> belongs to another estimator; use it only with the estimator whose "
      "insertRV returned it");
  const auto wrong = [](Variables v) { return v[1].as<Vec3>()[0]; };
  EXPECT_EQ(
      messageOf([&] {
        est.insertMeasurement(wrong, {x, y});
      }),
      "[slom.wrong-type] the variable is a double, it was asked for as a vect<3>; ask for it by its own type, "
      "as<double>()");
  const auto throwing = [](Variables) -> double { throw std::runtime_error("no"); };
  EXPECT_EQ(
      messageOf([&] {
        est.insertMeasurement(throwing, {x, y}, named("thrower"));
      }),
      "[slom.measurement-threw] the function of measurement thrower #1 threw an exception (no) at x = (1), y "
      "= (2); let it return NaN if it has no value, and the step is taken back");
  EXPECT_EQ(est.getM(), 0);
  EXPECT_TRUE(est.optimize().groups.empty());
  est.removeRV(y);  // no measurement has it
  const auto z = est.insertRV(2.0, "z");
  const auto growing = [](Variables v) -> VectorXd {
    return VectorXd::Constant(v[0].as<double>() > 1 ? 3 : 2, v[1].as<double>());
  };
  est.insertMeasurement(growing, {x, z}, named("growing"));
  est.reinitRV(x, 1.5);
  EXPECT_EQ(
      messageOf([&] { est.getRSS(); }),
      "[slom.residual-length] measurement growing #1 returned a residual of length 3 but had length 2 when it was "
      "inserted; return the same length for all values of the variables");
  EXPECT_EQ(*x, 1.5);
}

TEST(RunTimeKinds, CallablesAreSavedAndLoaded) {
  Archive archive;
  archive.variable<SE3>("pose");
  archive.variable<Vec3>("point");
  archive.variable<Eigen::VectorXd>("numbers");
  archive.measurement<Distances, std::vector<AnyVarID>, VectorXd>("distances");
  archive.measurement<Prior, VarID<double>, Measured<double>>();
  Estimator est;
  const auto pose = est.insertRV(SE3(SO3(), Vec3(1, 2, 3)), "pose");
  const auto scale = est.insertRV(1.25, "scale");
  const auto a = est.insertRV(Vec3(4, 5, 6), "a"), b = est.insertRV(Vec3(1, 5, 6), "b");
  est.insertMeasurement(Distances(), {pose, scale, a, b}, VectorXd(Eigen::Vector2d(5, 4)), Huber(2));
  est.insertMeasurement(Distances(), {pose, scale, b}, VectorXd(VectorXd::Constant(1, 3.5)));
  est.prior(scale, 1.0, 0.1);
  std::ostringstream text;
  archive.save(est, text);
  std::istringstream file(text.str());
  StoredProblem loaded = archive.load(file);
  EXPECT_EQ(loaded.estimator.getRSS(), est.getRSS());
  EXPECT_EQ(loaded.estimator.getM(), est.getM());
}

}  // namespace
}  // namespace slom::testing
