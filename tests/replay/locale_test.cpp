// Saved problems, and texts about a fit, do not depend on the locale of the program.
#include <clocale>
#include <cstdlib>
#include <locale>
#include <sstream>

#include <gtest/gtest.h>

#include <slom/archive.hpp>
#include <slom/measurements/range.hpp>
#include <slom/slom.hpp>

#include "support/message_of.hpp"
#include "support/paths.hpp"
#include "support/run_command.hpp"

namespace slom::testing {
namespace {

using Point = mtk::vect<2>;

/// Decimals after a comma, points between thousands.
struct Comma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

/// A guard that sets the locales of C++ and, if the system can make it, of C to those of a German program.
class German {
 public:
  German() : before_(std::locale::global(std::locale(std::locale::classic(), new Comma))) {
    const auto made = runCommand(
        {"/usr/bin/env", "localedef", "-i", "de_DE", "-f", "UTF-8", (folder_ / "de_DE.UTF-8").string()});
    ::setenv("LOCPATH", folder_.path().c_str(), 1);
    is_complete = made.exit_code == 0 && std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr;
    char text[8] = "0,5";
    if (is_complete) std::snprintf(text, sizeof text, "%.1f", 0.5);
    EXPECT_STREQ(text, "0,5");
  }
  German(const German&) = delete;
  German& operator=(const German&) = delete;
  ~German() {
    std::locale::global(before_);
    std::setlocale(LC_ALL, "C");
    ::unsetenv("LOCPATH");
  }
  bool is_complete = false;

 private:
  TemporaryFolder folder_;
  std::locale before_;
};

Archive networkArchive() {
  Archive archive;
  archive.measurement<Range, VarID<Point>, VarID<Point>, Measured<double>>();
  return archive;
}

Estimator networkInMemory() {
  Estimator est;
  const auto a = est.insertRV(Point(0.25, -1000.5), false, "A"),
             b = est.insertRV(Point(12345.75, 1e-7), false, "B");
  const auto p = est.insertRV(Point(100.5, 2000.25), "P");
  est.insertMeasurement(Range(), a, p, measured(3333.3), StandardDeviation(0.3), Huber(1.345));
  est.insertMeasurement(Range(), b, p, measured(12345.678), StandardDeviation(0.3));
  est.insertMeasurement(Range(), a, p, measured(3333.4), StandardDeviation(0.3), Barron(-INFINITY, 1.5));
  est.bound(p, "x", 0.5, INFINITY);
  return est;
}

std::string savedText(const Estimator& est) {
  std::ostringstream os;
  networkArchive().save(est, os);
  return os.str();
}

/// The text of the network after it was saved and loaded.
std::string savedTwice() {
  std::istringstream text(savedText(networkInMemory()));
  StoredProblem problem = networkArchive().load(text);
  EXPECT_EQ(savedText(problem.estimator), text.str());
  EXPECT_EQ(*problem.variable<Point>("B"), Point(12345.75, 1e-7));
  return text.str();
}

TEST(Locale, SavedProblemsHavePoints) {
  const std::string classic = savedTwice();
  ASSERT_NE(classic.find("0.25 -1000.5"), std::string::npos) << classic;
  const German german;
  EXPECT_EQ(savedTwice(), classic);
  if (!german.is_complete)
    GTEST_SKIP() << "the system has no program localedef and no German locale; that of C++ alone was tried";
}

TEST(Locale, ReportsHavePoints) {
  const auto reports = [] {
    Estimator est = networkInMemory();
    const std::string report = preflight(est).text() + est.optimize().report() + diagnose(est).text();
    return report + outliers(est).text();
  };
  const std::string classic = reports();
  EXPECT_NE(classic.find("0.0554695"), std::string::npos) << classic;
  const German german;
  EXPECT_EQ(reports(), classic);
}

TEST(Locale, ErrorsHavePoints) {
  const auto message = [] {
    Estimator est;
    const auto x = est.insertRV(1.5, "x");
    return messageOf([&] { est.bound(x, 2.5, 1234.5); });
  };
  const std::string classic = message();
  EXPECT_NE(classic.find("1.5"), std::string::npos) << classic;
  const German german;
  EXPECT_EQ(message(), classic);
}

TEST(Locale, FilesWithCommasAreRefusedWithTheReason) {
  const std::string head = "slom problem 1\nvariables \"vect<2>\"\n\"A\" fixed 0 0\n\"P\" free 4 4.5\n";
  const std::string group = head + "measurements \"Range(vect<2>, vect<2>, measured double)\" \"\"\n";
  const std::string why =
      "; the number has a decimal comma, as programs with such a locale write; use decimal points";
  const auto expectRefused = [&](const std::string& text, const std::string& sentence) {
    std::istringstream is(text);
    EXPECT_EQ(messageOf([&] { networkArchive().load(is, "FILE"); }),
              "[slom.bad-archive] FILE:" + sentence + why);
  };
  expectRefused(group + "0 1 | scalar 3,5 huber 1.345 | 5.5\nend\n",
                "6: \"3,5\" is neither a number of the noise nor a loss nor a |");
  expectRefused(group + "0 1 | scalar 3 huber 1,345 | 5.5\nend\n", "6: numbers are missing after huber");
  expectRefused(
      group + "0 1 | scalar 3 huber 1.345 | 5,5\nend\n",
      "6: the text after the second | is not the data of Range(vect<2>, vect<2>, measured double): 5,5");
  expectRefused(head + "\"Q\" free 4,5 1\nend\n", "5: variable \"Q\" has no value that is a vect<2>: 4,5 1");
  expectRefused(head + "bound 1 \"x\" 0,5 7\nend\n", "5: write bound NUMBER \"COMPONENT\" LOWER UPPER");
}

TEST(Locale, AFileOfAGermanProgram) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("hostile/de.slom");
  const std::string file = sharedDataPath("hostile/de.slom").string();
  const auto result = runCommand({commandPath().string(), "replay", file});
  EXPECT_EQ(result.errors,
            "slom: " + file +
                ":6: \"3,3333333333333335\" is neither a number of the noise nor a loss nor a |; the number "
                "has a decimal comma, as programs with such a locale write; use decimal points\n");
  EXPECT_EQ(result.exit_code, 2);
}

/// Sizes announced by a file without the content.
TEST(ArchiveFaults, SizesWithoutNumbers) {
  Archive archive;
  constexpr auto sum = [](double x, const Eigen::MatrixXd& table) { return x * table.sum(); };
  archive.measurement<decltype(sum), VarID<double>, Eigen::MatrixXd>("sum");
  std::istringstream is(
      "slom problem 1\nvariables \"double\"\n\"x\" free 1\nmeasurements \"sum\" \"\"\n0 | unit | 10000 10000 "
      "1 2\nend\n");
  EXPECT_EQ(messageOf([&] { archive.load(is, "FILE"); }),
            "[slom.bad-archive] FILE:5: the text after the second | is not the data of sum: 10000 10000 1 2");
}

}  // namespace
}  // namespace slom::testing
