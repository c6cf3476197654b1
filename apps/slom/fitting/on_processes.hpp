// A run of a command on several processes. Only sources that are built with PETSc include this file.
#pragma once

#include <functional>
#include <new>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <mtk/error.hpp>
#include <slom/distributed.hpp>

#include "error.hpp"
#include "fitting/console.hpp"
#include "fitting/fit_options.hpp"
#include "fitting/result_files.hpp"
#include "fitting/run_report.hpp"
#include "printable.hpp"

namespace slom::app {

/// Runs f in all processes. The process that throws prints the sentence of its error, once, and all processes end. If
/// the others do not know of the error, they are ended at once.
void onProcesses(const std::function<void(const distributed::Processes&)>& f);

/// Returns the method of PETSc for --solver. Throws UserError.
distributed::PetscSolverOptions petscOptionsOf(const FitOptions& fit);

/// Returns the options for this process: its share of the threads of the machine.
FitOptions onThisProcess(FitOptions fit);

/// Returns the report options for this process: only the first one reports.
ReportOptions onThisProcess(const distributed::Processes& processes, ReportOptions report);

/// Throws UserError: the option is not available on several processes.
[[noreturn]] void refuseOnProcesses(const std::string& option);

/// As requireConverged(), in all processes; the first one prints.
void requireConvergedOnProcesses(const distributed::Processes& processes, const RunReport& report,
                                 const std::string& advice);

/// Writes a file in pieces that the first process gets from all. `gather(f)` calls f with them there. All processes
/// call it.
void writeInPieces(const distributed::Processes& processes, ResultFiles& files, const std::string& file,
                   const std::function<void(const distributed::TextSink&)>& gather);

/// Returns a warning for each option of PETSc that the fit has not used.
std::vector<std::string> unusedOptionsTexts();

/// Returns a line on the processes and their memory.
std::string processesText(const distributed::Processes& processes);

}  // namespace slom::app
