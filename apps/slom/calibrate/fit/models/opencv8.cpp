#include "calibrate/fit/calibrate_model.hpp"

namespace slom::app::calib {

template Result calibrateModel<Opencv8<>>(const Dataset&, const Settings&, const Progress&);
template ModelTrial tryModel<Opencv8<>>(const Dataset&, const Settings&);

}  // namespace slom::app::calib
