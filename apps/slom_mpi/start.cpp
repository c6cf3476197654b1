// The first step of slom-mpi: gives the subcommands their functions for several processes.
#include "bundle/processes/run.hpp"
#include "graph/processes/run.hpp"
#include "processes.hpp"

namespace slom::app {

void prepareProcesses(char**) {
  can_use_processes = true;
  bundle::run_on_processes = &bundle::runOnProcesses;
  graph::run_on_processes = &graph::runOnProcesses;
}

}  // namespace slom::app
