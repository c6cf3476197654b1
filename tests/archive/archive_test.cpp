// A problem that was saved and loaded is the same: residuals, structure, masks, and the result of the fit.
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include <mtk/build_manifold.hpp>
#include <slom/archive.hpp>
#include <slom/measurements/landmark.hpp>
#include <slom/measurements/range.hpp>
#include <slom/measurements/relative_pose.hpp>
#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace slom::testing {

using Pose = mtk::trafo<mtk::SO3<>>;
using vec3 = mtk::vect<3>;
MTK_BUILD_MANIFOLD(Sensor, ((Pose, pose))((mtk::vect<2>, gain))((mtk::S2<>, axis)))

/// Data of a type of its own, with the stream operators that this needs.
struct Reading {
  int channel = 0;
  double value = 0;
  friend std::ostream& operator<<(std::ostream& os, const Reading& r) {
    return os << r.channel << "/" << r.value;
  }
  friend std::istream& operator>>(std::istream& is, Reading& r) {
    char slash = 0;
    return is >> r.channel >> slash >> r.value;
  }
};

enum class Unit { volt, ampere };

SLOM_BUILD_MEASUREMENT(Declared, Dynamic, ((Sensor, sensor))((double, offset)),
                       ((Reading, reading))((std::string, note)))
SLOM_IMPLEMENT_MEASUREMENT(Declared, ret) {
  ret.resize(reading.channel);
  for (int i = 0; i < reading.channel; ++i)
    ret[i] = sensor->gain[i % 2] * sensor->axis.vector()[i % 3] + *offset - reading.value * i;
}
SLOM_BUILD_MEASUREMENT(NoData, 1, ((double, x)), )
SLOM_IMPLEMENT_MEASUREMENT(NoData, ret) { ret[0] = std::exp(*x) - 2; }

constexpr auto by_table = [](const auto& v, const auto& offset, const Eigen::MatrixXd& table,
                             const std::vector<double>& weights, Unit unit, bool sign) {
  using S = mtk::scalar_t<std::decay_t<decltype(v)>>;
  S sum = offset * (sign ? 1.0 : -1.0);
  for (int i = 0; i < table.rows(); ++i) {
    for (int j = 0; j < table.cols(); ++j) sum += table(i, j) * v[i] * weights[static_cast<std::size_t>(j)];
  }
  return S(sum * (unit == Unit::ampere ? 2.0 : 1.0));
};
using ByTable = decltype(by_table);

Archive makeArchive() {
  Archive archive;
  archive.variable<Sensor>("my sensor");
  archive.measurement<RelativePose, VarID<Pose>, VarID<Pose>, Measured<Pose>>();
  archive.measurement<RelativePoseInFrameOfA, VarID<Pose>, VarID<Pose>, Measured<Pose>>();
  archive.measurement<Landmark, VarID<Pose>, VarID<vec3>, Measured<vec3>>();
  archive.measurement<Range, VarID<vec3>, VarID<Pose>, Measured<double>>();
  archive.measurement<Prior, VarID<Sensor>, Measured<Sensor>>();
  archive.measurement<Prior, VarID<double>, Measured<double>>();
  archive.measurement<Prior, VarID<mtk::vect<Dynamic>>, Measured<mtk::vect<Dynamic>>>();
  archive.measurement<Declared>();
  archive.measurement<NoData>();
  archive.measurement<ByTable, VarID<mtk::vect<Dynamic>>, VarID<double>, Eigen::MatrixXd, std::vector<double>,
                      Unit, bool>("table");
  return archive;
}

