#pragma once
// Paths of the source tree, the public data sets and the built command.

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

namespace slom::testing {

/// A file or folder of the source tree, e.g. sourcePath("data/opencv_stereo/left_corners.csv").
inline std::filesystem::path sourcePath(const std::string& relative) {
  return std::filesystem::path(SLOM_SOURCE_DIR) / relative;
}

/// Returns a file or folder of the public data sets, which are not part of the project and may be absent.
inline std::filesystem::path sharedDataPath(const std::string& relative) {
  return std::filesystem::path(SLOM_SHARED_DATA_DIR) / relative;
}

#ifdef SLOM_COMMAND
/// Returns the built command slom, or the one named by the environment variable SLOM_COMMAND: another build's.
inline std::filesystem::path commandPath() {
  const char* other = std::getenv("SLOM_COMMAND");
  return other ? other : SLOM_COMMAND;
}
#endif

}  // namespace slom::testing

/// Skips the test, with the reason, if the public data set is absent.
#define SLOM_SKIP_WITHOUT_SHARED_DATA(relative)                                             \
  if (!std::filesystem::exists(::slom::testing::sharedDataPath(relative)))                  \
  GTEST_SKIP() << "needs the public data set " << ::slom::testing::sharedDataPath(relative) \
               << "; set SLOM_TEST_DATA_DIR to the folder that holds it"
