#include "fitting/fit_options.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include <slom/estimator.hpp>
#include <slom/solve/block_qr.hpp>
#include <slom/solve/block_solver.hpp>
#include <slom/solve/cholmod.hpp>
#include <slom/solve/dense_qr.hpp>

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

AlgorithmName parseAlgorithm(const std::string& text) {
  if (text == "gn") return AlgorithmName::gn;
  if (text == "lm") return AlgorithmName::lm;
  if (text == "dogleg") return AlgorithmName::dogleg;
  throw UserError(fmt::format("--algorithm {}: the algorithms are gn, lm and dogleg", text));
}

SolverName parseSolver(const std::string& text) {
  if (text == "auto") return SolverName::automatic;
  if (text == "cholesky") return SolverName::cholesky;
  if (text == "cg") return SolverName::cg;
  if (text == "qr") return SolverName::qr;
  if (text == "dense-qr") return SolverName::dense_qr;
  if (text == "cholmod" && Cholmod::isAvailable()) return SolverName::cholmod;
  throw UserError(fmt::format("--solver {}: the solvers are auto, cholesky, cg, qr and dense-qr{}", text,
                              Cholmod::isAvailable() ? " and cholmod"
                              : text == "cholmod" ? "; this build is without CHOLMOD (-DSLOM_WITH_CHOLMOD=ON)"
                                                  : ""));
}

std::unique_ptr<LinearSolver> makeSolver(SolverName name) {
  switch (name) {
    case SolverName::qr:
      return std::make_unique<BlockQR>();
    case SolverName::dense_qr:
      return std::make_unique<DenseQR>();
    case SolverName::cholmod:
      return std::make_unique<Cholmod>();
    case SolverName::cg:
      return std::make_unique<BlockSolver>(
          BlockSolverOptions{.method = BlockSolverOptions::Method::conjugate_gradients});
    case SolverName::cholesky:
      return std::make_unique<BlockSolver>(
          BlockSolverOptions{.method = BlockSolverOptions::Method::cholesky});
    case SolverName::automatic:
      break;
  }
  return std::make_unique<BlockSolver>();
}

/// `NAME:SCALE`, or `barron:ALPHA:SCALE`
Loss parseLoss(const std::string& text) {
  const std::vector<std::string> words = splitAtColons(text);
  const LossKind* const known = lossNamed(words[0]);
  if (known == nullptr) {
    throw UserError(fmt::format(
        "--robust {}: the losses are huber, pseudo-huber, cauchy, tukey, geman-mcclure and barron", text));
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
    if (detail::faultOf(loss).empty()) return loss;
  }
  throw UserError(fmt::format(
      "--robust {}: {}", text,
      known->has_shape
          ? "write barron:ALPHA:SCALE, ALPHA not above 2 and SCALE a positive number of standard deviations"
          : fmt::format("write {}:SCALE, SCALE a positive number of standard deviations",
                        known->stored_name)));
}

}  // namespace

void addFitOptions(CLI::App& command, RawFitOptions& raw) {
  command
      .add_option("--algorithm", raw.algorithm,
                  "Gauss-Newton, which goes on as Levenberg-Marquardt where it leads uphill;\n"
                  "Levenberg-Marquardt; Powell's dog leg")
      ->type_name("gn|lm|dogleg")
      ->capture_default_str();
  command
      .add_option("--solver", raw.solver,
                  "of the linear systems: chosen by predicted cost; Cholesky decomposition of\n"
                  "J^T J in blocks; conjugate gradients; QR decomposition of J, for\n"
                  "ill-conditioned problems; a dense one, for small problems")
      ->type_name("auto|cholesky|cg|qr|dense-qr")
      ->capture_default_str();
  command.add_option("--threads", raw.threads, "0: as many as the machine has; the result is the same")
      ->type_name("NUMBER")
      ->capture_default_str();
  command.add_option("--max-iterations", raw.max_iterations, "of the fit")
      ->type_name("NUMBER")
      ->capture_default_str();
  addTimeLimit(command, raw.max_seconds);
}

void addLossOption(CLI::App& command, RawFitOptions& raw) {
  command
      .add_option("--robust", raw.loss,
                  "loss of all measurements, with its scale in standard deviations: huber,\n"
                  "pseudo-huber, cauchy, tukey, geman-mcclure, or barron:ALPHA:SCALE")
      ->type_name("NAME:SCALE");
}

FitOptions parseFitOptions(const RawFitOptions& raw) {
  FitOptions options;
  options.algorithm = parseAlgorithm(raw.algorithm);
  options.solver = parseSolver(raw.solver);
  if (!raw.loss.empty()) options.loss = parseLoss(raw.loss);
  if (raw.threads < 0) throw UserError(fmt::format("--threads {}: give a number from 0 on", raw.threads));
  if (raw.max_iterations < 1) {
    throw UserError(fmt::format("--max-iterations {}: give a number from 1 on", raw.max_iterations));
  }
  requireTimeLimit(raw.max_seconds);
  options.threads = raw.threads;
  options.max_iterations = raw.max_iterations;
  options.max_seconds = raw.max_seconds;
  return options;
}

void apply(const FitOptions& options, Estimator& estimator) {
  estimator.setThreads(options.threads);
  estimator.changeSolver(makeSolver(options.solver));
  if (options.algorithm == AlgorithmName::lm) estimator.changeAlgorithm(LevenbergMarquardt());
  if (options.algorithm == AlgorithmName::dogleg) estimator.changeAlgorithm(DogLeg());
}

int threadsOf(const FitOptions& options) {
  return options.threads != 0 ? options.threads : int(std::max(1U, std::thread::hardware_concurrency()));
}

}  // namespace slom::app
