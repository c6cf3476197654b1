#include "fit/table.hpp"

#include <algorithm>
#include <cstdio>

namespace slom::bench {

void printHeader() {
  std::printf(
      "| problem | program | threads | setup ms | iteration ms | factorise ms | iterations | to 0.1 %% ms | to 1e-6 ms | "
      "memory MB | final RSS | / SLoM per iteration, to 1e-6 |\n"
      "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n");
}

void printRows(const Comparison& comparison, int threads) {
  const char* const name = comparison.problem.name.c_str();
  const double best = comparison.bestRss();
  const ProgramResult* slom = nullptr;
  for (const ProgramResult& result : comparison.programs) {
    if (!result.failure.empty()) {
      std::printf("| %s | %s | %d | %s |\n", name, result.program.c_str(), threads, result.failure.c_str());
      continue;
    }
    const Run& run = result.run;
    std::printf("| %s | %s | %d | %.2f | %.3f | %.3f | %d | %.2f | %.2f | %.1f | %.10g | ", name,
                result.program.c_str(), threads, 1e3 * run.setup_seconds, 1e3 * run.iteration_seconds,
                1e3 * run.factor_seconds / std::max(1, run.factorizations), run.iterations,
                1e3 * run.secondsUntil(best, 1e-3), 1e3 * run.secondsUntil(best, 1e-6),
                1e-6 * result.memory_bytes, run.finalRss());
    if (result.program == "SLoM") {
      slom = &result;
      std::printf("|\n");
    } else if (slom != nullptr) {
      std::printf("%.2f, %.2f |\n", run.iteration_seconds / slom->run.iteration_seconds,
                  run.secondsUntil(best, 1e-6) / slom->run.secondsUntil(best, 1e-6));
    } else {
      std::printf("|\n");
    }
  }
  const auto printFactor = [&](const char* program, const std::optional<Factorization>& f) {
    if (!f) return;
    std::printf("| %s | %s | 1 | %.2f | | ", name, program, 1e3 * f->symbolic_seconds);
    if (f->numeric_seconds > 0) std::printf("%.3f ", 1e3 * f->numeric_seconds);
    std::printf("| | | | | %.4g Mflop | |\n", 1e-6 * f->flops);
  };
  printFactor("SLoM, factor alone", comparison.slom);
  printFactor("CHOLMOD, factor alone", comparison.cholmod);
  std::fflush(stdout);
}

}  // namespace slom::bench
