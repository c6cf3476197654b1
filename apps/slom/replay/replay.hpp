// `slom replay`: fits a problem that a program saved.
#pragma once

#include <CLI/CLI.hpp>

namespace slom::app {

void addReplayCommand(CLI::App& app);

}  // namespace slom::app
