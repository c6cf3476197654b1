// The page around the data: page.html with its style and scripts inserted. cmake/embed_page.cmake turns it into a
// string.
#pragma once

#include <string_view>

namespace slom::app::calib {

/// The template. It holds `@data@` in place of the data.
extern const std::string_view page_template;

}  // namespace slom::app::calib
