// Containers of graphs and scenes. What is accepted can be written as text.
#include <slom/io.hpp>

#include "fuzz/target.hpp"

SLOM_FUZZ_TARGET(container) {
  namespace io = slom::io;
  const MemoryFile file(input);
  const auto write = [&] { io::readAsText(io::Container(file.name()), [](std::string_view) {}); };
  const auto read = [&] {
    if (!io::isContainer(file.name())) return;
    if (io::Container(file.name()).content() == io::ContainerContent::graph) {
      static_cast<void>(io::readPoseGraph(file.name()));
    } else {
      static_cast<void>(io::readScene(file.name()));
    }
  };
  const bool is_written = accepted(write), is_read = accepted(read);
  require(is_written || !is_read || !io::isContainer(file.name()),
          "a container that is read cannot be written as text");
}
