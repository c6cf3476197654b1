// Bundle adjustments as containers and as text.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "slom/io/container.hpp"

namespace slom::io::bal {

void writeContainer(const std::string& text_file, int descriptor, const std::string& name);
void readAsText(const Container& container, const std::function<void(std::string_view)>& f);

}  // namespace slom::io::bal
