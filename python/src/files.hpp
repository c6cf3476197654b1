// Readers of the files of other programs.
#pragma once

#include <nanobind/nanobind.h>

namespace slom::python {

/// Declares _read_g2o and _read_bal, whose arrays python/slom/_files.py makes objects of.
void bindFiles(nanobind::module_& module);

}  // namespace slom::python
