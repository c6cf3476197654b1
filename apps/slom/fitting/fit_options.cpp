#include "fitting/fit_options.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include <slom/estimator.hpp>

#include "error.hpp"
#include "fitting/fit_limits.hpp"
#include "text.hpp"

namespace slom::app {

namespace {

std::vector<std::string> splitAtColons(const std::string& text) {
  std::vector<std::string> words{""};
  for (const char c : text) {
    if (c == ':') {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

/// Returns the field `name` or `description` of all entries of a table of the library.
template <class Entry>
std::vector<std::string> allOf(std::span<const Entry> table, const char* Entry::*field) {
  std::vector<std::string> words;
  for (const Entry& entry : table) words.emplace_back(entry.*field);
  return words;
}

/// Returns the help text of an option, in lines that fit beside its name.
std::string help(const std::string& text) { return wrapped(text, 70); }

/// Returns `name: description` of all entries of a table of the library.
template <class Entry>
std::string described(std::span<const Entry> table) {
  std::vector<std::string> parts;
  for (const Entry& entry : table) parts.push_back(fmt::format("{}: {}", entry.name, entry.description));
  return listed(parts, "; ", "; ");
}

NamedAlgorithm parseAlgorithm(const std::string& text) {
  if (const NamedAlgorithm* const found = algorithmNamed(text)) return *found;
  throw UserError(fmt::format("--algorithm {}: unknown algorithm; give {}", text,
                              listed(allOf(algorithms(), &NamedAlgorithm::name), ", ", " or ")));
}

NamedSolver parseSolver(const std::string& text) {
  const NamedSolver* const found = solverNamed(text);
  if (found != nullptr && found->missing == nullptr) return *found;
  throw UserError(
      fmt::format("--solver {}: {}; give {}", text,
                  found == nullptr ? "unknown solver" : fmt::format("this build has no {}", found->missing),
                  listed(allOf(solvers(), &NamedSolver::name), ", ", " or ")));
}

/// Returns the form of the loss in `--robust`, without its scale.
std::string formOf(const LossKind& loss) {
  return loss.has_shape ? fmt::format("{}:ALPHA", loss.stored_name) : loss.stored_name;
}

/// Parses `NAME:SCALE` or `barron:ALPHA:SCALE`.
Loss parseLoss(const std::string& text) {
  const std::vector<std::string> words = splitAtColons(text);
  const LossKind* const known = lossNamed(words[0]);
  if (known == nullptr) {
    std::vector<std::string> names;
    for (const LossKind* const loss : losses()) names.emplace_back(loss->stored_name);
    throw UserError(fmt::format("--robust {}: unknown loss; give {}", text, listed(names, ", ", " or ")));
  }
  std::vector<double> numbers;
  for (std::size_t i = 1; i < words.size(); ++i) {
    double number = 0;
    if (!parseNumber(words[i], number) || std::isnan(number)) break;
    numbers.push_back(number);
  }
  const std::size_t count = known->has_shape ? 2 : 1;
  if (numbers.size() == count && words.size() == count + 1) {
    const Loss loss(*known, numbers.back(), known->has_shape ? numbers.front() : 0);
    if (loss.fault().empty()) return loss;
  }
  throw UserError(
      fmt::format("--robust {}: write {}:SCALE; {}SCALE is a positive number of standard "
                  "deviations",
                  text, formOf(*known), known->has_shape ? "ALPHA is not above 2, and " : ""));
}

}  // namespace

void addFitOptions(CLI::App& command, RawFitOptions& raw) {
  command.add_option("--algorithm", raw.algorithm, help(described(algorithms())))
      ->type_name(listed(allOf(algorithms(), &NamedAlgorithm::name), "|", "|"))
      ->capture_default_str();
  command.add_option("--solver", raw.solver, help("linear solver; " + described(solvers())))
      ->type_name(listed(allOf(solvers(), &NamedSolver::name), "|", "|"))
      ->capture_default_str();
  command
      .add_option("--threads", raw.threads, "threads; 0: all of the machine; any number gives the same bits")
      ->type_name("NUMBER")
      ->capture_default_str();
  command
      .add_option("--max-iterations", raw.max_iterations,
                  "limit of iterations; default: 100000 / unknowns, from 100 to 10000")
      ->type_name("NUMBER");
  addTimeLimit(command, raw.max_seconds);
}

void addLossOption(CLI::App& command, RawFitOptions& raw) {
  std::vector<std::string> forms;
  for (const LossKind* const loss : losses())
    forms.push_back(formOf(*loss) + (loss->has_shape ? ":SCALE" : ""));
  command
      .add_option("--robust", raw.loss,
                  help("loss of all measurements, SCALE in standard deviations; NAME is " +
                       listed(forms, ", ", ", or ")))
      ->type_name("NAME:SCALE");
}

FitOptions parseFitOptions(const RawFitOptions& raw) {
  FitOptions options;
  options.algorithm = parseAlgorithm(raw.algorithm);
  options.solver = parseSolver(raw.solver);
  if (!raw.loss.empty()) options.loss = parseLoss(raw.loss);
  if (raw.threads < 0) throw UserError(fmt::format("--threads {}: give a number from 0 on", raw.threads));
  if (raw.max_iterations && *raw.max_iterations < 1) {
    throw UserError(fmt::format("--max-iterations {}: give a number from 1 on", *raw.max_iterations));
  }
  requireTimeLimit(raw.max_seconds);
  options.threads = raw.threads;
  options.max_iterations = raw.max_iterations.value_or(Options::kByTheSize);
  options.max_seconds = raw.max_seconds;
  return options;
}

void apply(const FitOptions& options, Estimator& estimator) {
  estimator.setThreads(options.threads);
  estimator.changeSolver(options.solver.make());
  estimator.changeAlgorithm(options.algorithm.make().release());
}

int threadsOf(const FitOptions& options) {
  return options.threads != 0 ? options.threads : int(std::max(1U, std::thread::hardware_concurrency()));
}

}  // namespace slom::app
