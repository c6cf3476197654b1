// Traced measurements are saved with their tapes, and loaded by programs that have neither the function nor the types.
#include <algorithm>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include <mtk/build_manifold.hpp>
#include <slom/archive.hpp>
#include <slom/measurements/gaussian_prior.hpp>
#include <slom/measurements/prior.hpp>
#include <slom/measurements/range.hpp>
#include <slom/measurements/relative_pose.hpp>
#include <slom/slom.hpp>
#include <slom/tape.hpp>

#include "support/message_of.hpp"

namespace slom::testing {
namespace {

using SO2 = mtk::SO2<>;
using SO3 = mtk::SO3<>;
using S2 = mtk::S2<>;
using SE2 = mtk::trafo<SO2>;
using SE3 = mtk::trafo<SO3>;
using Vec2 = mtk::vect<2>;
using Vec3 = mtk::vect<3>;
using Vec5 = mtk::vect<5>;

/// A vector whose components have names of their own.
template <class S = double>
struct Lens : mtk::vect<2, S> {
  static constexpr const char* component_names[] = {"focal", "k1"};
  using Base = mtk::vect<2, S>;
  using Base::Base;
};
/// A type with a text of its own.
template <class S = double>
struct Tagged : mtk::vect<1, S> {
  using Base = mtk::vect<1, S>;
  using Base::Base;
  friend std::ostream& operator<<(std::ostream& os, const Tagged& x) { return os << "value=" << x[0]; }
  friend std::istream& operator>>(std::istream& is, Tagged& x) { return (is >> std::ws).ignore(6) >> x[0]; }
};
template <class S>
struct Rig {
  mtk::trafo<mtk::SO3<S>> pose;
  mtk::S2<S> axis;
  mtk::vect<5, S> five;
  mtk::SO2<S> heading;
  S scale{1};
  mtk::trafo<mtk::SO2<S>> wheel;
  mtk::vect<1, S> one;
};

/// The name of a member of Rig: its number where the compiler does not tell.
std::string member(const char* name, int number) {
  return MTK_HAS_MEMBER_NAMES ? name : std::to_string(number);
}

constexpr auto distance = [](const auto& pose, const auto& point) {
  return (pose.orient * point + pose.pos).norm();
};
constexpr auto of_rig = [](const auto& rig, const auto& point, const auto& datum) {
  using S = std::decay_t<decltype(rig.scale)>;
  mtk::vect<8, S> r;
  const auto seen = rig.pose * (point * rig.scale);
  for (int i = 0; i < 3; ++i) r[i] = seen[i] - datum[i] + rig.axis.vector()[i];
  for (int i = 0; i < 5; ++i) r[3 + i] = rig.five[i] * rig.heading.angle() - 0.1 * i;
  return r;
};
constexpr auto of_wheel = [](const auto& rig) {
  using S = std::decay_t<decltype(rig.scale)>;
  return mtk::vect<4, S>(rig.wheel.pos[0] - 1.0, rig.wheel.pos[1] + 1.0 / 3,
                         rig.wheel.orient.angle() - rig.one[0], rig.one[0] * 2.0 - 0.3);
};
constexpr auto turn = [](const auto& a, const auto& b) { return a.inverse() * b; };
constexpr auto line = [](const auto& x, const auto& t, const auto& rate) { return x + rate * t; };

/// A problem with parts of every kind, noise of every form, losses, groups, labels, fixed components and bounds.
Estimator makeProblem() {
  Estimator est;
  const auto third = [](double x) { return x / 3; };
  std::vector<VarID<SE3>> poses;
  for (int i = 0; i < 3; ++i)
    poses.push_back(est.insertRV(SE3(SO3::exp(Vec3(0.1 * i, third(i), -0.2)), Vec3(i, third(i), 0)), i > 0,
                                 "pose \"" + std::to_string(i) + "\""));
  const auto point = est.insertRV(Vec3(third(4), 2, third(5)), "point");
  const auto rig =
      est.insertRV(Rig<double>{SE3(SO3::exp(Vec3(0.1, 0.2, third(1))), Vec3(third(1), 1, 2)),
                               S2(1, 2, third(3)), Vec5(third(1), 2, 3, 4, 5), SO2(0.3), third(4),
                               SE2(SO2(0.2), Vec2(third(2), 0)), mtk::vect<1>(third(1))},
                   "rig");
  const auto a = est.insertRV(SO3::exp(Vec3(third(1), 0, 0)), false, "a"), b = est.insertRV(SO3(), "b");
  const auto x = est.insertRV(third(2), "x"), rate = est.insertRV(0.5, "rate");
  const auto lens = est.insertRV(Lens<>(third(1500), 0.1), "lens");
  Eigen::Matrix3d L = Eigen::Matrix3d::Identity() * third(4);
  L(2, 0) = third(1);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    est.insertMeasurement(traced(distance), poses[i], point, measured(third(7 + static_cast<double>(i))),
                          StandardDeviation(third(1)), Huber(1.5), named("range \"1\""),
                          group(static_cast<int>(i)));
    est.insertMeasurement(traced(turn), poses[i], poses[(i + 1) % 3],
                          measured(SE3(SO3(), Vec3(third(1), 0, 0.2))), named("odometry"),
                          group("first", "way"), group(static_cast<int>(i)));
    est.insertMeasurement(traced(of_rig), rig, point, Vec3(third(1), static_cast<double>(i), 5),
                          StandardDeviation(0.1 + third(static_cast<double>(i))), Barron(-1, 2));
  }
  est.insertMeasurement(traced(of_wheel), rig, InvStandardDeviation(2.5));
  est.insertMeasurement(traced(turn), a, b, measured(SO3::exp(Vec3(0.1, third(1), 0))),
                        Covariance(Eigen::Matrix3d(L * L.transpose())));
  for (int i = 0; i < 9; ++i)
    est.insertMeasurement(traced(line), x, 1e-3 * i * i, rate, measured(third(i)), StandardDeviation(0.1),
                          Cauchy(2));
  est.insertMeasurement(traced([](const auto& own, const auto& z) { return own - z; }), lens,
                        Vec2(third(1501), 0.2), StandardDeviation(Eigen::Vector2d(0.1, third(1))));
  Eigen::MatrixXd R = Eigen::MatrixXd::Identity(22, 22) * third(1);
  R(0, 20) = 0.25;
  est.insertMeasurement(GaussianPrior({rig, point}, R));
  est.fix(rig, member("pose", 0) + ".pos.x");
  est.fix(rig, member("scale", 4));
  est.bound(rig, member("five", 2), -INFINITY, third(16));  // five of them
  est.bound(lens, "k1", third(0.1), 1);
  return est;
}

std::string saved(const Estimator& est, const Archive& archive) {
  std::ostringstream os;
  archive.save(est, os);
  return os.str();
}
Archive priors() {
  Archive archive;
  archive.measurement<GaussianPrior>();
  return archive;
}
StoredProblem loaded(const std::string& text, const Archive& archive = priors()) {
  std::istringstream is(text);
  return archive.load(is, "FILE");
}

void expectTheSameFit(Estimator& a, Estimator& b) {
  ASSERT_EQ(a.getM(), b.getM());
  ASSERT_EQ(a.getN(), b.getN());
  EXPECT_LT((a.residuals() - b.residuals()).cwiseAbs().maxCoeff(),
            1e-12 * a.residuals().cwiseAbs().maxCoeff());
  const Summary one = a.optimize(), other = b.optimize();
  EXPECT_TRUE(one.converged) << one;
  EXPECT_EQ(one.iterations, other.iterations);
  EXPECT_EQ(one.active_bounds, other.active_bounds);
  EXPECT_NEAR(one.final_rss, other.final_rss, 1e-10 * one.final_rss);
  const std::string report = one.report();
  EXPECT_EQ(report.substr(report.find("measurement")),
            other.report().substr(other.report().find("measurement")));
}

TEST(TracedArchive, AProgramWithoutTheFunctionsFitsTheSame) {
  Estimator est = makeProblem();
  const std::string text = saved(est, priors());
  StoredProblem problem = loaded(text);
  EXPECT_EQ(RuntimeType::of(problem.variable("rig"))->fields(),
            (std::vector<RuntimeType::Field>{{member("pose", 0), RuntimeType::Kind::se3},
                                             {member("axis", 1), RuntimeType::Kind::s2},
                                             {member("five", 2), RuntimeType::Kind::vector, 5},
                                             {member("heading", 3), RuntimeType::Kind::so2},
                                             {member("scale", 4), RuntimeType::Kind::number},
                                             {member("wheel", 5), RuntimeType::Kind::se2},
                                             {member("one", 6) + ".0", RuntimeType::Kind::number}}));
  ASSERT_EQ(problem.variables().size(), 10u);
  EXPECT_EQ(problem.estimator.nameOf(problem.variables()[2]), "pose \"2\"");
  EXPECT_EQ(problem.estimator.componentNames(problem.variable("lens")).front(), "lens.focal");

  // A described type is saved as such, and then always loaded as such.
  const std::string again = saved(problem.estimator, priors());
  EXPECT_NE(text.find(" or fields "), std::string::npos);
  EXPECT_EQ(again.find(" or fields "), std::string::npos);
  StoredProblem third = loaded(again);
  EXPECT_EQ(saved(third.estimator, priors()), again);
  expectTheSameFit(est, problem.estimator);
}

TEST(TracedArchive, RegisteredTypesStayWhatTheyAre) {
  Estimator est = makeProblem();
  const std::string text = saved(est, priors());
  Archive archive = priors();
  archive.measurement<RelativePose, VarID<SE3>, VarID<SE3>, Measured<SE3>>();
  archive.measurement<Range, VarID<SE3>, VarID<Vec3>, Measured<double>>();
  archive.measurement<Prior, VarID<double>, Measured<double>>();
  StoredProblem problem = loaded(text, archive);
  EXPECT_EQ(problem.variables<SE3>().size(), 3u);
  EXPECT_EQ(problem.variables<double>().size(), 2u);
  const auto pose = problem.variable<SE3>("pose \"1\"");
  EXPECT_EQ(RuntimeType::of(problem.variable("pose \"1\"")), nullptr);
  EXPECT_NE(RuntimeType::of(problem.variable("rig")), nullptr);

  // Other measurements of the same variables can be in the same file.
  problem.estimator.insertMeasurement(Range(), pose, problem.variable<Vec3>("point"), measured(1.0));
  const std::string mixed = saved(problem.estimator, archive);
  EXPECT_EQ(saved(loaded(mixed, archive).estimator, archive), mixed);
  StoredProblem copy = loaded(mixed, archive);
  expectTheSameFit(problem.estimator, copy.estimator);
}

TEST(TracedArchive, ATypeWithItsOwnTextHasNoFields) {
  Estimator est;
  est.insertMeasurement(traced([](const auto& own) { return own; }), est.insertRV(Vec2(1, 2), "v"));
  est.insertMeasurement(traced([](const auto& own) { return own[0] * 2.0; }),
                        est.insertRV(Tagged<>(3.0), "t"));
  Archive archive;
  archive.variable<Vec2>("point");
  archive.variable<Tagged<>>("tagged");
  const std::string text = saved(est, archive);
  EXPECT_NE(text.find("variables \"tagged\"\n\"t\" free value=3\n"), std::string::npos) << text;
  EXPECT_EQ((*loaded(text, archive).variable<Tagged<>>("t"))[0], 3);
  EXPECT_TRUE(messageOf([&] { loaded(text); }).find("variables \"tagged\" are not known to this program") !=
              std::string::npos);
  EXPECT_NE(text.find("variables \"point\" or fields \"\" vector 2\n"), std::string::npos) << text;
  EXPECT_EQ(*loaded(text, archive).variable<Vec2>("v"), Vec2(1, 2));
  EXPECT_EQ(RuntimeType::of(loaded(saved(est, Archive())).variable("t"))->fields().front().name, "0");
}

TEST(TracedArchive, NumbersKeepAllTheirBits) {
  Estimator est;
  const double tiny = 5e-324, odd = 0.1 + 0.2;
  est.insertMeasurement(
      traced([tiny, odd](const auto& x, const auto& z) { return (x - z) * odd + tiny - 0.0 * x; }),
      est.insertRV(1e300 / 3, "x"), odd);
  StoredProblem problem = loaded(saved(est, Archive()));
  EXPECT_EQ(problem.estimator.residuals()[0], est.residuals()[0]);
  EXPECT_EQ(saved(problem.estimator, Archive()),
            saved(loaded(saved(problem.estimator, Archive())).estimator, Archive()));
}

/// A small file: a circle.
std::string circle() {
  Estimator est;
  const auto centre = est.insertRV(Vec2(0.1, 0), "centre");
  const auto radius = est.insertRV(1.0, "radius");
  for (int i = 0; i < 5; ++i)
    est.insertMeasurement(
        traced([](const auto& c, const auto& r, const auto& q) { return (q - c).norm() - r; }), centre,
        radius, Vec2(3 * std::cos(i), 2 + 3 * std::sin(i)), StandardDeviation(0.1), named("point"));
  return saved(est, Archive());
}

std::string replacedOnce(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

/// Returns the checksum that the reader names.
std::string withChecksum(const std::string& text) {
  const std::string message = messageOf([&] { loaded(text); });
  const std::string before = "have the checksum ";
  const std::size_t at = message.find(before);
  if (at == std::string::npos) return text;
  const std::size_t line = text.find("checksum ");
  return std::string(text).replace(line + 9, 16, message.substr(at + before.size(), 16));
}

TEST(TracedArchiveFaults, VersionAndChecksum) {
  const std::string text = circle();
  const auto line = [&](const std::string& what) {
    return std::to_string(
        1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find(what)), '\n'));
  };
  EXPECT_EQ(
      messageOf([&] { loaded(replacedOnce(text, "tape 1\n", "tape 2\n")); }),
      "[slom.bad-archive] FILE:" + line("tape 1") +
          ": the tape is saved in version 2 of the format of tapes, but this program reads version 1; use a newer "
          "program");
  const std::string stated = text.substr(text.find("checksum ") + 9, 16);
  const std::string changed = replacedOnce(text, " = sqrt ", " = abs ");
  const std::string message = messageOf([&] { loaded(changed); });
  const std::string own = message.substr(message.find("checksum ") + 9, 16);
  EXPECT_NE(own, stated);
  EXPECT_EQ(message, "[slom.bad-archive] FILE:" + line("checksum") +
                         ": the lines of the tape have the checksum " + own + ", but the file states " +
                         stated +
                         ": the tape was changed or damaged; write it again with the program that made it");
  EXPECT_EQ(messageOf([&] { loaded(withChecksum(changed)); }), "no error");
  // Comments, empty lines and Windows lines do not count.
  EXPECT_EQ(messageOf([&] { loaded(replacedOnce(text, "residual\n", "# f(x)\n\nresidual\r\n")); }),
            "no error");
}

