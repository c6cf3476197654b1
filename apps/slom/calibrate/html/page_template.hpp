// The page around the data: page.html with its style and scripts put in, which cmake/embed_page.cmake makes a
// string of.
#pragma once

#include <string_view>

namespace slom::app::calib {

/// Holds `@data@` where the data belong.
extern const std::string_view page_template;

}  // namespace slom::app::calib
