// The forms of the lines of a graph.
#pragma once

#include <string_view>
#include <vector>

namespace slom::io::g2o {

/// The form of a line. After the tag come `ids` ids, then numbers, in all `words` words. `form` shows an example. A FIX
/// line may have more ids.
struct LineForm {
  std::string_view name;
  int ids = 0;
  int words = 0;
  const char* form = "";
};

/// Returns the forms of all known tags.
std::vector<LineForm> lineForms();

}  // namespace slom::io::g2o
