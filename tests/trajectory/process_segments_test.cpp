// Segments of Gaussian processes: noise of the motion, interpolation, and derivatives by states and by time.
#include <cmath>
#include <limits>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "support/message_of.hpp"
#include "trajectory/random_segments.hpp"

namespace slom {
namespace {

using mtk::SO3;
using testing::derivativeOf;
using testing::Long;
using testing::messageOf;
using trajectory::Blending;
using trajectory::Knots;
using trajectory::WhiteNoise;
using Vec3 = mtk::vect<3>;

/// Calls f.template operator()<W>() for both kinds of noise.
template <class F>
void forEachNoise(const F& f) {
  f.template operator()<WhiteNoise::on_acceleration>();
  f.template operator()<WhiteNoise::on_jerk>();
}

/// Phi(duration): the part of a state of one component that an earlier state causes.
template <int K>
Eigen::Matrix<double, K, K> transition(double duration) {
  Eigen::Matrix<double, K, K> Phi = Eigen::Matrix<double, K, K>::Identity();
  for (int i = 0; i < K; ++i) {
    for (int j = i + 1; j < K; ++j) Phi(i, j) = std::pow(duration, j - i) / std::tgamma(j - i + 1);
  }
  return Phi;
}

TEST(ProcessNoise, IsTheIntegralOfTheNoise) {
  forEachNoise([]<WhiteNoise W>() {
    constexpr int K = static_cast<int>(W);
    for (const double duration : {0.01, 0.3, 4.0}) {
      const mtk::vect<2> density(0.7, 30);
      // Simpson's rule for the integral of Phi(T - s) l q l^T Phi(T - s)^T, l = (0, ..., 1)
      Eigen::Matrix<double, K, K> sum = Eigen::Matrix<double, K, K>::Zero();
      constexpr int pieces = 1000;
      for (int i = 0; i <= pieces; ++i) {
        const Eigen::Matrix<double, K, 1> column =
            transition<K>(duration * (1 - double(i) / pieces)).col(K - 1);
        sum += (i == 0 || i == pieces ? 1
                : i % 2 == 1          ? 4
                                      : 2) *
               duration / (3 * pieces) * column * column.transpose();
      }
      const auto Q = trajectory::processNoise<W>(duration, density);
      for (int i = 0; i < K; ++i) {
        for (int j = 0; j < K; ++j) {
          for (int d = 0; d < 2; ++d) {
            EXPECT_NEAR(Q(2 * i + d, 2 * j + d), density[d] * sum(i, j), 1e-10 * density[d] * sum(i, j));
            EXPECT_EQ(Q(2 * i + d, 2 * j + 1 - d), 0);
          }
        }
      }
    }
  });
}

TEST(ProcessNoise, OfPosesIsThatOfPositionAndOrientation) {
  mtk::vect<6> density;
  for (int i = 0; i < 6; ++i) density[i] = 1 + i;
  const trajectory::MotionPrior<WhiteNoise::on_jerk, mtk::trafo<SO3<>>> prior(0.3, density);
  const auto position = trajectory::processNoise<WhiteNoise::on_jerk>(0.3, Vec3(1, 2, 3));
  const auto orientation = trajectory::processNoise<WhiteNoise::on_jerk>(0.3, Vec3(4, 5, 6));
  EXPECT_EQ((prior.covariance().topLeftCorner<9, 9>()), position);
  EXPECT_EQ((prior.covariance().bottomRightCorner<9, 9>()), orientation);
  EXPECT_EQ((prior.covariance().topRightCorner<9, 9>().norm()), 0);
}

TEST(ProcessNoise, RefusesBadNumbers) {
  const auto noise = [](double duration, double density) {
    trajectory::processNoise<WhiteNoise::on_jerk>(duration, mtk::vect<2>(1, density));
  };
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(messageOf([&] { noise(0, 1); }),
            "[slom.bad-duration] the time between two states is 0; pass a positive and finite number");
  for (const double bad : {-1.0, nan, infinity}) {
    EXPECT_NE(messageOf([&] { noise(bad, 1); }).find("slom.bad-duration"), std::string::npos) << bad;
  }
  EXPECT_EQ(
      messageOf([&] { noise(1, -2.5); }),
      "[slom.bad-density] the power spectral density of component 1 is -2.5; pass a positive and finite number");
  for (const double bad : {0.0, nan, infinity}) {
    EXPECT_NE(messageOf([&] { noise(1, bad); }).find("slom.bad-density"), std::string::npos) << bad;
  }
  EXPECT_EQ(
      messageOf([&] {
        trajectory::PoseProcess<WhiteNoise::on_jerk>(Knots(0, 1), trajectory::poseDensity(1, 0), "pose");
      }),
      "[slom.bad-density] the power spectral density of component 3 is 0; pass a positive and finite number");
}

/// A random state; rotations are near each other.
void randomize(auto& state, mtk::testing::Random& random) {
  if constexpr (requires { state.pose(); }) {
    randomize(state.position, random);
    randomize(state.orientation, random);
  } else {
    if constexpr (requires { state.value.toRotationMatrix(); }) {
      testing::randomize(state.value, random);
    } else {
      for (auto& x : state.value) x = random.normal();
    }
    for (auto& x : state.velocity) x = random.normal();
    if constexpr (requires { state.acceleration; }) {
      for (auto& x : state.acceleration) x = random.normal();
    }
  }
}
template <class Segment>
typename Segment::Controls randomStates(mtk::testing::Random& random) {
  typename Segment::Controls states;
  for (auto& state : states) randomize(state, random);
  return states;
}
const Knots kKnots(std::vector<double>{1.2, 1.9});

TEST(ProcessSegment, HasTheMeanOfTheProcess) {
  mtk::testing::Random random(1);
  forEachNoise([&]<WhiteNoise W>() {
    constexpr int K = static_cast<int>(W);
    using Segment = trajectory::VectorProcessSegment<1, W>;
    using State = Eigen::Matrix<double, K, 1>;
    const auto states = randomStates<Segment>(random);
    const Segment segment(Blending<2>(kKnots, 0), states);
    const auto vector = [](const auto& state) {
      State x;
      x.template head<2>() << state.value[0], state.velocity[0];
      if constexpr (K == 3) x[2] = state.acceleration[0];
      return x;
    };
    const double T = kKnots[1] - kKnots[0];
    for (const double since : {0.05, 0.3, 0.65}) {
      const Eigen::Matrix<double, K, K> Q = trajectory::processNoise<W>(T, mtk::vect<1>(3.0)),
                                        before = trajectory::processNoise<W>(since, mtk::vect<1>(3.0));
      const Eigen::Matrix<double, K, K> Psi = before * transition<K>(T - since).transpose() * Q.inverse(),
                                        Lambda = transition<K>(since) - Psi * transition<K>(T);
      const State mean = Lambda * vector(states[0]) + Psi * vector(states[1]);
      const double t = kKnots[0] + since;
      EXPECT_NEAR(segment.at(t)[0], mean[0], 1e-11);
      EXPECT_NEAR(segment.velocityAt(t)[0], mean[1], 1e-11);
      if constexpr (K == 3) {
        EXPECT_NEAR(segment.accelerationAt(t)[0], mean[2], 1e-10);
      }
    }
  });
}

template <class A, class B>
void expectClose(const A& a, const B& b, double tolerance, const char* what) {
  EXPECT_LE(double((a - b).norm()), tolerance * (1 + double(b.norm()))) << what;
}

TEST(ProcessSegment, ReproducesBothStates) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    mtk::testing::Random random(seed);
    forEachNoise([&]<WhiteNoise W>() {
      using Segment = trajectory::PoseProcessSegment<W>;
      const auto states = randomStates<Segment>(random);
      const Segment segment(Blending<2>(kKnots, 0), states);
      for (int i = 0; i < 2; ++i) {
        const auto& state = states[std::size_t(i)];
        const double t = kKnots[i];
        EXPECT_LT(mtk::difference(segment.poseAt(t), state.pose()).norm(), 1e-12);
        expectClose(segment.velocityAt(t), state.position.velocity, 1e-11, "velocity");
        expectClose(segment.angularVelocityAt(t), state.orientation.velocity, 1e-11, "angular velocity");
        expectClose(segment.bodyVelocityAt(t), state.orientation.value.inverse() * state.position.velocity,
                    1e-11, "body velocity");
        if constexpr (W == WhiteNoise::on_jerk) {
          expectClose(segment.accelerationAt(t), state.position.acceleration, 1e-9, "acceleration");
          expectClose(segment.angularAccelerationAt(t), state.orientation.acceleration, 1e-9,
                      "angular acceleration");
          expectClose(segment.angularMotionAt(t).acceleration, state.orientation.acceleration, 1e-9,
                      "angular motion");
        }
      }
    });
  }
}

