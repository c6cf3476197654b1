// The readers of files where slom::io is not built.
#include <string>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "files.hpp"
#include "mtk/error.hpp"

namespace slom::python {

namespace {

[[noreturn]] void refuse(const std::string& file) {
  throw mtk::Error(
      "slom.no-readers",
      file +
          ": this package was built without the readers of files; install fmt, and build it with SLOM_BUILD_IO",
      file);
}

}  // namespace

void bindFiles(nanobind::module_& module) {
  module.def("_read_g2o", [](const std::string& file, const std::optional<std::string>&) { refuse(file); });
  module.def("_read_bal", [](const std::string& file) { refuse(file); });
}

}  // namespace slom::python
