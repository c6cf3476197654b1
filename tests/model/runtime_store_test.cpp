// Variables of a RuntimeType behave as those of a C++ type with the same members.
#include <cstring>
#include <memory>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <mtk/build_manifold.hpp>
#include <mtk/testing/random.hpp>
#include <slom/measurements/gaussian_prior.hpp>
#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace slom::testing {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Kind = RuntimeType::Kind;
using Numbers = std::vector<double>;
using SO2 = mtk::SO2<>;
using SO3 = mtk::SO3<>;
using S2 = mtk::S2<>;
using SE2 = mtk::trafo<SO2>;
using SE3 = mtk::trafo<SO3>;
using Vec2 = mtk::vect<2>;
using Vec3 = mtk::vect<3>;
using Vec5 = mtk::vect<5>;

MTK_BUILD_MANIFOLD(Parts, ((double, number))((Vec2, plane))((SE3, pose))((Vec3, space))((S2, axis))((SO2, heading))(
                              (Vec5, five))((SO3, attitude))((SE2, odometry)))

std::shared_ptr<const RuntimeType> partsType() {
  return RuntimeType::make("Parts", {{"number", Kind::number},
                                     {"plane", Kind::vector, 2},
                                     {"pose", Kind::se3},
                                     {"space", Kind::vector, 3},
                                     {"axis", Kind::s2},
                                     {"heading", Kind::so2},
                                     {"five", Kind::vector, 5},
                                     {"attitude", Kind::so3},
                                     {"odometry", Kind::se2}});
}

/// Returns the numbers that store x.
Numbers numbersOf(const Parts& x) {
  Numbers numbers;
  mtk::detail::forEachBasicPart(x, x, 0, [&](const auto& part, const auto&, int) {
    const auto& state = mtk::detail::stateOf(part);
    if constexpr (requires { state.size(); }) {
      numbers.insert(numbers.end(), state.data(), state.data() + state.size());
    } else {
      numbers.push_back(state);
    }
  });
  return numbers;
}

class RandomParts {
 public:
  explicit RandomParts(unsigned seed) : random_(seed) {}

  /// Returns a length that is often hard: 0, tiny, near pi, at pi.
  double length() {
    constexpr double pi = std::numbers::pi;
    constexpr double hard[] = {0, 1e-300, 1e-12, 1e-5, pi - 1e-9, pi, pi + 1e-9, 2 * pi};
    const auto choice = static_cast<std::size_t>(random_.uniform(0, 14));
    return choice < std::size(hard) ? hard[choice] : random_.uniform(0, 4);
  }
  Vec3 turn() {
    if (random_.uniform() < 0.3) return Vec3(0, 0, length());
    const Vec3 direction(random_.normal(), random_.normal(), random_.normal());
    return Vec3(direction / direction.norm() * length());
  }
  S2 direction() {
    const int k = static_cast<int>(random_.uniform(0, 12));
    if (k < 6) return S2(k % 3 == 0 ? k - 1.5 : 0, k % 3 == 1 ? k - 2.5 : 0, k % 3 == 2 ? k - 3.5 : 0);
    return S2(random_.normal(), random_.normal(), random_.normal());
  }
  Parts value() {
    Parts x;
    x.number = random_.normal();
    for (double& own : x.plane) own = random_.uniform() < 0.2 ? 0 : random_.normal();
    x.pose = SE3(SO3::exp(turn()), Vec3(random_.normal(), random_.normal(), random_.normal()));
    x.space = turn();
    x.axis = direction();
    x.heading = SO2(length());
    for (double& own : x.five) own = random_.normal();
    x.attitude = SO3::exp(turn());
    x.odometry = SE2(SO2(-length()), Vec2(random_.normal(), 0));
    return x;
  }
  /// Returns a value that is often close or opposite to x.
  Parts near(const Parts& x) {
    if (random_.uniform() < 0.3) return value();
    Parts y = x;
    y.boxplus(step());
    if (random_.uniform() < 0.3) y.axis = S2(-x.axis.x(), -x.axis.y(), -x.axis.z());
    return y;
  }
  mtk::tangent_t<Parts> step() {
    mtk::tangent_t<Parts> d;
    const double size = length();
    for (double& own : d) own = random_.uniform() < 0.2 ? 0 : size * random_.normal();
    return d;
  }

