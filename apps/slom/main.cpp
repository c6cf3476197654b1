// The command slom: subcommands, and how errors end.
#include <cstdio>
#include <exception>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "bundle/bundle.hpp"
#include "calibrate/calibrate.hpp"
#include "error.hpp"
#include "graph/graph.hpp"
#include "replay/replay.hpp"
#include "simulate/simulate.hpp"

namespace {

using namespace slom::app;

/// The list of subcommands shows one line of each: the one that follows the sample run, where there is one.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_subcommand(const CLI::App* sub) const override {
    std::string text = sub->get_description();
    if (const auto sample_end = text.find("\n\n"); sample_end != std::string::npos)
      text.erase(0, sample_end + 2);
    return fmt::format("  {:<28}{}\n", sub->get_name(), text.substr(0, text.find('\n')));
  }
};

/// What CLI11 ends parsing by: --help and --version; CLI::RuntimeError, by which a subcommand that has said
/// all there is to say sets the exit code; and options that are wrong.
int endParsing(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_name() == "CallForVersion") return fmt::print("{}\n", error.what()), exit_success;
  if (error.get_exit_code() == exit_success) return app.exit(error);
  if (error.get_name() == "RuntimeError") return error.get_exit_code();
  const auto subcommands = app.get_subcommands();
  const std::string command = subcommands.empty() ? "" : " " + subcommands.front()->get_name();
  std::string text = error.what();
  if (subcommands.empty() && !app.remaining().empty()) text = app.remaining().front() + " is no subcommand";
  fmt::print(stderr, "slom: {}; see slom{} --help\n", text, command);
  return exit_user_error;
}

int fail(const std::exception& error, int exit_code) {
  fmt::print(stderr, "slom: {}\n", error.what());
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "slom calibrate --camera left=left_corners.csv --camera right=right_corners.csv --json result.json\n\n"
      "Sparse least squares on manifolds: fits models to measurements and says how well it knows them.\n",
      "slom");
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_version_flag("--version", "slom " SLOM_VERSION);
  app.require_subcommand(1);
  addBundleCommand(app);
  addCalibrateCommand(app);
  addGraphCommand(app);
  addReplayCommand(app);
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