/// The numbers of a state as long doubles.
template <class State>
auto preciseState(const State& state) {
  return mtk::lifted<Long>(state);
}

/// All that a segment returns, the orientation as the rotation from `reference`.
template <bool has_acceleration, class Segment, class Time, class Reference>
auto processOutputs(const Segment& segment, const Time& t, const Reference& reference) {
  const auto turn = reference.inverse() * segment.orientationAt(t);
  const auto angles = std::remove_cvref_t<decltype(turn)>::log(turn);
  mtk::vect<has_acceleration ? 21 : 12, std::remove_cvref_t<decltype(angles[0])>> all;
  int at = 0;
  const auto append = [&](const auto& v) {
    for (int i = 0; i < 3; ++i) all[at++] = v[i];
  };
  append(segment.positionAt(t));
  append(angles);
  append(segment.velocityAt(t));
  append(segment.angularVelocityAt(t));
  if constexpr (has_acceleration) {
    append(segment.bodyAccelerationAt(t));
    append(segment.angularAccelerationAt(t));
    append(segment.worldAngularAccelerationAt(t));
  }
  return all;
}

/// Compares derivatives by both states and by time with differences in long double, of the functions of the segment
/// and of the prior.
template <WhiteNoise W>
void expectExactProcessDerivatives(const typename trajectory::PoseProcessSegment<W>::Controls& states,
                                   double t, double tolerance) {
  using Segment = trajectory::PoseProcessSegment<W>;
  using State = typename Segment::Control;
  constexpr int dof = mtk::DOF_v<State>, columns = 2 * dof + 1;
  constexpr bool has_acceleration = W == WhiteNoise::on_jerk;
  using D = mtk::Dual<double, columns>;
  const Blending<2> span(kKnots, 0);
  const typename Segment::Prior prior(span.spacing(), trajectory::poseDensity(1, 1));
  const SO3<> reference = Segment(span, states).orientationAt(t);

  using Over = typename Segment::template Over<D>;
  typename Over::Controls duals;
  for (int j = 0; j < 2; ++j) {
    duals[std::size_t(j)] =
        mtk::detail::seededAs<mtk::rebind_t<State, D>>(states[std::size_t(j)], dof * j, columns);
  }
  D time;
  time.seed(t, columns - 1);
  const auto found = processOutputs<has_acceleration>(Over(span, duals), time, reference);
  const auto found_prior = prior(duals[0], duals[1]);

  const auto moved = [&](int c, Long d) {
    std::array<mtk::rebind_t<State, Long>, 2> own{preciseState(states[0]), preciseState(states[1])};
    if (c < 2 * dof)
      mtk::boxplus(own[std::size_t(c / dof)], mtk::vect<dof, Long>(d * mtk::vect<dof, Long>::Unit(c % dof)));
    return own;
  };
  const auto precise_reference = mtk::SO3<Long>(reference.w(), reference.x(), reference.y(), reference.z());
  const auto compare = [&](const auto& values, const auto& slope, int c, const char* what) {
    for (Eigen::Index k = 0; k < values.size(); ++k) {
      EXPECT_NEAR(values[k].partial(c), double(slope[k]), tolerance * (1 + double(slope.norm())))
          << what << " " << k << ", column " << c;
    }
  };
  for (int c = 0; c < columns; ++c) {
    compare(found,
            derivativeOf(
                [&](Long d) {
                  return processOutputs<has_acceleration>(
                      typename Segment::template Over<Long>(span, moved(c, d)),
                      c == 2 * dof ? t + d : Long(t), precise_reference);
                },
                0),
            c, "output");
    const auto of_prior = derivativeOf(
        [&](Long d) {
          const auto own = moved(c, d);
          return prior(own[0], own[1]);
        },
        0);
    compare(found_prior, of_prior, c, "prior");
  }
}

