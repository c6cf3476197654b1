/// The linear solvers of the library by name, for programs whose users choose one, like the option `--solver` of slom.
///
///     if (const slom::NamedSolver* found = slom::solverNamed("qr")) est.changeSolver(found->make());
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "slom/solve/linear_solver.hpp"

namespace slom {

/// A linear solver with the name by which users of a program choose it.
struct NamedSolver {
  const char* name;                         ///< `qr`
  const char* description;                  ///< a few words for help texts
  std::unique_ptr<LinearSolver> (*make)();  ///< with default options
  const char* missing = nullptr;            ///< what this build lacks, so make() throws; null: nothing
};

/// Returns the solvers that this build can make. The first one is the default of the Estimator.
std::span<const NamedSolver> solvers();
/// Returns the solver of this name; null if there is none. If this build cannot make it, its `missing` says why.
const NamedSolver* solverNamed(std::string_view name);

}  // namespace slom
