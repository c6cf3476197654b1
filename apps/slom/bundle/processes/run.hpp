// `slom bundle` on several processes.
#pragma once

#include "bundle/settings.hpp"
#include "fitting/run_report.hpp"

namespace slom::app::bundle {

/// Fits the scene of a file together with the other processes that were started; each reads and fits a part.
void runOnProcesses(const Settings& settings, const Stopwatch& total);

/// This function in slom-mpi; null in slom.
inline void (*run_on_processes)(const Settings&, const Stopwatch&) = nullptr;

}  // namespace slom::app::bundle
