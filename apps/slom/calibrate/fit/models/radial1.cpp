#include "calibrate/fit/calibrate_model.hpp"

namespace slom::app::calib {

template Result calibrateModel<Radial1<>>(const Dataset&, const Settings&, const Progress&);
template ModelTrial tryModel<Radial1<>>(const Dataset&, const Settings&);

}  // namespace slom::app::calib