/// Everything that a problem can have.
Estimator makeProblem() {
  Estimator est;
  const auto third = [](double x) { return x / 3; };  // numbers without a short decimal notation
  const auto turned = [&](double a) { return mtk::SO3<>::exp(vec3(third(a), -third(2 * a), third(1))); };
  std::vector<VarID<Pose>> poses;
  for (int i = 0; i < 4; ++i)
    poses.push_back(est.insertRV(Pose(vec3(third(i), third(i * i), 0.1), turned(i)), i > 0,
                                 "pose \"" + std::to_string(i) + "\""));
  const auto landmark = est.insertRV(vec3(third(5), third(-4), third(7)));
  const auto sensor = est.insertRV(
      Sensor(poses[1]->inverse() * *poses[2], mtk::vect<2>(third(1), third(2)), mtk::S2<>(1, 2, third(3))),
      "sensor");
  const auto gone = est.insertRV(1.0, "gone");
  const auto offset = est.insertRV(third(1), "offset");
  mtk::vect<Dynamic> numbers(3);
  numbers << third(1), third(2), 5e-300;
  const auto vector = est.insertRV(numbers, "vector");
  est.removeRV(gone);
  for (std::size_t i = 1; i < 4; ++i) {
    Eigen::Matrix<double, 6, 6> L = Eigen::Matrix<double, 6, 6>::Identity() * third(4);
    L(3, 1) = third(2), L(5, 0) = -third(1);
    est.insertMeasurement(
        RelativePose(), poses[i - 1], poses[i], measured(Pose(vec3(third(2), 0.1, 0), turned(0.5))),
        InvCovariance(Eigen::Matrix<double, 6, 6>(L * L.transpose())), Huber(third(4)), named("odometry"));
  }
  const auto extra =
      est.insertMeasurement(RelativePose(), poses[0], poses[2], measured(Pose()), named("odometry"));
  est.insertMeasurement(RelativePose(), poses[3], poses[0], measured(Pose()), Barron(-INFINITY, 2),
                        named("loop"));
  est.removeMeasurement(extra);
  for (const auto& pose : poses) {
    est.insertMeasurement(Landmark(), pose, landmark, measured(vec3(1, third(1), 2)),
                          StandardDeviation(vec3(0.1, third(1), 0.3)));
    est.insertMeasurement(Range(), landmark, pose, measured(third(8)), StandardDeviation(third(0.1)),
                          Tukey(3));
  }
  est.prior(sensor, *sensor, 0.5);
  est.prior(offset, third(2), Covariance(third(1)));
  est.prior(vector, numbers, 0.1);
  est.insertMeasurement(Declared(sensor, offset, Reading{3, third(1)}, "a \"quoted\" note, or two"));
  est.insertMeasurement(Declared(sensor, offset, Reading{1, third(2)}, ""), Cauchy(1));
  est.insertMeasurement(NoData(offset), GemanMcClure(third(5)));
  Eigen::MatrixXd table(3, 2);
  table << third(1), 2, 3, 4, 5, third(6);
  est.insertMeasurement(by_table, vector, offset, table, std::vector<double>{third(1), -1}, Unit::ampere,
                        true, PseudoHuber(2));
  est.fix(sensor, "pose.pos");
  est.fix(vector, "y");
  est.bound(sensor, "gain.x", -INFINITY, third(1));  // where it starts
  est.bound(sensor, "gain.y", third(2), INFINITY);
  est.setSigma(Sigma::estimated);
  est.setFreeGauge(FreeGauge::inner_constraints);
  return est;
}

std::string saved(const Estimator& est) {
  std::ostringstream os;
  makeArchive().save(est, os);
  return os.str();
}
StoredProblem loaded(const std::string& text) {
  std::istringstream is(text);
  return makeArchive().load(is, "FILE");
}

TEST(Archive, ALoadedProblemIsTheSame) {
  Estimator est = makeProblem();
  StoredProblem problem = loaded(saved(est));
  Estimator& copy = problem.estimator;
  ASSERT_EQ(copy.getM(), est.getM());
  EXPECT_EQ(copy.getN(), est.getN());
  EXPECT_EQ(copy.sigma(), Sigma::estimated);
  EXPECT_EQ(copy.freeGauge(), FreeGauge::inner_constraints);
  EXPECT_NEAR(copy.getRSS() / est.getRSS(), 1, 1e-13);
  const Eigen::VectorXd difference = copy.residuals() - est.residuals();
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-12 * est.residuals().cwiseAbs().maxCoeff());
  EXPECT_EQ(copy.nameOf(problem.variables<Pose>()[2]), "pose \"2\"");
  EXPECT_EQ(problem.variables<vec3>().size(), 1u);

  const Summary a = est.optimize(), b = copy.optimize();
  ASSERT_TRUE(a.converged) << a;
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.redundancy, b.redundancy);
  EXPECT_EQ(a.active_bounds, b.active_bounds);
  EXPECT_FALSE(a.active_bounds.empty()) << "the bound is to be in the way";
  EXPECT_NEAR(b.final_rss / a.final_rss, 1, 1e-10);
  ASSERT_EQ(a.groups.size(), b.groups.size());
  for (std::size_t g = 0; g < a.groups.size(); ++g) {
    EXPECT_EQ(a.groups[g].name, b.groups[g].name);
    EXPECT_EQ(a.groups[g].measurements, b.groups[g].measurements);
    EXPECT_EQ(a.groups[g].losses.size(), b.groups[g].losses.size());
  }
}

