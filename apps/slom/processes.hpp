// The processes that mpirun or srun has started together.
#pragma once

#include <string>

namespace slom::app {

/// Returns how many processes run this command together, as the program that started them says; 1: this one alone.
int processCount();
/// Returns the number of this process among them, from 0.
int processNumber();
/// Returns how many of them are on this machine.
int processCountOfMachine();

/// True in slom-mpi, which can run as several processes; false in slom, which runs as one.
inline bool can_use_processes = false;

/// Prepares for the processes. In slom, lets slom-mpi, if it is in the same folder, take the place of this program if
/// several processes were started. In slom-mpi, sets can_use_processes and the functions of the subcommands.
void prepareProcesses(char** argv);

/// Throws UserError if several processes were started and this program was built without PETSc, or if the subcommand
/// works in one process alone. `subcommand`: the first word after `slom`; empty: none.
void requireProcesses(const std::string& subcommand);

}  // namespace slom::app
