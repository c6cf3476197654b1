#include "processes.hpp"

#include <algorithm>
#include <cstdlib>
#include <initializer_list>

#include <fmt/format.h>

#include "error.hpp"

namespace slom::app {

namespace {

/// Returns the first of these environment variables that is a whole number from 0 on; `otherwise` if none is.
int numberIn(std::initializer_list<const char*> names, int otherwise) {
  for (const char* const name : names) {
    const char* const text = std::getenv(name);
    if (text == nullptr || *text == '\0') continue;
    char* end = nullptr;
    const long value = std::strtol(text, &end, 10);
    if (*end == '\0' && value >= 0 && value < 1'000'000'000) return int(value);
  }
  return otherwise;
}

}  // namespace

int processCount() {
  // Open MPI; MPICH, Intel MPI and PMI; MVAPICH2; Slurm's srun
  return std::max(
      1, numberIn({"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE", "SLURM_STEP_NUM_TASKS"}, 1));
}

int processNumber() {
  return processCount() == 1
             ? 0
             : numberIn({"OMPI_COMM_WORLD_RANK", "PMI_RANK", "MV2_COMM_WORLD_RANK", "SLURM_PROCID"}, 0);
}

int processCountOfMachine() {
  return std::clamp(
      numberIn({"OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS", "MV2_COMM_WORLD_LOCAL_SIZE"}, 1), 1,
      processCount());
}

void requireProcesses(const std::string& subcommand) {
  if (processCount() == 1) return;
  if (!can_use_processes) {
    throw UserError(fmt::format(
        "{} processes were started, but this slom was built without PETSc; start one, or build with "
        "-DSLOM_WITH_PETSC=ON (Debian: libpetsc-real-dev, libopenmpi-dev)",
        processCount()));
  }
  if (!subcommand.empty() && subcommand.front() != '-' && subcommand != "graph" && subcommand != "bundle") {
    throw UserError(
        fmt::format("{} processes were started, but slom {} works in one; start it without mpirun",
                    processCount(), subcommand));
  }
}

}  // namespace slom::app
