#include "calibrate/fit/calibrate_model.hpp"

namespace slom::app::calib {

template Result calibrateModel<Opencv8<>>(const Dataset&, const Settings&, const Progress&);
template Result calibrateModelFrom<Opencv8<>>(const Result&, const Dataset&, const Settings&);
template ModelTrial tryModel<Opencv8<>>(const Dataset&, const Settings&);

}  // namespace slom::app::calib
