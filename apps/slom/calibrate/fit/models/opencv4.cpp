#include "calibrate/fit/calibrate_model.hpp"

namespace slom::app::calib {

template Result calibrateModel<Opencv4<>>(const Dataset&, const Settings&, const Progress&);
template Result calibrateModelFrom<Opencv4<>>(const Result&, const Dataset&, const Settings&);
template ModelTrial tryModel<Opencv4<>>(const Dataset&, const Settings&);

}  // namespace slom::app::calib
