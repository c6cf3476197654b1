#include <algorithm>
#include <chrono>
#include <string_view>
#include <thread>
#include <utility>

#include "fitting/on_processes.hpp"
#include "fitting/result_files.hpp"
#include "processes.hpp"

namespace slom::app {

namespace {

/// Prints the error that is being handled, as main() does, and returns the exit code.
int sayCurrentError() {
  const auto say = [](std::string_view sentence, int code) {
    sayError(fmt::format("slom: {}\n", oneLine(std::string(sentence))));
    return code;
  };
  try {
    throw;
  } catch (const UserError& error) {
    return say(error.what(), exit_user_error);
  } catch (const mtk::Error& error) {
    return say(error.sentence(), exit_user_error);
  } catch (const std::bad_alloc&) {
    return say("not enough memory; give a smaller problem, or use more processes or memory",
               exit_not_converged);
  } catch (const std::exception& error) {
    return say(fmt::format("this is a fault of slom itself, please report it: {}", error.what()),
               exit_not_converged);
  }
}

}  // namespace

void onProcesses(const std::function<void(const distributed::Processes&)>& f) {
  int code = exit_success;
  {
    const distributed::Session session;
    const distributed::Processes processes;
    try {
      f(processes);
    } catch (const CLI::RuntimeError& error) {  // in all processes, and the first has said why
      code = error.get_exit_code();
    } catch (...) {
      const bool is_known = distributed::Processes::haveAgreedOnError();
      const int from = distributed::Processes::processOfError();
      // An error that the processes have not agreed on may be that of all. The first one to end ends them all.
      if (!is_known) std::this_thread::sleep_for(std::chrono::milliseconds(300) * processes.rank());
      if (!is_known || from == processes.rank()) code = sayCurrentError();
      if (!is_known) distributed::Processes::end(code);
      code = std::stoi(processes.broadcast(std::to_string(code), from));
    }
    processes.wait();
  }
  if (code != exit_success) throw CLI::RuntimeError(code);
}

distributed::PetscSolverOptions petscOptionsOf(const FitOptions& fit) {
  using distributed::PetscMethod;
  const std::string_view name = fit.solver.name;
  if (name == "auto") return {};
  if (name == "cholesky") return {.method = PetscMethod::cholesky};
  if (name == "cg") return {.method = PetscMethod::block_jacobi};
  throw UserError(
      fmt::format("--solver {}: works in one process alone; give auto, cholesky or cg, or PETSc's own "
                  "options in PETSC_OPTIONS",
                  name));
}

FitOptions onThisProcess(FitOptions fit) {
  if (fit.threads == 0)
    fit.threads = std::max(1, int(std::thread::hardware_concurrency()) / processCountOfMachine());
  return fit;
}

ReportOptions onThisProcess(const distributed::Processes& processes, ReportOptions report) {
  if (processes.rank() > 0) report = {"", true};
  return report;
}

void refuseOnProcesses(const std::string& option) {
  throw UserError(option + ": not available on several processes; drop it, or start one process");
}

void requireConvergedOnProcesses(const distributed::Processes& processes, const RunReport& report,
                                 const std::string& advice) {
  try {
    if (processes.rank() == 0) requireConverged(report, advice);
  } catch (const CLI::RuntimeError&) {
    processes.wait();  // so that no process ends before the sentence is printed
    throw;
  }
  processes.wait();
  if (!report.summary.converged) throw CLI::RuntimeError(exit_not_converged);
}

void writeInPieces(const distributed::Processes& processes, ResultFiles& files, const std::string& file,
                   const std::function<void(const distributed::TextSink&)>& gather) {
  const auto inFirst = [&](const auto& f) {
    processes.agree([&] {
      if (processes.rank() == 0) f();
    });
  };
  inFirst([&] { files.begin(file); });
  if (!files.isWanted(file)) return;
  gather([&](std::string_view piece) { files.append(piece); });
  inFirst([&] { files.end(); });
}

std::vector<std::string> unusedOptionsTexts() {
  std::vector<std::string> texts;
  for (const std::string& option : distributed::Session::unusedPetscOptions())
    texts.push_back(fmt::format("the option {} of PETSC_OPTIONS had no effect; correct its name, or drop it",
                                oneLine(option)));
  return texts;
}

std::string processesText(const distributed::Processes& processes) {
  const double most = processes.max(peakMemoryMb()), sum = processes.sum(peakMemoryMb());
  return fmt::format("  memory: {:.0f} MB in {} processes, at most {:.0f} MB in one\n", sum, processes.size(),
                     most);
}

}  // namespace slom::app
