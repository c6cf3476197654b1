#include "words.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

namespace slom::python {

std::string inWords(const std::string& message) {
  namespace nb = nanobind;
  return nb::cast<std::string>(nb::module_::import_("slom._words").attr("in_python")(message));
}

std::vector<std::string> inWords(std::vector<std::string> messages) {
  for (std::string& message : messages) message = inWords(message);
  return messages;
}

}  // namespace slom::python
