// Programs on several processes.
#pragma once

#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/paths.hpp"
#include "support/replaced.hpp"
#include "support/run_command.hpp"

namespace slom::testing {

/// Returns the words that start a program on `processes` processes, more than there are processors.
inline std::vector<std::string> mpirun(int processes, const std::vector<std::string>& program) {
  ::setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
  ::setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  ::setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", 1);
  ::setenv("OMPI_MCA_btl_vader_single_copy_mechanism", "none", 1);
  ::setenv("OMP_NUM_THREADS", "1", 1);
  std::vector<std::string> words{SLOM_MPIRUN, "-n", std::to_string(processes)};
  words.insert(words.end(), program.begin(), program.end());
  return words;
}

/// Runs `slom` with these words on several processes.
inline CommandResult runSlom(int processes, const std::vector<std::string>& words) {
  std::vector<std::string> program{commandPath().string()};
  program.insert(program.end(), words.begin(), words.end());
  return processes == 1 ? runCommand(program) : runCommand(mpirun(processes, program));
}

/// Returns the lines of slom on standard error. Lines of mpirun are left out.
inline std::string sentencesOfSlom(const std::string& errors) {
  std::string own;
  for (std::size_t at = 0; at < errors.size();) {
    const std::size_t end = std::min(errors.find('\n', at), errors.size() - 1) + 1;
    if (errors.compare(at, 6, "slom: ") == 0) own += errors.substr(at, end - at);
    at = end;
  }
  return own;
}

}  // namespace slom::testing
