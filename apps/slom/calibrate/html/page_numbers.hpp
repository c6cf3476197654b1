// Numbers and rows of tables of the report page.
#pragma once

#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// Rounds to a few decimal places, which keeps the page small.
inline double rounded(double x, int decimals) {
  const double scale = std::pow(10, decimals);
  return std::round(x * scale) / scale;
}

/// Returns name, value, stated and clustered standard deviation, and unit, as text with a useful number of digits.
inline nlohmann::ordered_json valueRow(const std::string& name, double value, double std, double clustered,
                                       const std::string& unit) {
  const ValueText text = withStd(value, std);
  const std::string second = std > 0 && !std::isnan(clustered) ? withStd(value, clustered).std : "";
  return {name, text.value, text.std, second, unit};
}

inline void addVector(nlohmann::ordered_json& rows, const std::string& name, const vec3& value,
                      const vec3& std, const vec3& clustered, const std::string& unit) {
  for (int i = 0; i < 3; ++i)
    rows.push_back(valueRow(name + "." + "xyz"[i], value[i], std[i], clustered[i], unit));
}

}  // namespace slom::app::calib
