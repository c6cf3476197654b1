#include "calibrate/fit/calibrate_model.hpp"

namespace slom::app::calib {

template Result calibrateModel<Radial1<>>(const Dataset&, const Settings&, const Progress&);
template Result calibrateModelFrom<Radial1<>>(const Result&, const Dataset&, const Settings&);
template ModelTrial tryModel<Radial1<>>(const Dataset&, const Settings&);

}  // namespace slom::app::calib
