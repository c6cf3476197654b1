// Files under temporary names, which are removed even if a signal ends the program.
#pragma once

#include <filesystem>

namespace slom::app {

/// Registers a file for removal if SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGQUIT, SIGALRM, SIGUSR1, SIGUSR2, SIGXCPU or
/// SIGXFSZ ends the program. Call it before the file is made; a missing file is no error. Ignored signals stay ignored.
void expectUnfinished(const std::filesystem::path& file);
/// Forgets a file that has another name now, or is gone.
void forgetUnfinished(const std::filesystem::path& file);
/// Removes and forgets a file.
void removeUnfinished(const std::filesystem::path& file);

}  // namespace slom::app
