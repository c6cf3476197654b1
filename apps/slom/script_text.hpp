// Data inside a page.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace slom::app {

/// JSON as it may stand inside <script>, where "</" would end it.
std::string scriptText(const nlohmann::ordered_json& json);

}  // namespace slom::app
