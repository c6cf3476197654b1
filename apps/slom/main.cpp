// The command slom: subcommands, and the handling of errors.
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fcntl.h>
#include <memory>
#include <new>
#include <string>
#include <thread>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <mtk/error.hpp>
#include <slom/solve/instruction_set.hpp>

#include "error.hpp"
#include "help.hpp"
#include "printable.hpp"
#include "processes.hpp"

namespace slom::app {
// Each subcommand that is built adds itself.
#define SLOM_COMMAND(add) void add(CLI::App& app);
#include <commands.inc>
#undef SLOM_COMMAND
}  // namespace slom::app

namespace {

using namespace slom::app;

/// Formatter that lists each subcommand in one line: the line that follows the sample run, if there is one. It shows less usual options for --help-all
/// only.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    std::string text = make_description(app) + make_usage(app, name) + make_positionals(app);
    for (const std::string& group : app->get_groups()) {
      if (group.empty() || (group == more_options && mode != CLI::AppFormatMode::All)) continue;
      const auto is_in_group = [&](const CLI::Option* option) {
        return option->get_group() == group && option->nonpositional();
      };
      if (const auto options = app->get_options(is_in_group); !options.empty())
        text += make_group(group, false, options);
    }
    return text + make_subcommands(app, CLI::AppFormatMode::Normal) + "\n" + make_footer(app);
  }

  std::string make_subcommand(const CLI::App* sub) const override {
    std::string text = sub->get_description();
    if (const auto sample_end = text.find("\n\n"); sample_end != std::string::npos)
      text.erase(0, sample_end + 2);
    return fmt::format("  {:<28}{}\n", sub->get_name(), text.substr(0, text.find('\n')));
  }
};

/// Prints an error. Of several processes that have not begun to work together, the first one speaks for all. The others
/// give it time, because mpirun ends all processes as soon as one fails.
void sayForAll(const std::string& text) {
  if (processNumber() == 0) {
    sayError(text);
  } else {
    std::this_thread::sleep_for(std::chrono::seconds(1));
  }
}

/// Returns the exit code for an exception by which CLI11 ends parsing. There are 3 kinds: --help and --version;
/// CLI::RuntimeError, with the exit code of a subcommand that has already reported its failure; and wrong options,
/// which are reported here.
int endParsing(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_name() == "CallForVersion") return say(fmt::format("{}\n", error.what())), exit_success;
  if (error.get_exit_code() == exit_success) return app.exit(error);
  if (error.get_name() == "RuntimeError") return error.get_exit_code();
  const auto subcommands = app.get_subcommands();
  const std::string command = subcommands.empty() ? "" : " " + subcommands.front()->get_name();
  std::string text = error.what();
  if (subcommands.empty() && !app.remaining().empty())
    text = app.remaining().front() + " is not a subcommand";
  sayForAll(fmt::format("slom: {}; see slom{} --help\n", oneLine(text), command));
  return exit_user_error;
}

int fail(const std::string& sentence, int exit_code) {
  sayForAll(fmt::format("slom: {}\n", oneLine(sentence)));
  return exit_code;
}

/// Opens closed standard streams on a device on which their use fails, so that no result file takes their place.
void occupyStandardStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) == -1)
      (void)::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

/// Returns `exit_code`, unless standard output was lost.
int afterOutput(int exit_code) {
  errno = 0;
  const bool is_flushed = std::fflush(stdout) == 0;
  const int reason = is_flushed ? 0 : errno;
  if ((is_flushed && std::ferror(stdout) == 0) || exit_code != exit_success) return exit_code;
  return fail(fmt::format("standard output could not be written{}; redirect it to a writable file, or pass "
                          "--quiet",
                          reason == 0 ? "" : fmt::format(" ({})", std::strerror(reason))),
              exit_not_converged);
}

int run(CLI::App& app, int argc, char** argv) {
  try {
    requireProcesses(argc > 1 ? argv[1] : "");
    app.parse(argc, argv);
    return exit_success;
  } catch (const CLI::ParseError& error) {
    return endParsing(app, error);
  } catch (const UserError& error) {
    return fail(error.what(), exit_user_error);
  } catch (const mtk::Error& error) {
    return fail(std::string(error.sentence()), exit_user_error);
  } catch (const std::bad_alloc&) {
    return fail("not enough memory; give a smaller problem, or use more memory", exit_not_converged);
  } catch (const std::exception& error) {
    return fail(fmt::format("this is a fault of slom itself, please report it: {}", error.what()),
                exit_not_converged);
  }
}

}  // namespace

int main(int argc, char** argv) {
  occupyStandardStreams();
  prepareProcesses(argv);
  if (processNumber() > 0 && std::freopen("/dev/null", "w", stdout) == nullptr) return exit_not_converged;
  CLI::App app(
      "slom calibrate --camera left=left_corners.csv --camera right=right_corners.csv --json result.json\n\n"
      "Sparse least squares on manifolds: fit models to measurements, with the uncertainty of each value.\n",
      "slom");
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_help_flag("-h,--help", "print this help");
  app.set_version_flag(
      "--version", [] { return fmt::format("slom {}, kernels: {}", SLOM_VERSION, slom::instructionSet()); },
      "print the version and the instructions of the solver");
  app.require_subcommand(1);
#define SLOM_COMMAND(add) add(app);
#include <commands.inc>
#undef SLOM_COMMAND
  return afterOutput(run(app, argc, argv));
}
