// Report on the tests of all measurements: ranking and text.
#include <algorithm>
#include <ostream>

#include "analyze/residual_tests.hpp"
#include "analyze/singular.hpp"
#include "base/classic_numbers.hpp"
#include "base/words.hpp"

namespace slom {

namespace {

std::string row(const MeasurementCheck& check) {
  const ClassicNumbers points;
  char text[200];
  std::snprintf(text, sizeof text, "  %-24s %9.3g %11.3g %10.3g %7.3g %11.2g %9.3g%s%s\n",
                check.measurement.c_str(), check.residual, check.studentized, check.redundancy, check.weight,
                check.probability, check.effect, check.is_suspect ? "  suspect" : "",
                check.isHardlyCheckable() ? "  hardly checkable" : "");
  return text;
}

std::string header() {
  char text[160];
  std::snprintf(text, sizeof text, "  %-24s %9s %11s %10s %7s %11s %9s\n", "measurement", "residual",
                "studentized", "redundancy", "weight", "probability", "effect");
  return text;
}

/// Lists measurements that the others hardly check; residuals say nothing about them.
std::string hardlyCheckableText(const OutlierReport& report) {
  std::vector<MeasurementCheck> all;
  for (const GroupCheck& group : report.groups)
    all.insert(all.end(), group.least_checkable.begin(), group.least_checkable.end());
  if (all.empty()) return "";
  std::ranges::stable_sort(all, lessCheckable);
  std::vector<std::string> names;
  for (const MeasurementCheck& check : all)
    names.push_back(check.measurement + " (" + number(check.redundancy, 2) + ")");
  const int count = report.hardlyCheckable();
  const auto shown = std::min<std::size_t>(names.size(), 6);
  names.resize(shown);
  if (count > static_cast<int>(shown))
    names.push_back(std::to_string(count - static_cast<int>(shown)) + " more");
  return "hardly checkable, with a redundancy below " + number(kHardlyCheckable) + ": " +
         listed(names, names.size()) + "; an error in " + (count == 1 ? "it" : "them") +
         " hardly shows in the residuals, so measure the same in another way\n";
}

}  // namespace

bool lessProbable(const MeasurementCheck& a, const MeasurementCheck& b) {
  return a.probability != b.probability ? a.probability < b.probability : a.studentized > b.studentized;
}
bool lessCheckable(const MeasurementCheck& a, const MeasurementCheck& b) {
  return a.redundancy < b.redundancy;
}

int OutlierReport::suspects() const {
  int sum = 0;
  for (const GroupCheck& group : groups) sum += group.suspects;
  return sum;
}

int OutlierReport::hardlyCheckable() const {
  int sum = 0;
  for (const GroupCheck& group : groups) sum += group.hardly_checkable;
  return sum;
}

std::vector<MeasurementCheck> OutlierReport::ranking() const {
  std::vector<MeasurementCheck> all;
  for (const GroupCheck& group : groups) all.insert(all.end(), group.worst.begin(), group.worst.end());
  std::ranges::stable_sort(all, lessProbable);
  return all;
}

std::string OutlierReport::text() const {
  const ClassicNumbers points;
  std::string all = unconvergedLine(unconverged) + (noise.empty() ? "" : noise + "\n");
  char line[200];
  for (const GroupCheck& group : groups) {
    std::snprintf(line, sizeof line,
                  "%s: %s, chi-square %.6g where %.6g is expected (probability %.2g), %s\n",
                  group.name.c_str(), counted(group.measurements, "measurement").c_str(), group.chi2,
                  group.redundancy, group.probability, counted(group.suspects, "suspect").c_str());
    all += line + header();
    for (const MeasurementCheck& check : group.worst) all += row(check);
  }
  if (groups.size() > 1) {
    std::size_t most = 0;
    for (const GroupCheck& group : groups) most = std::max(most, group.worst.size());
    std::vector<MeasurementCheck> worst = ranking();
    worst.resize(std::min(most, worst.size()));
    all += "ranking over all measurements\n" + header();
    for (const MeasurementCheck& check : worst) all += row(check);
  }
  return all + hardlyCheckableText(*this);
}

std::ostream& operator<<(std::ostream& os, const OutlierReport& report) { return os << report.text(); }

}  // namespace slom
