#pragma once
// The folder for the files of a simulated device.

#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "error.hpp"

namespace slom::app {

/// Creates the folder given by --output if it does not exist. Throws UserError if it cannot be made.
inline void makeFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder)) {
    throw UserError(fmt::format("cannot make the folder {}: {}; give --output a folder that can be written",
                                folder.string(), error ? error.message() : "something else has this name"));
  }
}

}  // namespace slom::app