TEST(TracedArchiveFaults, AreNamedWithTheirLine) {
  const std::string head = "slom problem 1\nvariables \"double\" or fields \"\" number\n\"x\" free 1\n";
  const std::string code =
      "variable \"double\" vector 1\ndata 0\nrows 1\nregisters 2\nconstants\nresidual\n1 = copy 0\nlinearization\n"
      "1 = copy 0\njacobian\n=1\n";
  EXPECT_EQ(
      messageOf([&] { loaded(head + "tape 2\n" + code + "checksum 0000000000000000\nend\n"); }),
      "[slom.bad-archive] FILE:4: the tape is saved in version 2 of the format of tapes, but this program reads version "
      "1; use a newer program");
  EXPECT_EQ(
      messageOf([&] { loaded(head + "tape 1\n" + code + "checksum 0000000000000000\nend\n"); }),
      "[slom.bad-archive] FILE:16: the lines of the tape have the checksum d50df07f1f9f9ed6, but the file states "
      "0000000000000000: the tape was changed or damaged; write it again with the program that made it");
  EXPECT_EQ(
      messageOf([&] { loaded(head + "tape 1\n" + code); }),
      "[slom.bad-archive] FILE is not complete: its last line is not \"end\"; take a file that was written to its end");
  EXPECT_EQ(
      messageOf([&] { loaded(withChecksum(head + "tape 1\n" + code + "checksum 0000000000000000\nend\n")); }),
      "no error");
  EXPECT_EQ(
      messageOf([&] {
        loaded(withChecksum(head + "tape 1\n" + replacedOnce(code, "1 = copy 0", "1 = copy 9") +
                            "checksum 0000000000000000\nend\n"));
      }),
      "[slom.bad-archive] FILE:16: the tape reads register 9 in instruction 0, which has no value; write it again with "
      "the program that made it");
  EXPECT_EQ(
      messageOf([&] { loaded("slom problem 1\nvariables \"Lens\" fields \"k\" sphere\n"); }),
      "[slom.bad-archive] FILE:2: write variables \"TYPE\" fields or variables \"TYPE\" or fields, then for each "
      "field its \"NAME\" and number, vector N, so2, so3, s2, se2 or se3");
  EXPECT_EQ(
      messageOf([&] { loaded("slom problem 1\nvariables \"Axis\" fields \"\" s2\n\"a\" free 0 0 0\n"); }),
      "[slom.bad-archive] FILE:3: a direction (S2) cannot be made of the vector (0, 0, 0), which is zero or not finite; pass a finite vector of any positive length");
}

