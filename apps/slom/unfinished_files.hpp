// Files under temporary names, which are removed also where a signal ends the program.
#pragma once

#include <filesystem>

namespace slom::app {

/// From now on the file is removed when SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGQUIT, SIGALRM, SIGUSR1, SIGUSR2,
/// SIGXCPU or SIGXFSZ ends the program, if it is there. To be called before it is made. Signals that were
/// ignored stay so.
void expectUnfinished(const std::filesystem::path& file);
/// The file has another name now, or is gone.
void forgetUnfinished(const std::filesystem::path& file);
/// Removes it, and forgets it.
void removeUnfinished(const std::filesystem::path& file);

}  // namespace slom::app
