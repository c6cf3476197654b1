#include <algorithm>
#include <memory>
#include <utility>

#include <slom/base/threads.hpp>
#include <slom/linearize/linearize.hpp>
#include <slom/model/callable.hpp>
#include <slom/problem/problem.hpp>
#if __has_include(<slom/model/vectorized.hpp>)
#include <slom/model/vectorized.hpp>
#define SLOM_BENCH_VECTORIZED 1
#endif

#include "linearize/variants.hpp"

namespace slom::bench {

namespace {

/// A sink that drops the batches.
class NullSink final : public JacobianSink {
 public:
  void beginLinearization() override {}
  void add(const JacobianBatch& batch) override {
    keepMemory(batch.r);
    keepMemory(batch.J);
  }
  void endLinearization() override {}
};

/// A sink that keeps the batches of the only group.
class KeepingSink final : public JacobianSink {
 public:
  explicit KeepingSink(Derivatives& all) : all_(all) {}
  void beginLinearization() override {}
  void add(const JacobianBatch& batch) override {
    std::copy_n(batch.r, all_.rows * batch.count, all_.residual(batch.first));
    std::copy_n(batch.J, all_.rows * all_.cols * batch.count, all_.jacobian(batch.first));
  }
  void endLinearization() override {}

 private:
  Derivatives& all_;
};

/// The function F for arguments of only these types, so that it accepts no other numbers than double.
template <class F, class... Args>
struct OfTypes {
  auto operator()(const Args&... args) const { return F()(args...); }
};

/// Returns the variant of a problem whose variables and measurements `fill(problem)` inserts.
template <int Rows, int Cols, class Fill>
Variant linearized(std::string name, double tolerance, Fill fill) {
  struct State {
    Problem problem;
    Linearizer linearizer;
    NullSink sink;

    void linearize(JacobianSink& into) {
      withThreads(1, [&] { linearizer.linearize(problem, problem.activeSet(), into); });
    }
  };
  const auto state = std::make_shared<State>();
  fill(state->problem);
  Variant variant;
  variant.name = std::move(name);
  variant.tolerance = tolerance;
  variant.pass = [state] { state->linearize(state->sink); };
  variant.derivatives = [state] {
    Derivatives all(Rows, Cols, kMeasurements);
    KeepingSink sink(all);
    state->linearize(sink);
    return all;
  };
  return variant;
}

/// Inserts a measurement as Estimator::insertMeasurement does, without noise.
template <class F, class... Args>
void insert(Problem& problem, const F& f, const Args&... args) {
  problem.insertMeasurement(CallableMeasurement<F, Args...>(f, args...), viewNoise(UnitCovariance{}));
}

template <class T>
std::vector<VarID<T>> insertAll(Problem& problem, const std::vector<T>& values) {
  std::vector<VarID<T>> ids;
  for (const T& value : values) ids.push_back(problem.insertVariable(value, true, ""));
  return ids;
}

/// Returns the variants of function F on `data`; fill(problem, f, data) inserts f. Args: the types of the arguments of
/// F.
template <int Rows, int Cols, class F, class... Args, class Data, class Fill>
std::vector<Variant> variantsOf(const Data& data, Fill fill) {
  std::vector<Variant> all;
  const auto add = [&](const char* name, double tolerance, const auto& f) {
    all.push_back(linearized<Rows, Cols>(name, tolerance, [&](Problem& problem) { fill(problem, f, data); }));
  };
  constexpr double exact = 1e-9, numeric = 1e-5;
#if __has_include(<mtk/dual.hpp>)
  add("SLoM, exact", exact, F());
#else
  add("SLoM, any number", numeric, F());
#endif
#ifdef SLOM_BENCH_VECTORIZED
  add("SLoM, vectorised", exact, vectorized(F()));
#endif
  static_cast<void>(exact);
  add("SLoM, numeric", numeric, OfTypes<F, Args...>());
  return all;
}

}  // namespace

std::vector<Variant> bySlom(const BalData& data) {
  const auto fill = [](Problem& problem, const auto& f, const BalData& data) {
    const auto cameras = insertAll(problem, data.cameras);
    const auto points = insertAll(problem, data.points);
    for (const auto& z : data.observations) {
      insert(problem, f, cameras[std::size_t(z.camera)], points[std::size_t(z.point)], z.pixel);
    }
  };
  return variantsOf<2, 12, BalReprojection, BalCamera, mtk::vect<3>, mtk::vect<2>>(data, fill);
}

std::vector<Variant> bySlom(const PoseGraphData& data) {
  const auto fill = [](Problem& problem, const auto& f, const PoseGraphData& data) {
    const auto poses = insertAll(problem, data.poses);
    for (const auto& z : data.edges) {
      insert(problem, f, poses[std::size_t(z.a)], poses[std::size_t(z.b)], measured(z.measured));
    }
  };
  return variantsOf<6, 12, RelativePose, SE3, SE3>(data, fill);
}

std::vector<Variant> bySlom(const StereoData& data) {
  const auto fill = [](Problem& problem, const auto& f, const StereoData& data) {
    const auto intrinsics = problem.insertVariable(data.intrinsics, true, "");
    const auto left2right = problem.insertVariable(data.left2right, true, "");
    const auto boards = insertAll(problem, data.board2left);
    for (const auto& z : data.corners) {
      insert(problem, f, intrinsics, left2right, boards[std::size_t(z.view)], z.on_board, z.pixels);
    }
  };
  return variantsOf<4, 30, StereoReprojection, StereoIntrinsics, SE3, SE3, mtk::vect<3>, mtk::vect<4>>(data,
                                                                                                       fill);
}

}  // namespace slom::bench
