// Readings of an IMU integrated between two times, against an integration in long double of the same smooth motion.
#include "slom/measurements/preintegration.hpp"

#include <optional>

#include <Eigen/Cholesky>

#include <mtk/testing/random.hpp>

#include "measurements/formulas.hpp"
#include "support/fresh_seed.hpp"

namespace slom::testing {
namespace {

using Noise = mtk::testing::Random;
using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Vector9 = Eigen::Matrix<double, 9, 1>;

/// Angular velocity [rad/s] and specific force [m/s^2] as sums of sines, each up to about 3 rad/s and 15 m/s^2.
class SmoothReadings {
 public:
  explicit SmoothReadings(Noise& random) {
    for (auto& axis : sines_) {
      for (Sine& sine : axis)
        sine = {random.uniform(0.3, 1.5), random.uniform(1, 9), random.uniform(0, 2 * kPi)};
    }
  }
  Long3 gyro(Real t) const { return Long3(at(0, t), at(1, t), at(2, t)); }
  Long3 force(Real t) const { return 5 * Long3(at(3, t), at(4, t), at(5, t)); }

  /// Returns readings at a rate [Hz] over 1.2 s.
  std::vector<ImuSample> sampled(double rate) const {
    std::vector<ImuSample> samples;
    for (int i = 0; i <= int(1.2 * rate); ++i) {
      const Real t = Real(i) / Real(rate) - Real(0.1);
      samples.push_back({double(t), Vec3(gyro(t).cast<double>()), Vec3(force(t).cast<double>())});
    }
    return samples;
  }

 private:
  struct Sine {
    double amplitude, frequency, phase;
  };
  Real at(int axis, Real t) const {
    Real sum = 0;
    for (const Sine& s : sines_[axis])
      sum += Real(s.amplitude) * std::sin(Real(s.frequency) * t + Real(s.phase));
    return sum;
  }
  Sine sines_[6][2];
};

/// Pose and velocity of an IMU.
struct State {
  Eigen::Quaternion<Real> q = Eigen::Quaternion<Real>::Identity();
  Long3 v = Long3::Zero(), p = Long3::Zero();

