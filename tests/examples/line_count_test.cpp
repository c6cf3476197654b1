// The promise of the paper's abstract: the stereo + IMU calibration takes fewer than 70 lines beyond the problem itself
// (its measurement equations, camera model, data and start values).
#include <fstream>
#include <string>

#include <gtest/gtest.h>

namespace {

std::string trimmed(const std::string& line) {
  const auto first = line.find_first_not_of(" \t");
  return first == std::string::npos ? "" : line.substr(first);
}

/// Lines that are neither blank nor comment nor in the body of a measurement equation.
int countLines(const std::string& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file.good()) << path;
  int count = 0;
  bool in_equation = false;
  for (std::string line; std::getline(file, line);) {
    if (line == "}") in_equation = false;
    const std::string code = trimmed(line);
    if (!in_equation && !code.empty() && code.rfind("//", 0) != 0) ++count;
    if (line.rfind("SLOM_IMPLEMENT_MEASUREMENT", 0) == 0) in_equation = true;
  }
  return count;
}

TEST(StereoImuCalibration, TakesLessThan70LinesThatAreNotTheProblems) {
  const std::string folder = SLOM_SOURCE_DIR "/examples/stereo_imu_calibration/";
  const int lines = countLines(folder + "main.cpp") + countLines(folder + "types.hpp");
  EXPECT_LT(lines, 70);
  EXPECT_GT(lines, 50) << "the count has lost its object";
}

TEST(CircleFit, TakesFifteenLines) {
  EXPECT_LE(countLines(SLOM_SOURCE_DIR "/examples/circle_fit/main.cpp"), 15);
}

}  // namespace