 private:
  mtk::testing::Random random_;
};

bool areSame(const Numbers& a, const Numbers& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

struct Orientations final : OrientationSink {
  struct Seen {
    Kind kind;
    int component;
    std::array<double, 3> numbers{};
    bool operator==(const Seen&) const = default;
  };
  std::vector<Seen> seen;
  void take(Kind kind, int component, const double* numbers) override {
    seen.push_back({kind, component});
    std::copy_n(numbers, kind == Kind::angle ? 1 : 3, seen.back().numbers.begin());
  }
};

/// Both stores and what they compute.
struct Stores {
  Estimator est;
  VarID<Parts> of_cpp = est.insertRV(Parts());
  AnyVarID of_runtime = est.insertRV(RuntimeValue{partsType(), numbersOf(Parts())});
  const VariableStoreBase& cpp = *AnyVarID(of_cpp).store();
  const VariableStoreBase& runtime = *of_runtime.store();
  static constexpr std::size_t n = mtk::DOF_v<Parts>;

  /// Compares what `compute(store, value, other value, numbers)` writes.
  template <class F>
  void expectSame(const char* operation, std::size_t count, const Parts& x, const Parts& y,
                  const F& compute) const {
    Numbers from_cpp(count, -7), from_runtime(count, -7);
    const Numbers own_x = numbersOf(x), own_y = numbersOf(y);
    compute(cpp, &x, &y, from_cpp.data());
    compute(runtime, own_x.data(), own_y.data(), from_runtime.data());
    EXPECT_TRUE(areSame(from_cpp, from_runtime)) << operation;
  }
};

TEST(RuntimeStore, DoesWhatAStoreOfACppTypeDoes) {
  const unsigned seed = std::random_device()();
  SCOPED_TRACE("seed " + std::to_string(seed));
  RandomParts random(seed);
  const Stores stores;
  using Store = const VariableStoreBase&;
  const std::size_t n = Stores::n;
  ASSERT_EQ(partsType()->dof(), static_cast<int>(n));
  ASSERT_EQ(partsType()->coordinates(), static_cast<int>(numbersOf(Parts()).size()));
  EXPECT_EQ(stores.est.componentNames(stores.of_runtime)[4], "Parts #2.pose.pos.y");
  EXPECT_EQ(stores.runtime.componentNames(0, "a"), stores.cpp.componentNames(0, "a"));
  EXPECT_EQ(stores.runtime.componentNames(0, ""), stores.cpp.componentNames(0, ""));
  EXPECT_EQ(stores.runtime.typeName(), stores.cpp.typeName());
  EXPECT_FALSE(stores.runtime.hasTypeOf(stores.cpp));
  EXPECT_FALSE(stores.cpp.hasTypeOf(stores.runtime));

  for (int repetition = 0; repetition < 300 && !HasFailure(); ++repetition) {
    const Parts x = random.value(), y = random.near(x);
    const mtk::tangent_t<Parts> d = random.step();
    Parts moved = x;
    Numbers numbers = numbersOf(x);
    stores.cpp.boxplus(&moved, d.data());
    stores.runtime.boxplus(numbers.data(), d.data());
    EXPECT_TRUE(areSame(numbers, numbersOf(moved))) << "boxplus";

    const auto same = [&](const char* operation, std::size_t count, const auto& compute) {
      stores.expectSame(operation, count, x, y, compute);
    };
    same("boxminus", n,
         [](Store store, const void* a, const void* b, double* out) { store.boxminus(out, a, b); });
    same("boxminusDerivative", n * n,
         [](Store store, const void* a, const void* b, double* D) { store.boxminusDerivative(a, b, D); });
    same("typicalSizes", n,
         [](Store store, const void* a, const void*, double* out) { store.typicalSizesOf(a, out); });
    same("leftPerturbation", n * n,
         [](Store store, const void* a, const void*, double* A) { store.leftPerturbation(a, A); });
    same("coordinates", n,
         [](Store store, const void* a, const void*, double* out) { store.coordinates(a, out); });
    for (const WorldRole role : {WorldRole::in_world, WorldRole::sees_world}) {
      same("gaugeGenerators", n * kGaugeGenerators,
           [role](Store store, const void* a, const void*, double* out) {
             store.gaugeGenerators(a, role, out);
           });
    }
    Orientations of_cpp, of_runtime;
    stores.cpp.visitOrientations(&x, of_cpp);
    stores.runtime.visitOrientations(numbersOf(x).data(), of_runtime);
    EXPECT_EQ(of_cpp.seen.size(), 5u);
    EXPECT_EQ(of_cpp.seen, of_runtime.seen);

    const Numbers inserted = partsType()->normalized(numbersOf(x)), original = numbersOf(x);
    for (std::size_t i = 0; i < original.size(); ++i) EXPECT_NEAR(inserted[i], original[i], 4e-16);
  }
}

TEST(RuntimeStore, SavesMovesAndCopiesValues) {
  RandomParts random(1);
  const Stores stores;
  const std::unique_ptr<VariableStoreBase> store = stores.runtime.makeEmpty();
  EXPECT_TRUE(store->hasTypeOf(stores.runtime));
  std::vector<Parts> all;
  std::vector<int> offset{0};
  std::vector<double> step;
  for (int i = 0; i < 100; ++i) {
    all.push_back(random.value());
    EXPECT_EQ(store->insert(numbersOf(all.back()).data(), i).slot, static_cast<std::uint32_t>(i));
    const auto d = random.step();
    step.insert(step.end(), d.begin(), d.end());
    offset.push_back(static_cast<int>(step.size()));
  }
  const auto holds = [](const VariableStoreBase& own, std::uint32_t slot, const Parts& x) {
    const Numbers numbers = numbersOf(x);
    return std::memcmp(own.valueAt(slot), numbers.data(), numbers.size() * sizeof(double)) == 0;
  };
  store->save();
  store->applyStep(offset, step.data());
  for (std::uint32_t i = 0; i < 100; ++i) {
    Parts moved = all[i];
    moved.boxplus(mtk::vectview<const double, Parts::DOF>(step.data() + i * Stores::n));
    EXPECT_TRUE(holds(*store, i, moved)) << i;
  }
  store->restore();
  EXPECT_EQ(store->valueText(7).substr(0, 4), std::to_string(all[7].number).substr(0, 4));
  store->release(50);
  const std::unique_ptr<VariableStoreBase> copy = store->makeEmpty();
  copy->copyFrom(*store);
  EXPECT_EQ(copy->variable(50), -1);
  for (std::uint32_t i = 0; i < 100; ++i) EXPECT_TRUE(i == 50 || holds(*copy, i, all[i])) << i;
}

/// A chain of priors over pairs of variables, in groups of 3, by C++ types or described ones.
struct Chain {
  Estimator est;
  std::vector<AnyVarID> ids;
  std::vector<MeasID<GaussianPrior>> priors;

  explicit Chain(bool is_runtime) {
    RandomParts random(3);
    mtk::testing::Random entries(4);
    for (int i = 0; i < 6; ++i) {
      const Parts x = random.value();
      const std::string name = "x" + std::to_string(i);
      ids.push_back(is_runtime ? est.insertRV(RuntimeValue{partsType(), numbersOf(x)}, name)
                               : AnyVarID(est.insertRV(x, name)));
    }
    const Eigen::Index n = Stores::n;
    const auto matrix = [&](Eigen::Index rows, Eigen::Index columns) {
      return MatrixXd::NullaryExpr(rows, columns, [&] { return entries.normal(); });
    };
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const MatrixXd R = matrix(n, 2 * n);
        priors.push_back(est.insertMeasurement(
            GaussianPrior({ids[i], ids[(i + 1 + k) % 6]}, R, VectorXd(0.02 * matrix(n, 1))),
            group(static_cast<int>(i))));
      }
    }
  }
  Numbers values() const {
    Numbers all;
    for (const AnyVarID& id : ids) {
      if (!id.isValid()) continue;
      const Numbers own =
          id.is<Parts>() ? numbersOf(id.as<Parts>())
                         : Numbers(static_cast<const double*>(id.current()),
                                   static_cast<const double*>(id.current()) + partsType()->coordinates());
      all.insert(all.end(), own.begin(), own.end());
    }
    return all;
  }
};

