// Data inside a page.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace slom::app {

/// Returns JSON that is safe inside <script>, where "</" would end the element.
std::string scriptText(const nlohmann::ordered_json& json);

}  // namespace slom::app
