// What the page of a report shows, as JSON inside its <script type="application/json">.
#pragma once

#include <string>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// Where there are many corners, images or parameters, the data contain only as many as can be drawn, and the page says so.
std::string pageData(const Dataset& data, const Result& result);

}  // namespace slom::app::calib