/// The numbers of a text, in order, and the text without them.
std::pair<std::vector<double>, std::string> split(const std::string& text) {
  std::vector<double> numbers;
  std::string rest, word;
  for (std::istringstream is(text); is >> word;) {
    char* end = nullptr;
    const double x = std::strtod(word.c_str(), &end);
    if (*end == 0) {
      numbers.push_back(x);
    } else {
      rest += word + " ";
    }
  }
  return {numbers, rest};
}

TEST(Archive, WhatIsLoadedIsSavedTheSame) {
  const std::string first = saved(makeProblem());
  const std::string second = saved(loaded(first).estimator);
  const auto [a, words_a] = split(first);
  const auto [b, words_b] = split(second);
  EXPECT_EQ(words_a, words_b);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {  // unit quaternions and directions are made so again
    if (std::isfinite(a[i])) {
      EXPECT_NEAR(a[i], b[i], 1e-15 * std::max(1.0, std::abs(a[i])));
    } else {
      EXPECT_EQ(a[i], b[i]);
    }
  }
}

/// Files from before RelativePose measured in the frame of z keep their meaning. Present files state which frame they
/// mean.
TEST(Archive, RelativePosesOfEarlierFilesKeepTheirFrame) {
  const std::string kind = "\"RelativePose(trafo<SO3>, trafo<SO3>, measured trafo<SO3>)";
  const std::string half =
      "0.70710678118654757";  // a quarter turn about z: b lies 1 to the left of a, which is ahead of z
  const auto file = [&](const std::string& name) {
    return "slom problem 1\nvariables \"trafo<SO3>\"\n\"a\" fixed 0 0 0 0 0 0 1\n\"b\" free 2 1 0 0 0 " +
           half + " " + half + "\nmeasurements " + name + "\" \"\"\n0 1 | unit | 2 0 0 0 0 " + half + " " +
           half + "\nend\n";
  };
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(6);
  expected[1] = 1;
  EXPECT_LT((loaded(file(kind)).estimator.residuals() - expected).norm(), 1e-15);
  EXPECT_NE(saved(loaded(file(kind)).estimator).find(kind + "\" \"\"\n"), std::string::npos);
  expected[0] = 1, expected[1] = 0;
  const std::string today = kind + " in the frame of z";
  EXPECT_LT((loaded(file(today)).estimator.residuals() - expected).norm(), 1e-15);
  EXPECT_NE(saved(loaded(file(today)).estimator).find(today + "\" \"\"\n"), std::string::npos);
}
/// A user's own name does not hide the change either.
TEST(Archive, ANamedRelativePoseSaysItsFrame) {
  Archive archive;
  archive.measurement<RelativePose, VarID<Pose>, VarID<Pose>, Measured<Pose>>("odometry");
  std::istringstream is("slom problem 1\nmeasurements \"odometry\" \"\"\nend\n");
  EXPECT_EQ(
      messageOf([&] { archive.load(is, "FILE"); }),
      "[slom.bad-archive] FILE:2: measurements \"odometry\" are not known to this program, which knows \"odometry in the frame "
      "of z\"; a program that includes slom/archive.hpp can register more");
}

TEST(Archive, AnEmptyProblem) {
  EXPECT_EQ(saved(Estimator()), "slom problem 1\nend\n");
  EXPECT_EQ(loaded("slom problem 1\n\n# nothing\nend\n").estimator.getN(), 0);
}

TEST(Archive, AThousandDigitsAndWindowsLines) {
  const std::string text =
      "slom problem 1\r\nvariables \"double\"\r\n\"x\" free 1." + std::string(1000, '0') + "\r\nend\r\n";
  EXPECT_EQ(*loaded(text).variable<double>("x"), 1);
}

