// Numbers in YAML.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

namespace slom::app::calib {

/// Numbers in one line, each with as many digits as are needed to read the same number again.
struct YamlNumbers {
  Eigen::VectorXd values;
};
inline YamlNumbers numbers(const Eigen::VectorXd& values) { return {values}; }

inline YamlNumbers numbers(const std::vector<double>& values) {
  return {Eigen::Map<const Eigen::VectorXd>(values.data(), Eigen::Index(values.size()))};
}

inline YAML::Emitter& operator<<(YAML::Emitter& yaml, const YamlNumbers& numbers) {
  yaml << YAML::Flow << YAML::BeginSeq;
  for (const double value : numbers.values) yaml << fmt::format("{}", value);
  return yaml << YAML::EndSeq;
}

}  // namespace slom::app::calib
