// What does a measurement cost from a tape? Residual and whole Jacobian, one thread: plain exact derivatives, packs and
// the tape, in nanoseconds a measurement: the median of the rounds and the fastest one.
//     bench_tape
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <random>
#include <vector>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>
#include <slom/tape.hpp>

#include "linearize/measurements.hpp"

namespace {

using SE3 = mtk::trafo<mtk::SO3<>>;
using Vec2 = mtk::vect<2>;
using Vec3 = mtk::vect<3>;
using Vec4 = mtk::vect<4>;

/// A corner of a board in both images.
struct Stereo {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& intrinsics, const auto& left2right, const auto& board2left) const {
    return slom::bench::StereoReprojection()(intrinsics, left2right, board2left, Vec3(0.06, 0.03, 0),
                                             Vec4(0, 0, 0, 0));
  }
};

constexpr int kCount = 512, kRounds = 400;

template <class F>
struct OneByOne : F {
  static constexpr bool is_vectorized = false;
  auto operator()(const auto&... x) const { return F()(x...); }
};

template <class Work>
std::vector<double> times(const Work& work) {
  std::vector<double> all;
  for (int round = 0; round < kRounds; ++round) {
    const auto start = std::chrono::steady_clock::now();
    work();
    all.push_back(std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count() /
                  kCount);
  }
  std::sort(all.begin(), all.end());
  return all;
}

template <class F, class Z, class... X, class Make>
void compare(const char* name, const Make& make) {
  using Plain = slom::CallableMeasurement<OneByOne<F>, slom::VarID<X>..., slom::Measured<Z>>;
  using Packed = slom::CallableMeasurement<F, slom::VarID<X>..., slom::Measured<Z>>;
  constexpr int rows = Plain::residual_dim, columns = (mtk::DOF_v<X> + ...);
  slom::Estimator owner;
  std::vector<Plain> plain;
  std::vector<Packed> packed;
  std::vector<const double*> variables;
  std::vector<double> data;
  std::shared_ptr<const slom::TracedKind> kind;
  for (int i = 0; i < kCount; ++i) {
    std::apply(
        [&](const Z& z, const X&... x) {
          const std::tuple<slom::VarID<X>...> ids(owner.insertRV(x)...);
          std::apply(
              [&](const slom::VarID<X>&... id) {
                plain.emplace_back(OneByOne<F>(), id..., slom::measured(z));
                packed.emplace_back(F(), id..., slom::measured(z));
                kind = slom::detail::trace(F(), data, id..., slom::measured(z));
                (variables.push_back(reinterpret_cast<const double*>(&*id)), ...);
              },
              ids);
        },
        make());
  }
  std::vector<double> r(std::size_t{kCount} * rows), J(std::size_t{kCount} * rows * columns), other_J = J;
  const auto exact = times([&] {
    for (int i = 0; i < kCount; ++i)
      plain[static_cast<std::size_t>(i)].linearize(rows, r.data() + i * rows, J.data() + i * rows * columns);
  });
  const auto packs = times([&] { Packed::evaluateMany(packed.data(), kCount, r.data(), J.data()); });
  const auto tape = times([&] {
    kind->tape.evaluate(kCount, {variables.data(), data.data()}, r.data(), other_J.data());
  });
  double error = 0;
  for (std::size_t i = 0; i < J.size(); ++i) error = std::max(error, std::abs(J[i] - other_J[i]));
  const auto start = std::chrono::steady_clock::now();
  {
    slom::tape::Recording recording;
    std::apply(
        [&](const Z& z, const X&... x) {
          const auto residual = slom::detail::recordedResidual(
              F(), recording,
              slom::detail::indicesWhere<!slom::detail::is_measured<slom::VarID<X>>..., false>(),
              std::index_sequence<sizeof...(X)>(), owner.insertRV(x)..., slom::measured(z));
          recording.finish(residual);
        },
        make());
  }
  const double ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  const auto at = [](const std::vector<double>& all) { return all[all.size() / 2]; };
  std::printf(
      "%-14s plain %6.1f (%6.1f)   packs %6.1f (%6.1f)   tape %6.1f (%6.1f)   %4zu instructions, %3d registers, "
      "%d lanes; traced in %.2f ms; largest difference %.1e\n",
      name, at(exact), exact[0], at(packs), packs[0], at(tape), tape[0],
      kind->tape.code().linearization.size(), kind->tape.code().registers, kind->tape.lanes(), ms, error);
}

}  // namespace

int main() {
  std::mt19937 engine(1);
  std::normal_distribution<double> normal;
  const auto vec3 = [&] { return Vec3(normal(engine), normal(engine), normal(engine)); };
  const auto pose = [&] { return SE3(mtk::SO3<>::exp(vec3()), vec3()); };
  compare<slom::Reprojection, Vec2, slom::SnavelyCamera, Vec3>("bundle 2x12", [&] {
    slom::SnavelyCamera camera;
    camera.pose = pose();
    camera.intrinsics = slom::SnavelyIntrinsics<>(600, -0.1, 0.01);
    return std::tuple(Vec2(1, 2), camera,
                      Vec3(camera.pose.inverse() * Vec3(normal(engine), normal(engine), -5)));
  });
  compare<slom::RelativePose, SE3, SE3, SE3>("pose 6x12", [&] {
    const SE3 a = pose(), b = pose();
    return std::tuple((a.inverse() * b) * SE3(mtk::SO3<>::exp(Vec3(0.1 * vec3())), Vec3(0.1 * vec3())), a, b);
  });
  compare<Stereo, Vec4, slom::bench::StereoIntrinsics, SE3, SE3>("stereo 4x30", [&] {
    slom::bench::StereoIntrinsics intrinsics;
    intrinsics.left << 600, 600, 320, 240, -0.1, 0.01, 1e-3, 1e-3, 0;
    intrinsics.right = intrinsics.left;
    const auto near = [&](double depth) {
      return SE3(mtk::SO3<>::exp(Vec3(0.1 * vec3())), Vec3(0.1 * vec3() + Vec3(0, 0, depth)));
    };
    return std::tuple(Vec4(300, 200, 310, 210), intrinsics, near(0), near(2));
  });
  compare<slom::Range, double, Vec2, Vec2>("range 1x4", [&] {
    return std::tuple(1.0, Vec2(normal(engine), normal(engine)), Vec2(normal(engine), normal(engine)));
  });
}
