// Messages of the reader of NIST's files about malformed files.
#include <gtest/gtest.h>

#include "support/nist/problem.hpp"
#include "support/temporary_folder.hpp"

namespace {

using slom::testing::TemporaryFolder;
using slom::testing::nist::readProblem;
using slom::testing::nist::readProblems;

const std::string kGood =
    "Dataset Name:  Misra1a\n"
    "               Starting Values   (lines 7 to 8)\n"
    "               Data              (lines 11 to 13)\n"
    "Residual Sum of Squares:                    1.25E-01\n"
    "Number of Observations:                            3\n"
    "               Lower Level of Difficulty\n"
    "  b1 =   500         250           2.4E+02  2.7E+00\n"
    "  b2 =     0.0001      0.0005      5.5E-04  7.3E-06\n"
    "\n"
    "Data:   y               x\n"
    "      10.07E0      77.6E0\n"
    "      14.73E0     114.9E0\n"
    "      17.94E0     141.1E0\n";

/// kGood with the first `from` replaced by `to`.
std::string with(const std::string& from, const std::string& to) {
  std::string text = kGood;
  return text.replace(text.find(from), from.size(), to);
}

/// Returns the message about a file of this name and content, without its folder.
std::string faultOf(const std::string& name, const std::string& content) {
  const TemporaryFolder folder;
  slom::testing::writeFile(folder / name, content);
  try {
    readProblem(folder / name);
  } catch (const std::runtime_error& error) {
    return std::string(error.what()).substr(folder.path().string().size() + 1);
  }
  return "";
}

TEST(NistReader, ReadsStartsCertifiedValuesAndData) {
  const TemporaryFolder folder;
  slom::testing::writeFile(folder / "Misra1a.dat", kGood);
  const auto problem = readProblem(folder / "Misra1a.dat");
  EXPECT_EQ(problem.difficulty, "Lower");
  EXPECT_EQ(problem.starts[1], Eigen::Vector2d(250, 0.0005));
  EXPECT_EQ(problem.parameters, Eigen::Vector2d(240, 5.5e-4));
  EXPECT_EQ(problem.deviations, Eigen::Vector2d(2.7, 7.3e-6));
  EXPECT_EQ(problem.rss, 0.125);
  ASSERT_EQ(problem.data.size(), 3u);
  EXPECT_EQ(problem.data[2].y, 17.94);
  EXPECT_EQ(problem.data[2].x[0], 141.1);
  EXPECT_EQ(problem.redundancy(), 1);
}

TEST(NistReader, SaysWhereAFileIsWrongAndWhatToDo) {
  EXPECT_EQ(faultOf("Other.dat", kGood),
            "Other.dat: no model of this name; keep the name that NIST gave to the file");
  EXPECT_EQ(faultOf("Misra1a.dat", with("Lower Level", "Some")),
            "Misra1a.dat:13: no line above has the level of difficulty; take the file from NIST again");
  EXPECT_EQ(faultOf("Misra1a.dat", with("2.4E+02", "x")),
            "Misra1a.dat:7: expected 4 numbers; take the file from NIST again");
  EXPECT_EQ(faultOf("Misra1a.dat", with("14.73E0     114.9E0", "14.73E0")),
            "Misra1a.dat:12: expected 2 or 3 numbers; take the file from NIST again");
  EXPECT_EQ(
      faultOf("Misra1a.dat", with("11 to 13", "11 to 14")),
      "Misra1a.dat:13: the file ends before line 14, the last one of the data; take the file from NIST again");
  EXPECT_EQ(faultOf("Misra1a.dat", with("  3\n", "  4\n")),
            "Misra1a.dat:11: not 4 observations, as the file says above; take the file from NIST again");
}

TEST(NistReader, SaysThatThereAreNoFiles) {
  const TemporaryFolder folder;
  try {
    readProblems(folder.path());
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(),
              folder.path().string() +
                  ": no .dat files here; pass the folder with NIST's nonlinear regression data");
  }
}

}  // namespace
