// A pose graph as a page on which it can be turned.
#pragma once

#include <string>

#include "graph/output/sketch.hpp"

namespace slom::app::graph {

/// Returns a self-contained file: data, style and program (html_page.hpp). Mouse, touch and keys turn, shift and zoom.
std::string toHtml(const Sketch& sketch);

}  // namespace slom::app::graph
