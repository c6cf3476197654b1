/// The linear solvers of the library by name, for programs whose users choose one, as those of the command do by `--solver`.
///
///     if (const slom::NamedSolver* found = slom::solverNamed("qr")) est.changeSolver(found->make());
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "slom/solve/linear_solver.hpp"

namespace slom {

/// A linear solver that users of a program choose by its name.
struct NamedSolver {
  const char* name;                         ///< `qr`
  const char* description;                  ///< what it is, in a few words
  std::unique_ptr<LinearSolver> (*make)();  ///< with default options
  const char* missing = nullptr;            ///< what this build lacks, so that make() throws; null: nothing
};

/// The solvers that this build can make. The first one is the default of the Estimator.
std::span<const NamedSolver> solvers();
/// Also one that this build cannot make, whose `missing` says why. Null: there is none of this name.
const NamedSolver* solverNamed(std::string_view name);

}  // namespace slom
