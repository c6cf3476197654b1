// What the calibration knows of a camera model: the entries of the list.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "slom/calibration/calibrate.hpp"
#include "slom/calibration/comparison.hpp"
#include "slom/calibration/models.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

class Lens;

struct ModelDefinition {
  using Numbers = std::vector<double>;
  using ForOther = std::optional<ForeignLens> (*)(const Numbers& parameters);

  std::string name;
  std::vector<std::string> parameters;
  std::vector<int> held_near_zero;  ///< parameters of the prior Settings::sigma_denominator
  bool is_compared;                 ///< it is in comparedModels()

  Result (*calibrate)(const Dataset&, const Settings&, const Progress&);
  Result (*calibrate_from)(const Result& start, const Dataset&, const Settings&);
  ModelTrial (*try_model)(const Dataset&, const Settings&);
  std::unique_ptr<Lens> (*make_lens)(const Numbers& parameters);
  ForOther for_opencv, for_ros, for_kalibr;
};

}  // namespace slom::calibration