void expectClose(const MatrixXd& a, const MatrixXd& b, double tolerance) {
  ASSERT_EQ(a.rows(), b.rows());
  ASSERT_EQ(a.cols(), b.cols());
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), tolerance);
}
void expectClose(const Numbers& a, const Numbers& b, double tolerance) {
  expectClose(VectorXd::Map(a.data(), static_cast<Eigen::Index>(a.size())),
              VectorXd::Map(b.data(), static_cast<Eigen::Index>(b.size())), tolerance);
}

TEST(RuntimeStore, FitsAndUncertaintiesAreTheSame) {
  Chain of_cpp(false), of_runtime(true);
  Estimator &a = of_cpp.est, &b = of_runtime.est;
  const Estimator copy_before = b.clone();
  EXPECT_EQ(a.getN(), b.getN());
  for (Chain* chain : {&of_cpp, &of_runtime}) {
    chain->est.fix(chain->ids[0], "pose.pos.x");
    chain->est.bound(chain->ids[1], "five", -10, 10);
  }
  const Summary one = a.optimize(), other = b.optimize();
  EXPECT_TRUE(one.converged) << one;
  EXPECT_NEAR(one.final_rss, other.final_rss, 1e-9 * one.final_rss);
  expectClose(of_cpp.values(), of_runtime.values(), 1e-9);
  EXPECT_NE(of_runtime.values(), Chain(true).values());

  const AnyVarID &x = of_cpp.ids[1], &y = of_runtime.ids[1], &x2 = of_cpp.ids[2], &y2 = of_runtime.ids[2];
  expectClose(a.covariance(x), b.covariance(y), 1e-8);
  expectClose(a.covariance(x, x2), b.covariance(y, y2), 1e-8);
  expectClose(a.standardDeviation(x), b.standardDeviation(y), 1e-8);
  expectClose(a.marginals().covariance(x), b.marginals().covariance(y), 1e-8);
  expectClose(a.marginals().standardDeviation(x), b.marginals().standardDeviation(y), 1e-8);
  EXPECT_NEAR(a.getRSS(x), b.getRSS(y), 1e-9 * a.getRSS());
  EXPECT_EQ(a.componentNames(x), b.componentNames(y));
  EXPECT_EQ(a.nameOf(x), b.nameOf(y));

  const Clustered c = clustered(a), d = clustered(b);
  expectClose(c.covariance(x), d.covariance(y), 1e-7);
  expectClose(c.covariance(x, x2), d.covariance(y, y2), 1e-7);
  expectClose(c.jointCovariance(x, x2), d.jointCovariance(y, y2), 1e-7);
  expectClose(c.standardDeviation(x), d.standardDeviation(y), 1e-7);
  expectClose(c.correlation(x, x2), d.correlation(y, y2), 1e-5);
  expectClose(c.change(x), d.change(y), 1e-6);
  expectClose(c.influence(x), d.influence(y), 1e-4);
  expectClose(c.statedShare(x), d.statedShare(y), 1e-6);
  EXPECT_EQ(c.blockLength(x), d.blockLength(y));
  EXPECT_EQ(c.notes(x), d.notes(y));
  EXPECT_EQ(c.interval(x).size(), d.interval(y).size());
  EXPECT_EQ(c.degreesOfFreedom(x).size(), d.degreesOfFreedom(y).size());

  // A copy has values of its own.
  const auto firstOf = [](const AnyVarID& id) { return *static_cast<const double*>(id.current()); };
  EXPECT_EQ(firstOf(copy_before.own(y)), firstOf(Chain(true).ids[1]));
  EXPECT_NE(firstOf(copy_before.own(y)), firstOf(y));
  Estimator copy = b.clone();
  copy.reinitRV(copy.own(y), RuntimeValue{partsType(), numbersOf(Parts())});
  copy.optimize();
  EXPECT_NEAR(copy.getRSS(), b.getRSS(), 1e-6 * b.getRSS());

  for (Chain* chain : {&of_cpp, &of_runtime}) {
    EXPECT_FALSE(chain->est.marginalize({chain->ids[5], chain->ids[3]}).empty());
    for (const AnyVarID& id : {chain->ids[3], chain->ids[5]}) EXPECT_FALSE(id.isValid());
    chain->est.optimize();
  }
  EXPECT_NEAR(a.getRSS(), b.getRSS(), 1e-8 * a.getRSS());
  expectClose(of_cpp.values(), of_runtime.values(), 1e-8);
  expectClose(a.covariance(x), b.covariance(y), 1e-7);
}

