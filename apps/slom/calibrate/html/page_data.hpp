// What the page of a report shows, as JSON inside its <script type="application/json">.
#pragma once

#include <string>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// Of many corners, images and parameters only as many are there as can be drawn; the page says so.
std::string pageData(const Dataset& data, const Result& result);

}  // namespace slom::app::calib
