// `slom graph` on several processes.
#pragma once

#include "fitting/run_report.hpp"
#include "graph/settings.hpp"

namespace slom::app::graph {

/// Fits the graph of a file together with the other processes that were started; each reads and fits a part. Throws
/// UserError for options that need the whole graph.
void runOnProcesses(const Settings& settings, const Stopwatch& total);

/// This function in slom-mpi; null in slom.
inline void (*run_on_processes)(const Settings&, const Stopwatch&) = nullptr;

}  // namespace slom::app::graph
