// Several processes that were started together, without what they need.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "support/paths.hpp"
#include "support/run_command.hpp"

namespace slom::app {
namespace {

using slom::testing::CommandResult;

/// Returns whether slom-mpi was built, too.
bool hasMpi() { return std::filesystem::exists(slom::testing::commandPath().parent_path() / "slom-mpi"); }

/// Runs slom as process `number` of two.
CommandResult runAs(const std::string& number, const std::string& subcommand) {
  return slom::testing::runCommand({"env", "OMPI_COMM_WORLD_SIZE=2", "OMPI_COMM_WORLD_RANK=" + number,
                                    slom::testing::commandPath().string(), subcommand, "map.g2o"});
}

TEST(ProcessesOfTheCommand, AreRefusedOnceWithoutPetsc) {
  if (hasMpi()) GTEST_SKIP() << "this build has PETSc";
  for (const char* const subcommand : {"graph", "bundle", "calibrate"}) {
    const CommandResult first = runAs("0", subcommand), second = runAs("1", subcommand);
    EXPECT_EQ(
        first.errors,
        "slom: 2 processes were started, but this slom was built without PETSc; start one, or build with "
        "-DSLOM_WITH_PETSC=ON (Debian: libpetsc-real-dev, libopenmpi-dev)\n");
    EXPECT_EQ(first.exit_code, 2);
    EXPECT_EQ(second.errors, "");
    EXPECT_EQ(second.exit_code, 2);
  }
}

TEST(ProcessesOfTheCommand, AreRefusedWhereOneWorks) {
  if (!hasMpi()) GTEST_SKIP() << "this build has no PETSc";
  EXPECT_EQ(runAs("0", "calibrate").errors,
            "slom: 2 processes were started, but slom calibrate works in one; start it without mpirun\n");
  EXPECT_EQ(runAs("1", "calibrate").errors, "");
}

}  // namespace
}  // namespace slom::app
