// The first step of slom: if several processes were started, slom-mpi takes its place.
#include <filesystem>
#include <system_error>
#include <unistd.h>

#include "processes.hpp"

namespace slom::app {

void prepareProcesses(char** argv) {
  if (processCount() == 1) return;
  std::error_code error;
  const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error) ::execv((own.parent_path() / "slom-mpi").c_str(), argv);
  // There is none, and requireProcesses() says so.
}

}  // namespace slom::app