TEST(Archive, VariablesAreFoundByNameAndType) {
  const StoredProblem problem =
      loaded("slom problem 1\nvariables \"double\"\n\"x\" free 3\n\"x\" free 4\nend\n");
  EXPECT_EQ(*problem.variable<double>("x"), 3);
  EXPECT_EQ(problem.variables<double>().size(), 2u);
  EXPECT_EQ(messageOf([&] { problem.variable<double>("y"); }),
            "[slom.no-variable] the problem has no variable \"y\"; names are those given to insertRV");
  EXPECT_EQ(messageOf([&] { problem.variable<Pose>("x"); }),
            "[slom.no-variable] variable \"x\" is no trafo<SO3>; ask for it by its own type");
}

TEST(ArchiveFaults, OfWhatIsSaved) {
  Estimator est;
  const auto x = est.insertRV(mtk::vect<2>(1, 2), "x");
  EXPECT_EQ(
      messageOf([&] { saved(est); }),
      "[slom.not-in-archive] variable x is of the type vect<2>, which is not registered with the archive; name it by "
      "archive.variable<vect<2>>");
  Estimator unknown;
  unknown.insertMeasurement([](double y) { return y; }, unknown.insertRV(1.0), named("by hand"));
  EXPECT_EQ(
      messageOf([&] { saved(unknown); }),
      "[slom.not-in-archive] the type of the measurements by hand is not registered with the archive; name it by "
      "archive.measurement, with the function's type and those of its arguments");
  Estimator infinite;
  infinite.prior(infinite.insertRV(1.0, "y"), NAN, 1);
  EXPECT_EQ(
      messageOf([&] { saved(infinite); }),
      "[slom.not-savable] the data of measurement prior #1 is not finite, or cannot be read again from what its operator<< "
      "writes: nan");
}

TEST(ArchiveFaults, OfNames) {
  Archive archive = makeArchive();
  archive.measurement<Declared>();
  EXPECT_EQ(
      messageOf([&] { archive.measurement<Declared>("other"); }),
      "[slom.archive-name] the archive already calls these measurements \"Declared\", not \"other\"; name "
      "them once");
  EXPECT_EQ(
      (messageOf([&] { archive.measurement<Prior, VarID<vec3>, Measured<vec3>>("table"); })),
      "[slom.archive-name] the archive has measurements \"table\" of another type; give one of them another name");
  EXPECT_EQ(
      messageOf([&] { archive.variable<Sensor>("yours"); }),
      "[slom.archive-name] the archive already calls these variables \"my sensor\", not \"yours\"; name "
      "variables before the measurements that use them");
  EXPECT_EQ(
      messageOf([&] { archive.variable<mtk::vect<4>>("double"); }),
      "[slom.archive-name] the archive has variables \"double\" of another type; give one of them another name by "
      "archive.variable");
}

struct Fault {
  std::string text, message;
};