TEST(RuntimeValues, TypesOfOneNameAreDifferent) {
  const auto plane = RuntimeType::make("Point", {{"", Kind::vector, 2}});
  const auto space = RuntimeType::make("Point", {{"", Kind::vector, 3}});
  EXPECT_EQ(RuntimeType::make("Point", {{"", Kind::vector, 2}}), plane);
  EXPECT_EQ(RuntimeType::make("S", {{"", Kind::so3, 0}}), RuntimeType::make("S", {{"", Kind::so3}}));
  Estimator est;
  const AnyVarID a = est.insertRV(RuntimeValue{plane, {1, 2}}, "a");
  const AnyVarID b = est.insertRV(RuntimeValue{space, {1, 2, 3}}, false, "b");
  const AnyVarID c = est.insertRV(RuntimeValue{plane, {3, 4}});
  EXPECT_EQ(est.nameOf(a), "a");
  EXPECT_EQ(est.nameOf(b), "b");
  EXPECT_EQ(est.nameOf(c), "Point #3");
  EXPECT_EQ(est.getN(), 4);
  EXPECT_EQ(a.store(), c.store());
  EXPECT_NE(a.store(), b.store());
  EXPECT_EQ(RuntimeType::of(a), plane);
  EXPECT_EQ(RuntimeType::of(b), space);
  EXPECT_EQ(RuntimeType::of(est.insertRV(1.0)), nullptr);
  EXPECT_EQ(est.componentNames(b).back(), "b.z");
  EXPECT_EQ(
      messageOf([&] {
        est.reinitRV(a, RuntimeValue{space, {1, 2, 3}});
      }),
      "[slom.wrong-type] variable a is a Point, the new value is one with other fields; pass a value of the variable's type");
  EXPECT_TRUE((GaussianPrior({a}, MatrixXd::Identity(2, 2)).over({c}), true));
  EXPECT_EQ(
      messageOf([&] { GaussianPrior({a}, MatrixXd::Identity(2, 2)).over({est.insertRV(Vec2(0, 0))}); }),
      "[slom.wrong-type] variable 0 of the GaussianPrior over 1 variable with 2 degrees of freedom is a Point, it "
      "was given a vect<2>; pass variables of the same types, in their order");
}

