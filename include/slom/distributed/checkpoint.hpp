/// Checkpoint: values of a fit on several processes in a folder.
#pragma once

#include <string>
#include <utility>

#include "slom/distributed/processes.hpp"
#include "slom/io/checkpoint.hpp"

namespace slom::distributed {

/// io::Checkpoint for all processes of the Session. A single process can go on from it, too.
class Checkpoint : public io::Checkpoint {
 public:
  /// Uses a folder. Refers to `processes`, which must outlive this object.
  Checkpoint(const Processes& processes, std::string folder, Problem problem)
      : io::Checkpoint(processes, processes.rank(), processes.size(), std::move(folder), std::move(problem)) {
  }
};

}  // namespace slom::distributed