TEST(ArchiveFaults, OfWhatIsLoaded) {
  const std::string head =
      "slom problem 1\nvariables \"double\"\n\"x\" free 1\nvariables \"vect<3>\"\n\"p\" free 1 2 3\n";
  const std::string group = head + "measurements \"Prior(double, measured double)\" \"\"\n";
  const std::vector<Fault> faults{
      {"", "FILE:1: this is not a saved problem: its first line is not \"slom problem 1\""},
      {"VERTEX_SE2 0 0 0 0\n",
       "FILE:1: this is not a saved problem: its first line is not \"slom problem 1\""},
      {"slom problem 7\n",
       "FILE:1: the problem is saved in version 7 of the format, but this program reads version 1; use a "
       "newer program"},
      {head, "FILE is not complete: its last line is not \"end\"; take a file that was written to its end"},
      {head + "end\nend\n", "FILE:7: there is text after the line \"end\"; remove it"},
      {head + "vertex 1\n",
       "FILE:6: a line cannot begin with \"vertex\"; it begins with a quoted name, a number, variables, fix, "
       "bound, tape, measurements, sigma, gauge or end"},
      {head + "sigma unknown\n", "FILE:6: write \"sigma estimated\", or nothing for stated ones"},
      {head + "gauge free\n",
       "FILE:6: write \"gauge inner-constraints\", or nothing for an error at a free gauge"},
      {"slom problem 1\n\"x\" free 1\n",
       "FILE:2: a variable comes before the first line that begins with variables"},
      {"slom problem 1\nvariables double\nvariables\n", "FILE:3: write variables \"TYPE\""},
      {head + "\"y\" loose 1\n", "FILE:6: write \"NAME\" free VALUE or \"NAME\" fixed VALUE"},
      {head + "\"y\" free 1 2\n", "FILE:6: variable \"y\" has no value that is a vect<3>: 1 2"},
      {head + "\"y\" free 1 2 3 4\n", "FILE:6: variable \"y\" has no value that is a vect<3>: 1 2 3 4"},
      {head + "fix 2 \"x\"\n", "FILE:6: there is no variable 2; defined above are 0 to 1"},
      {"slom problem 1\nfix 0 \"x\"\n", "FILE:2: there is no variable 0; no variable is defined above"},
      {head + "fix x\n", "FILE:6: the number of a variable is missing here"},
      {head + "fix 1\n", "FILE:6: write fix NUMBER \"COMPONENT\""},
      {head + "fix 1 \"w\"\n", "FILE:6: variable p has no component \"w\"; pass one of x, y, z"},
      {head + "bound 1 \"x\" 0\n", "FILE:6: write bound NUMBER \"COMPONENT\" LOWER UPPER"},
      {head + "bound 1 \"x\" 2 3\n",
       "FILE:6: p.x is 1, outside of its bound [2, 3]; give it a value inside, or another bound"},
      {head + "0 | unit | 1\n",
       "FILE:6: a measurement comes before the first line that begins with measurements"},
      {head + "measurements \"Prior\"\n",
       "FILE:6: write measurements \"TYPE\" \"LABEL\" or measurements tape NUMBER \"LABEL\""},
      {group + "1 | unit | 1\n",
       "FILE:7: variable 1, \"p\", is a vect<3> where Prior(double, measured double) takes a double"},
      {group + "0 0 | unit | 1\n", "FILE:7: a | is missing after the numbers of 1 variable"},
      {group + "0 | | 1\n",
       "FILE:7: the noise is \"|\"; write unit, scalar, diagonal or matrix, and its numbers"},
      {group + "0 | unit 1 | 1\n", "FILE:7: the noise is unit with 1 number; unit has none, scalar one"},
      {group + "0 | matrix 1 0 | 1\n", "FILE:7: the noise matrix has 2 numbers, which is not a square"},
      {group + "0 | matrix 0 | 1\n",
       "FILE:7: whitening matrix of measurement Prior #1 is singular; pass an invertible matrix"},
      {group + "0 | diagonal 1 1 | 1\n",
       "FILE:7: whitening matrix of measurement Prior #1 has 2 entries but the residual has 1; pass a "
       "number, a vector of 1, or a 1 x 1 matrix"},
      {group + "0 | scalar -1 | 1\n",
       "FILE:7: whitening matrix of measurement Prior #1 is -1; pass positive finite numbers"},
      {group + "0 | scalar 1 hubert 1 | 1\n",
       "FILE:7: \"hubert\" is neither a number of the noise nor a loss nor a |"},
      {group + "0 | unit huber | 1\n", "FILE:7: numbers are missing after huber"},
      {group + "0 | unit huber 1 2 | 1\n", "FILE:7: a | is missing after the noise and the loss"},
      {group + "0 | unit huber -1 | 1\n",
       "FILE:7: loss Huber(-1) of measurement Prior #1 has scale -1; pass a positive finite number, in "
       "standard deviations of the residual"},
      {group + "0 | unit |\n",
       "FILE:7: the text after the second | is not the data of Prior(double, measured double):"},
      {group + "0 | unit | 1 2\n",
       "FILE:7: the text after the second | is not the data of Prior(double, measured double): 1 2"},
  };
  for (const Fault& fault : faults) {
    EXPECT_EQ(messageOf([&] { loaded(fault.text); }), "[slom.bad-archive] " + fault.message) << fault.text;
  }
  EXPECT_EQ(
      messageOf([&] { loaded("slom problem 1\nvariables \"vect<9>\"\n"); }),
      "[slom.bad-archive] FILE:2: variables \"vect<9>\" are not known to this program, which knows \"my sensor\", "
      "\"trafo<SO3>\", \"vect<3>\", \"double\" and \"vect<-1>\"; a program that includes slom/archive.hpp can register more");
}

}  // namespace slom::testing