TEST(ProcessSegment, HasExactDerivatives) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    mtk::testing::Random random(seed);
    forEachNoise([&]<WhiteNoise W>() {
      const auto states = randomStates<trajectory::PoseProcessSegment<W>>(random);
      expectExactProcessDerivatives<W>(states, random.uniform(1.1, 2.2), 1e-8);  // also outside the segment
    });
  }
}

TEST(ProcessSegment, HasExactDerivativesAtTinyAndLargeRotations) {
  for (const double angle : {0.0, 1e-160, 1e-9, 1e-4, 0.4999, 0.5001, 2.0, 3.0, M_PI - 1e-3}) {
    SCOPED_TRACE("angle " + std::to_string(angle));
    mtk::testing::Random random(7);
    forEachNoise([&]<WhiteNoise W>() {
      auto states = randomStates<trajectory::PoseProcessSegment<W>>(random);
      states[1].orientation.value =
          states[0].orientation.value * SO3<>::exp(angle * Vec3(2.0 / 3, -1.0 / 3, 2.0 / 3));
      expectExactProcessDerivatives<W>(states, 1.5, angle > 2.5 ? 1e-6 : 1e-8);
    });
  }
}

TEST(ProcessSegment, HasTheRatesOfItsCurve) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    mtk::testing::Random random(seed);
    using Segment = trajectory::PoseProcessSegment<WhiteNoise::on_jerk>;
    const auto states = randomStates<Segment>(random);
    const Segment::Over<Long> segment(Blending<2>(kKnots, 0),
                                      {preciseState(states[0]), preciseState(states[1])});
    const Long t = random.uniform(kKnots[0], kKnots[1]);
    const auto p = [&](Long x) { return segment.positionAt(x); };
    const auto v = [&](Long x) { return segment.velocityAt(x); };
    const auto R = [&](Long x) { return segment.orientationAt(x); };
    const auto w = [&](Long x) { return segment.angularVelocityAt(x); };
    expectClose(v(t), derivativeOf(p, t), 2e-8, "velocity");
    expectClose(segment.accelerationAt(t), derivativeOf(v, t), 2e-8, "acceleration");
    expectClose(w(t), derivativeOf(R, t), 2e-8, "angular velocity");
    expectClose(segment.angularAccelerationAt(t), derivativeOf(w, t), 2e-8, "angular acceleration");
  }
}