TEST(RuntimeValues, AreMadeOfTheirManifold) {
  const auto type =
      RuntimeType::make("Body", {{"angle", Kind::so2}, {"attitude", Kind::so3}, {"axis", Kind::s2}});
  Estimator est;
  const AnyVarID id = est.insertRV(RuntimeValue{type, {7, 0, 0, 0, 2, 0, 3, 4}});
  const auto* const numbers = static_cast<const double*>(id.current());
  EXPECT_NEAR(numbers[0], 7 - 2 * std::numbers::pi, 1e-15);
  EXPECT_EQ(Numbers(numbers + 1, numbers + 8), (Numbers{0, 0, 0, 1, 0, 0.6, 0.8}));
  est.reinitRV(id, RuntimeValue{type, {1, 1, 0, 0, 0, 2, 0, 0}});
  EXPECT_EQ(Numbers(numbers, numbers + 8), (Numbers{1, 1, 0, 0, 0, 1, 0, 0}));
}

TEST(RuntimeValues, Faults) {
  const auto point = RuntimeType::make("Point", {{"", Kind::vector, 2}});
  const auto pose = RuntimeType::make("Pose", {{"", Kind::se3}});
  const auto axis = RuntimeType::make("Axis", {{"", Kind::s2}});
  Estimator est;
  const AnyVarID a = est.insertRV(RuntimeValue{point, {1, 2}}, "a");
  const auto insert = [&](const std::shared_ptr<const RuntimeType>& type, const Numbers& numbers) {
    return messageOf([&] { est.insertRV(RuntimeValue{type, numbers}); });
  };
  EXPECT_EQ(
      insert(point, {1, 2, 3}),
      "[slom.wrong-length] a value of the type Point has 2 numbers, it was given 3; pass all of them, field after "
      "field");
  EXPECT_EQ(insert(point, {1, INFINITY}),
            "[slom.bad-value] a value of the type Point has the number inf; pass finite numbers");
  EXPECT_TRUE(insert(pose, {1, 2, 3, 0, 0, 0, 0}).starts_with("[mtk.no-rotation]"))
      << insert(pose, {1, 2, 3, 0, 0, 0, 0});
  EXPECT_TRUE(insert(axis, {0, 0, 0}).starts_with("[mtk.no-direction]")) << insert(axis, {0, 0, 0});
  EXPECT_EQ(insert(nullptr, {1}),
            "[slom.bad-type] a RuntimeValue has no type; give it one of RuntimeType::make");
  EXPECT_EQ(est.getN(), 2);

  EXPECT_EQ(
      messageOf([&] {
        est.reinitRV(a, RuntimeValue{point, {1}});
      }),
      "[slom.wrong-length] a value of the type Point has 2 numbers, it was given 1; pass all of them, field after "
      "field");
  EXPECT_EQ(
      messageOf([&] {
        est.reinitRV(a, RuntimeValue{pose, {0, 0, 0, 0, 0, 0, 1}});
      }),
      "[slom.wrong-type] variable a is a Point, the new value is a Pose; pass a value of the variable's type");
  EXPECT_EQ(
      messageOf([&] { est.reinitRV(a, RuntimeValue{}); }),
      "[slom.wrong-type] variable a is a Point, the new value has no type; pass a value of the variable's type");
  EXPECT_EQ(
      messageOf([&] {
        est.reinitRV(AnyVarID(est.insertRV(1.0, "x")), RuntimeValue{point, {1, 2}});
      }),
      "[slom.wrong-type] variable x is a double, the new value is a Point; pass a value of the variable's type");
  est.bound(a, "x", 0, 1);
  EXPECT_EQ(
      messageOf([&] {
        est.reinitRV(a, RuntimeValue{point, {2, 0}});
      }),
      "[slom.outside-bound] a.x is 2, outside of its bound [0, 1]; give it a value inside, or another bound");
  EXPECT_EQ(*static_cast<const double*>(a.current()), 1);

  EXPECT_EQ(messageOf([] { RuntimeType::make("Nothing", {}); }),
            "[slom.bad-type] the type of variables Nothing has no fields; give it at least one");
  EXPECT_EQ(
      messageOf([] {
        RuntimeType::make("Empty", {{"v", Kind::vector, 0}});
      }),
      "[slom.bad-type] the type of variables Empty has the vector v of 0 numbers; give it at least one");
  EXPECT_EQ(messageOf([] {
              RuntimeType::make("Big", {{"v", Kind::vector, 65530}, {"pose", Kind::se3}});
            }),
            "[slom.bad-type] the type of variables Big has 65537 numbers; give it at most 65535");
}

}  // namespace
}  // namespace slom::testing
