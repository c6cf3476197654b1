#include "slom/analyze/variance_components.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <ostream>

#include "base/classic_numbers.hpp"
#include "base/words.hpp"
#include "slom/analyze/chi_square.hpp"

namespace slom {

std::pair<double, double> VarianceComponent::interval(double probability) const {
  if (!(probability > 0 && probability < 1)) {
    throw Error("slom.bad-option",
                "the probability of an interval is " + number(probability, 6) +
                    "; pass a number between 0 and 1, such as 0.95",
                "probability");
  }
  if (!(dof > 0)) return {0, std::numeric_limits<double>::infinity()};
  const double tail = (1 - probability) / 2, square = dof * factor * factor;
  return {std::sqrt(square / chiSquareCritical(tail, dof)),
          std::sqrt(square / chiSquareCritical(1 - tail, dof))};
}

double VarianceComponents::correlation(int i, int j) const {
  const std::size_t n = components.size(),
                    place = static_cast<std::size_t>(i) * n + static_cast<std::size_t>(j);
  return place < correlations.size() ? correlations[place] : 0;
}

const VarianceComponent& VarianceComponents::at(std::string_view name) const {
  std::vector<std::string> names;
  for (const VarianceComponent& component : components) {
    if (component.name == name) return component;
    names.push_back(component.name);
  }
  throw Error("slom.no-component",
              "there is no variance component " + std::string(name) + "; there are " + listed(names, 8),
              std::string(name));
}

std::string VarianceComponents::report() const {
  const ClassicNumbers points;
  std::size_t width = 9;
  for (const VarianceComponent& component : components) width = std::max(width, component.name.size());
  std::string text = (converged ? "Converged: " : "NOT converged: ") + message + "\n";
  const auto line = [&](std::string name, const char* numbers) {
    name.resize(width, ' ');
    text += "  " + name + numbers;
  };
  char numbers[120];
  std::snprintf(numbers, sizeof numbers, " %9s %11s %10s  %s\n", "residuals", "redundancy", "dof",
                "sigma over stated");
  line("kind", numbers);
  for (const VarianceComponent& one : components) {
    const std::string factor = one.is_estimated
                                   ? number(one.factor, 4) + " +- " + number(one.standard_deviation, 2)
                                   : number(one.factor) + (one.is_shared ? "" : " as stated");
    std::snprintf(numbers, sizeof numbers, " %9d %11s %10s  %s\n", one.residuals,
                  number(one.redundancy, 4).c_str(), number(one.dof).c_str(), factor.c_str());
    line(one.name, numbers);
  }
  for (const std::string& note : notes) text += "  note: " + note + "\n";
  return text;
}

std::ostream& operator<<(std::ostream& os, const VarianceComponents& components) {
  return os << components.report();
}

}  // namespace slom