TEST(TracedArchiveFaults, OfLines) {
  const std::string text = circle();
  const auto expectFault = [&](const std::string& what, const std::string& by, const std::string& message) {
    const std::string error = messageOf([&] { loaded(withChecksum(replacedOnce(text, what, by))); });
    EXPECT_TRUE(error.starts_with("[slom.bad-archive] FILE:")) << error;
    const std::size_t colon = error.find(": ");
    EXPECT_EQ(error.substr(colon == std::string::npos ? 0 : colon + 2), message);
  };
  expectFault("tape 1", "tape one", "write tape VERSION");
  expectFault(
      "data 2", "date 2",
      "a line of a tape cannot begin with \"date\"; write variable, data, rows, registers, constants, residual, "
      "linearization, jacobian or checksum");
  expectFault("data 2", "data two", "\"two\" is not a number of entries");
  expectFault("data 2", "data 2 3", "\"3\" is too much in this line of the tape");
  expectFault("variable \"vect<2>\" vector 2", "variable \"vect<2>\" sphere 2",
              "\"sphere\" is not a part of a variable; write vector N, angle, rotation or direction");
  expectFault("variable \"vect<2>\" vector 2", "variable \"vect<2>\" vector",
              "the size of a vector is missing");
  expectFault("variable \"vect<2>\" vector 2", "variable", "write variable \"TYPE\" and its parts");
  expectFault(" = sqrt", " = root",
              "\"root\" is not an instruction of tapes; write REGISTER = INSTRUCTION REGISTERS");
  expectFault(" = sqrt", " 9 = sqrt", "the instruction sqrt has one result");
  expectFault(" = sqrt", " = sin_cos", "the instruction sin_cos has two results");
  expectFault(" = sqrt ", " = sqrt 70000 ", "\"70000\" is not a register, 0 to 65535");
  expectFault(" = sqrt ", " = sqrt 0 ",
              "\"" +
                  text.substr(text.find(" = sqrt ") + 8,
                              text.find('\n', text.find(" = sqrt ")) - text.find(" = sqrt ") - 8) +
                  "\" is too much in this line of the tape");
  expectFault("=-1", "=minus", "\"minus\" is not a number");
  expectFault("data 2", "data 70000",
              "the tape has more than 65535 numbers; write it again with the program that made it");
  expectFault("data 2", "data -1",
              "the tape has more than 65535 numbers; write it again with the program that made it");
  expectFault("rows 1", "rows 2", "\"\" is not a register or = and a number");
  expectFault("measurements tape 0", "measurements tape 1", "there is no tape 1; defined above are 0 to 0");
  expectFault("measurements tape 0", "measurements tap 0",
              "write measurements \"TYPE\" \"LABEL\" or measurements tape NUMBER \"LABEL\"");
  expectFault("\n0 1 | ", "\n1 0 | ", "variable 1, \"radius\", is a double where the tape takes a vect<2>");
  expectFault("variables \"vect<2>\" or fields \"\" vector 2",
              "variables \"vect<2>\" or fields \"\" vector 0",
              "the type of variables vect<2> has the vector  of 0 numbers; give it at least one");
  expectFault("variables \"vect<2>\" or fields \"\" vector 2",
              "variables \"vect<2>\" or fields \"\" vector 99999",
              "the type of variables vect<2> has 99999 numbers; give it at most 65535");
  expectFault("variables \"vect<2>\" or fields \"\" vector 2", "variables \"vect<2>\" or fields \"\" sphere",
              "write variables \"TYPE\" fields or variables \"TYPE\" or fields, then for each "
              "field its \"NAME\" and number, vector N, so2, so3, s2, se2 or se3");
}

TEST(TracedArchiveFaults, LeaveNothing) {
  // Truncated and mutated files are refused with a line, or are other problems, which can be evaluated.
  const std::string text = circle();
  for (std::size_t size = 0; size < text.size() - 1; ++size) {
    EXPECT_TRUE(messageOf([&] { loaded(text.substr(0, size)); }).starts_with("[slom.bad-archive] FILE"))
        << size;
  }
  const unsigned seed = std::random_device()();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const std::string characters = "0123456789 =.-e\nabcdsqrt_";
  int accepted = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string own = text;
    for (std::size_t k = 0; k <= random() % 2; ++k)
      own[text.find("tape") + random() % (text.size() - text.find("tape"))] =
          characters[random() % characters.size()];
    const std::string message = messageOf([&] {
      StoredProblem problem = loaded(withChecksum(own));
      ++accepted;
      problem.estimator.getRSS();
    });
    EXPECT_TRUE(message == "no error" || message.starts_with("[slom.bad-archive] FILE") ||
                message.starts_with("[slom.not-finite]"))
        << message;
  }
  EXPECT_GT(accepted, 100);
}

}  // namespace
}  // namespace slom::testing
