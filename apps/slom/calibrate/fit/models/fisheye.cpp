#include "calibrate/fit/calibrate_model.hpp"

namespace slom::app::calib {

template Result calibrateModel<Fisheye<>>(const Dataset&, const Settings&, const Progress&);
template Result calibrateModelFrom<Fisheye<>>(const Result&, const Dataset&, const Settings&);
template ModelTrial tryModel<Fisheye<>>(const Dataset&, const Settings&);

}  // namespace slom::app::calib
