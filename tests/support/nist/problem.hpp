/// Problems of nonlinear regression with certified answers: NIST Statistical Reference Datasets,
/// www.itl.nist.gov/div898/strd.
///
/// The first lines of a file state the places of its parts, as in `Certified Values  (lines 41 to 48)`. The parts are
///   a line for each parameter   b1 = 500  250  2.3894212918E+02  2.7070075241E+00
///                               (two starts, the certified value, its standard deviation)
///   the certified residual sum of squares, degrees of freedom and number of observations
///   a line for each datum       y x, in one file y x1 x2
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "support/nist/models.hpp"

namespace slom::testing::nist {

struct Datum {
  double y = 0;  ///< as the model predicts it: for Nelson the logarithm of what the file says
  Predictors x{};
};

struct Problem {
  std::string name;        ///< `Misra1a`
  std::string difficulty;  ///< according to NIST: `Lower`, `Average` or `Higher`
  Model model{};
  std::array<Eigen::VectorXd, 2> starts;
  Eigen::VectorXd parameters, deviations;  ///< certified, 11 digits
  double rss = 0;                          ///< certified
  std::vector<Datum> data;

  int redundancy() const { return static_cast<int>(data.size()) - static_cast<int>(parameters.size()); }
};

/// Reads one file. Throws std::runtime_error, a sentence with file, line and remedy.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file.string()) {
    std::ifstream stream(file);
    if (!stream)
      throw std::runtime_error(file_ + ": cannot be read; pass a .dat file of NIST's nonlinear regression");
    for (std::string line; std::getline(stream, line);) lines_.push_back(line);
    problem_.name = file.stem().string();
    const std::optional<Model> model = modelOf(problem_.name);
    if (!model)
      throw std::runtime_error(file_ + ": no model of this name; keep the name that NIST gave to the file");
    problem_.model = *model;
  }

  Problem read() {
    problem_.difficulty =
        headed("the level of difficulty", R"(^\s*(Lower|Average|Higher) Level of Difficulty)")[1];
    readParameters();
    problem_.rss = number(headed("the residual sum of squares", R"(^Residual Sum of Squares:\s*(.*))"));
    readData(number(headed("the number of observations", R"(^Number of Observations:\s*(.*))")));
    return std::move(problem_);
  }

 private:
  static constexpr std::size_t kHeader = 60;  // lines

  [[noreturn]] void fail(std::size_t line, const std::string& fault) const {
    throw std::runtime_error(file_ + ":" + std::to_string(line) + ": " + fault +
                             "; take the file from NIST again");
  }

  /// Returns the text in the parentheses of this pattern in a line of the header; [0]: the number of the line, from 1.
  std::vector<std::string> headed(const std::string& what, const std::string& pattern) const {
    const std::regex regex(pattern);
    const std::size_t end = std::min(kHeader, lines_.size());
    for (std::size_t i = 0; i < end; ++i) {
      std::smatch match;
      if (!std::regex_search(lines_[i], match, regex)) continue;
      std::vector<std::string> result{std::to_string(i + 1)};
      for (std::size_t k = 1; k < match.size(); ++k) result.push_back(match[k]);
      return result;
    }
    fail(end, "no line above has " + what);
  }

  /// First and last line of a part, from 1.
  std::pair<std::size_t, std::size_t> part(const std::string& title, const std::string& what) const {
    const auto found = headed("the lines of " + what, title + R"(\s*\(lines\s+(\d{1,6})\s+to\s+(\d{1,6})\))");
    const std::size_t line = std::stoul(found[0]), first = std::stoul(found[1]), last = std::stoul(found[2]);
    if (first < 1 || first > last) fail(line, "there are no lines from " + found[1] + " to " + found[2]);
    if (last > lines_.size())
      fail(lines_.size(), "the file ends before line " + found[2] + ", the last one of " + what);
    return {first, last};
  }

  std::vector<double> numbers(std::size_t line, const std::string& text, std::size_t least,
                              std::size_t most) const {
    std::istringstream stream(text);
    std::vector<double> result;
    for (double x; stream >> x;) result.push_back(x);
    if (!stream.eof() || result.size() < least || result.size() > most) {
      const std::string count = std::to_string(least) + (most > least ? " or " + std::to_string(most) : "");
      fail(line, "expected " + count + (most > 1 ? " numbers" : " number"));
    }
    return result;
  }
  double number(const std::vector<std::string>& found) const {
    return numbers(std::stoul(found[0]), found[1], 1, 1)[0];
  }

  void readParameters() {
    const auto [first, last] = part("Starting Values", "the starts");
    const auto n = static_cast<Eigen::Index>(last - first + 1);
    for (Eigen::VectorXd* v :
         {&problem_.starts[0], &problem_.starts[1], &problem_.parameters, &problem_.deviations})
      v->resize(n);
    for (std::size_t line = first; line <= last; ++line) {
      const std::string& text = lines_[line - 1];
      const std::vector<double> row = numbers(line, text.substr(text.find('=') + 1), 4, 4);
      const auto i = static_cast<Eigen::Index>(line - first);
      problem_.starts[0][i] = row[0];
      problem_.starts[1][i] = row[1];
      problem_.parameters[i] = row[2];
      problem_.deviations[i] = row[3];
    }
  }

  void readData(double count) {
    const auto [first, last] = part("Data:?", "the data");
    if (static_cast<double>(last - first + 1) != count) {
      fail(first, "not " + std::to_string(std::lround(count)) + " observations, as the file says above");
    }
    for (std::size_t line = first; line <= last; ++line) {
      const std::vector<double> row = numbers(line, lines_[line - 1], 2, 3);
      const double y = predictsLogarithm(problem_.model) ? std::log(row[0]) : row[0];
      problem_.data.push_back({y, {row[1], row.size() > 2 ? row[2] : 0}});
    }
  }

  std::string file_;
  std::vector<std::string> lines_;
  Problem problem_;
};

inline Problem readProblem(const std::filesystem::path& file) { return Reader(file).read(); }

/// Reads all .dat files of a folder, in the order of their names. Throws if there are none.
inline std::vector<Problem> readProblems(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(folder)) {
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() == ".dat") files.push_back(entry.path());
    }
  }
  if (files.empty()) {
    throw std::runtime_error(folder.string() +
                             ": no .dat files here; pass the folder with NIST's nonlinear regression data");
  }
  std::sort(files.begin(), files.end());
  std::vector<Problem> problems;
  for (const auto& file : files) problems.push_back(readProblem(file));
  return problems;
}

}  // namespace slom::testing::nist
