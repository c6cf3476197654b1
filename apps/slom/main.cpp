// The command slom: subcommands, and how errors end.
#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "calibrate/calibrate.hpp"
#include "error.hpp"
#include "simulate/simulate.hpp"

namespace {

using namespace slom::app;

/// Prints `slom: <text>` on standard error.
int fail(const std::exception& error, int exit_code) {
  fmt::print(stderr, "slom: {}\n", error.what());
  return exit_code;
}

/// Options that CLI11 refuses, and what it reports the same way: --help, --version, and CLI::RuntimeError, by which a
/// subcommand that has said all there is to say sets the exit code.
int endParsing(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return app.exit(error);
  if (error.get_name() == "RuntimeError") return error.get_exit_code();
  fail(error, exit_user_error);
  fmt::print(stderr, "Run `slom --help` or `slom SUBCOMMAND --help` for the options.\n");
  return exit_user_error;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "slom calibrate --camera left=left_corners.csv --camera right=right_corners.csv --json result.json\n\n"
      "Sparse least squares on manifolds: fits models to measurements and says how well it knows them.",
      "slom");
  app.set_version_flag("--version", "slom " SLOM_VERSION);
  app.require_subcommand(1);
  addCalibrateCommand(app);
  addSimulateCommand(app);
  try {
    app.parse(argc, argv);
    return exit_success;
  } catch (const CLI::ParseError& error) {
    return endParsing(app, error);
  } catch (const UserError& error) {
    return fail(error, exit_user_error);
  } catch (const std::exception& error) {
    return fail(error, exit_not_converged);
  }
}