  SE3 pose() const {
    return SE3(SO3(double(q.w()), double(q.x()), double(q.y()), double(q.z())), Vec3(p.cast<double>()));
  }
  Vec3 velocity() const { return Vec3(v.cast<double>()); }
};

/// Integrates dq = q (0, w) / 2, dv = R f + g, dp = v by Runge and Kutta's method of fourth order in 2000 steps.
State integrated(const SmoothReadings& readings, State state, Real from, Real to, const Long3& gravity) {
  using Rates = Eigen::Matrix<Real, 10, 1>;
  constexpr int steps = 2000;
  const Real h = (to - from) / steps;
  const auto moved = [](const State& s, const Rates& d) {
    State other = s;
    other.q.coeffs() += d.head<4>();
    other.v += d.segment<3>(4);
    other.p += d.tail<3>();
    return other;
  };
  const auto rates = [&](Real t, const State& s) {
    const Long3 w = readings.gyro(t) / 2;
    Rates d;
    d.head<4>() = (s.q * Eigen::Quaternion<Real>(0, w.x(), w.y(), w.z())).coeffs();
    d.segment<3>(4) = s.q.normalized() * readings.force(t) + gravity;
    d.tail<3>() = s.v;
    return d;
  };
  for (int i = 0; i < steps; ++i) {
    const Real t = from + i * h;
    const Rates a = rates(t, state), b = rates(t + h / 2, moved(state, a * (h / 2)));
    const Rates c = rates(t + h / 2, moved(state, b * (h / 2))), d = rates(t + h, moved(state, c * h));
    state = moved(state, (a + 2 * b + 2 * c + d) * (h / 6));
    state.q.normalize();
  }
  return state;
}

/// Returns (rotation, velocity, position) of one motion minus another.
Vector9 difference(const ImuMotion<>& a, const ImuMotion<>& b) {
  Vector9 d;
  d << SO3::log(b.rotation.inverse() * a.rotation), a.velocity - b.velocity, a.position - b.position;
  return d;
}
Vector9 difference(const ImuMotion<>& a, const State& b) {
  return difference(a, ImuMotion<>{b.pose().orient, b.velocity(), b.pose().pos});
}

Vec3 randomVector(Noise& random, double size) {
  Vec3 v;
  for (int i = 0; i < 3; ++i) v[i] = random.uniform(-size, size);
  return v;
}

constexpr ImuNoise noise{0.002, 0.02, 1e-4, 1e-3};

/// Two times between samples, 1 s apart.
struct Times {
  explicit Times(Noise& random) : from(random.uniform(-0.05, 0.02)), to(from + random.uniform(0.9, 1)) {}
  double from, to;
};

TEST(ImuSamples, MotionConvergesToSecondOrder) {
  const unsigned seed = freshSeed();
  for (std::uint32_t run = 0; run < 5; ++run) {
    Noise random(seed, run);
    const SmoothReadings readings(random);
    const Times times(random);
    const State truth = integrated(readings, {}, times.from, times.to, Long3::Zero());
    std::vector<double> errors;
    for (const double rate : {100., 200., 400., 800.}) {
      const std::vector<ImuSample> samples = readings.sampled(rate);
      const ImuMotion<> moved = ImuSamples(samples).motion(times.from, times.to, withoutBias(Vec3(), Vec3()));
      errors.push_back(difference(moved, truth).norm());
    }
    EXPECT_LT(errors[1], 2e-3) << "at 200 Hz, run " << run;
    // The places of both times between samples change the error somewhat.
    EXPECT_GT(errors[0] / errors[3], 40)
        << errors[0] << " at 100 Hz, " << errors[3] << " at 800 Hz, run " << run;
    EXPECT_LT(errors[3], 1e-4) << "at 800 Hz, run " << run;
  }
}

TEST(ImuSamples, PiecesOfATimeJoin) {
  Noise random(freshSeed());
  const SmoothReadings readings(random);
  const std::vector<ImuSample> all = readings.sampled(200);
  const ImuSamples samples(all);
  double sum = 0, before = 0.0123;
  std::size_t pieces = 0;
  samples.pieces(before, 0.0777, [&](double h, const Vec3& gyro, const Vec3& force) {
    const Real middle = Real(before) + Real(h) / 2;
    EXPECT_LT((gyro - readings.gyro(middle).cast<double>()).norm(), 2e-3);
    EXPECT_LT((force - readings.force(middle).cast<double>()).norm(), 1e-2);
    EXPECT_GT(h, 0);
    sum += h, before += h, ++pieces;
  });
  EXPECT_NEAR(sum, 0.0777 - 0.0123, 1e-15);
  EXPECT_EQ(pieces, 14u);  // samples at 15, 20, ..., 75 ms between
}

TEST(ImuSamples, DerivativesByTimesAndBiasesAreDifferences) {
  const unsigned seed = freshSeed();
  using Dual = mtk::SparseDual<double, mtk::detail::lowColumns(8)>;
  for (std::uint32_t run = 0; run < 5; ++run) {
    Noise random(seed, run);
    const SmoothReadings readings(random);
    const std::vector<ImuSample> all = readings.sampled(200);
    const ImuSamples samples(all);
    Eigen::Matrix<double, 8, 1> x;  // times, in the middle of a sample's interval; biases
    x << 0.0012 + 0.001 * random.uniform(), 0.5512 + 0.001 * random.uniform(), randomVector(random, 0.1),
        randomVector(random, 0.5);
    const auto motionAt = [&](const Eigen::Matrix<double, 8, 1>& y) {
      return samples.motion(y[0], y[1], withoutBias(Vec3(y.segment<3>(2)), Vec3(y.tail<3>())));
    };
    Dual y[8];
    for (int i = 0; i < 8; ++i) y[i] = Dual(x[i]), y[i].partials().set(i, 1);
    const ImuMotion<Dual> moved = samples.motion(
        y[0], y[1], withoutBias(mtk::vect<3, Dual>(y[2], y[3], y[4]), mtk::vect<3, Dual>(y[5], y[6], y[7])));
    const auto turn = mtk::SO3<Dual>::log(mtk::SO3<Dual>(motionAt(x).rotation.inverse()) * moved.rotation);
    for (int j = 0; j < 8; ++j) {
      constexpr double h = 1e-4;
      Eigen::Matrix<double, 8, 1> step = Eigen::Matrix<double, 8, 1>::Zero();
      step[j] = h;
      const Vector9 expected = difference(motionAt(x + step), motionAt(x - step)) / (2 * h);
      Vector9 got;
      for (int i = 0; i < 3; ++i) {
        got[i] = turn[i].partials().get(j);
        got[3 + i] = moved.velocity[i].partials().get(j);
        got[6 + i] = moved.position[i].partials().get(j);
      }
      EXPECT_LT((got - expected).norm(), 1e-5 * (1 + expected.norm())) << "argument " << j << ", run " << run;
    }
  }
}

TEST(PreintegratedImu, OtherBiasesEnterToFirstOrder) {
  const unsigned seed = freshSeed();
  for (std::uint32_t run = 0; run < 5; ++run) {
    Noise random(seed, run);
    const std::vector<ImuSample> all = SmoothReadings(random).sampled(200);
    const ImuSamples samples(all);
    const Times times(random);
    const Vec3 gyro = randomVector(random, 0.05), force = randomVector(random, 0.3);
    const PreintegratedImu moved(samples, times.from, times.to, noise, gyro, force);
    const Vec3 by_gyro = randomVector(random, 0.01), by_force = randomVector(random, 0.1);
    const auto errorOf = [&](double scale) {
      const Vec3 g(gyro + scale * by_gyro), f(force + scale * by_force);
      const ImuMotion<> again = samples.motion(times.from, times.to, withoutBias(g, f));
      return difference(moved.motion(g, f), again).norm();
    };
    EXPECT_LT(errorOf(0), 1e-12) << "run " << run;
    EXPECT_LT(errorOf(1), 2e-3) << "run " << run;
    EXPECT_NEAR(errorOf(1) / errorOf(0.5), 4, 0.3) << "run " << run;  // what remains is of second order
  }
}

/// Copies of the readings with white noise give residuals with the stated covariance.
TEST(PreintegratedImu, CovarianceIsThatOfNoisyCopies) {
  Noise random(freshSeed());
  constexpr double rate = 200;
  constexpr int copies = 2000;
  const std::vector<ImuSample> exact = SmoothReadings(random).sampled(rate);
  const Times times(random);
  const PreintegratedImu moved(ImuSamples(exact), times.from, times.to, noise);
  const Eigen::LLT<Matrix9> covariance(moved.covariance());
  Matrix9 sum = Matrix9::Zero();
  for (int copy = 0; copy < copies; ++copy) {
    std::vector<ImuSample> noisy = exact;
    for (ImuSample& sample : noisy) {
      for (int i = 0; i < 3; ++i) {
        sample.gyro[i] += noise.gyro * std::sqrt(rate) * random.normal();
        sample.force[i] += noise.force * std::sqrt(rate) * random.normal();
      }
    }
    const ImuMotion<> other = ImuSamples(noisy).motion(times.from, times.to, withoutBias(Vec3(), Vec3()));
    const Vector9 whitened = covariance.matrixL().solve(difference(other, moved.motion(Vec3(), Vec3())));
    sum += whitened * whitened.transpose() / copies;
  }
  // 5 standard deviations; linear readings between the times and their neighbours lower the noise by less than 1 %.
  constexpr double reach = 5;
  EXPECT_NEAR(sum.trace(), 9, reach * std::sqrt(2 * 9. / copies) + 0.09);
  for (int i = 0; i < 9; ++i) {
    EXPECT_NEAR(sum(i, i), 1, reach * std::sqrt(2. / copies) + 0.02) << "component " << i;
    for (int j = 0; j < i; ++j)
      EXPECT_NEAR(sum(i, j), 0, reach * std::sqrt(1. / copies) + 0.01) << "components " << i << ", " << j;
  }
}

/// States of a motion under gravity, and the measurement of its readings.
struct Follow {
  explicit Follow(Noise& random) : readings(random), all(readings.sampled(800)) {
    const Times times(random);
    const SE3 start(SO3::exp(randomVector(random, 2)), randomVector(random, 3));
    first.q = Eigen::Quaternion<Real>(start.orient.w(), start.orient.x(), start.orient.y(), start.orient.z());
    first.q.normalize();
    first.p = start.pos.cast<Real>();
    first.v = randomVector(random, 2).cast<Real>();
    gravity = randomVector(random, 10);
    last = integrated(readings, first, times.from, times.to, gravity.cast<Real>());
    moved.emplace(ImuSamples(all), times.from, times.to, noise);
  }
  SmoothReadings readings;
  std::vector<ImuSample> all;
  State first, last;
  Vec3 gravity;
  std::optional<PreintegratedImu> moved;
};

TEST(PreintegratedImu, StatesOfAMotionUnderGravityHaveNoResidual) {
  const unsigned seed = freshSeed();
  for (std::uint32_t run = 0; run < 5; ++run) {
    Noise random(seed, run);
    const Follow follow(random);
    const auto r = (*follow.moved)(follow.first.pose(), follow.first.velocity(), Vec3(), Vec3(),
                                   follow.last.pose(), follow.last.velocity(), follow.gravity);
    EXPECT_LT(r.norm(), 1e-4) << "run " << run;  // what the rate of 800 Hz leaves
  }
}

TEST(PreintegratedImu, DerivativesAgreeWithDifferences) {
  const unsigned seed = freshSeed();
  for (std::uint32_t run = 0; run < 3; ++run) {
    Noise random(seed, run);
    const Follow follow(random);
    Estimator est;
    const auto pose = [&](const State& state) {
      Eigen::Matrix<double, 6, 1> step;
      step << randomVector(random, 0.1), randomVector(random, 0.1);
      return est.insertRV(mtk::moved(state.pose(), step));
    };
    const auto vector = [&](const Vec3& v) { return est.insertRV(Vec3(v + randomVector(random, 0.02))); };
    est.insertMeasurement(*follow.moved, pose(follow.first), vector(follow.first.velocity()), vector(Vec3()),
                          vector(Vec3()), pose(follow.last), vector(follow.last.velocity()),
                          vector(follow.gravity), Covariance(follow.moved->covariance()));
    const DerivativeCheck check = checkDerivatives(est);
    EXPECT_TRUE(check.ok()) << check.text() << "run " << run;
  }
}

}  // namespace
}  // namespace slom::testing