TEST(MotionPrior, IsZeroForMotionWithoutNoise) {
  mtk::testing::Random random(3);
  forEachNoise([&]<WhiteNoise W>() {
    auto state = randomStates<trajectory::PoseProcessSegment<W>>(random)[0];
    const trajectory::MotionPrior<W, mtk::trafo<SO3<>>> prior(0.4, trajectory::poseDensity(1, 1));
    const auto later = trajectory::detail::predicted(state, 0.4);
    EXPECT_LT(prior(state, later).norm(), 1e-12);
    if constexpr (W == WhiteNoise::on_acceleration) {  // a constant angular velocity
      EXPECT_LT(mtk::difference(later.orientation.value,
                                state.orientation.value * SO3<>::exp(0.4 * state.orientation.velocity))
                    .norm(),
                1e-13);
      EXPECT_LT((later.orientation.velocity - state.orientation.velocity).norm(), 1e-13);
    }
  });
}

TEST(MotionPrior, OfSmallRotationsIsThatOfVectors) {
  mtk::testing::Random random(4);
  forEachNoise([&]<WhiteNoise W>() {
    constexpr double small = 1e-6;
    using Vectors = trajectory::VectorProcessSegment<3, W>;
    using Rotations = trajectory::RotationProcessSegment<W>;
    const auto vectors = randomStates<Vectors>(random);
    typename Rotations::Controls rotations;
    for (std::size_t j = 0; j < 2; ++j) {
      rotations[j].value = SO3<>::exp(small * vectors[j].value);
      rotations[j].velocity = small * vectors[j].velocity;
      if constexpr (W == WhiteNoise::on_jerk) rotations[j].acceleration = small * vectors[j].acceleration;
    }
    const typename Vectors::Prior of_vectors(0.7, Vec3(1, 1, 1));
    const typename Rotations::Prior of_rotations(0.7, Vec3(1, 1, 1));
    expectClose(of_rotations(rotations[0], rotations[1]) / small, of_vectors(vectors[0], vectors[1]), 1e-5,
                "prior");
    const Vectors x(Blending<2>(kKnots, 0), vectors);
    const Rotations R(Blending<2>(kKnots, 0), rotations);
    expectClose(SO3<>::log(R.orientationAt(1.4)) / small, x.at(1.4), 1e-5, "value");
    expectClose(R.angularVelocityAt(1.4) / small, x.velocityAt(1.4), 1e-5, "velocity");
  });
}

}  // namespace
}  // namespace slom
