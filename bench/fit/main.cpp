// How long does a whole fit take, by SLoM and by Ceres?
//
//   bench_fit [--threads N] [--rounds N] [--max-iterations N] FILE...
//
// FILE is a pose graph that `slom graph` reads (.g2o, .graph), or a scene that `slom bundle` reads. The programs take turns; of each the round with the median time counts.
// Prints a Markdown table. Ends with status 1 when both converge to the same minimum but differ there by more than 1e-8.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <string>
#include <variant>
#include <vector>

#include "bundle/input/read.hpp"
#include "error.hpp"
#include "fit/run.hpp"
#include "graph/input/information.hpp"
#include "graph/input/read.hpp"
#include "graph/start/gauge.hpp"
#include "graph/start/start.hpp"
#include "support/build_info.hpp"

namespace {

using namespace slom::bench;

struct Arguments {
  Limits limits;
  int rounds = 3;
  std::vector<std::string> files;
};

Arguments parse(int argc, char** argv) {
  Arguments result;
  const auto number = [&](int& i) {
    const int value = i + 1 < argc ? std::atoi(argv[i + 1]) : 0;
    if (value < 1) {
      std::cerr << "bench_fit: " << argv[i] << " needs a positive number\n";
      std::exit(2);
    }
    ++i;
    return value;
  };
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--threads") {
      result.limits.threads = number(i);
    } else if (name == "--rounds") {
      result.rounds = number(i);
    } else if (name == "--max-iterations") {
      result.limits.max_iterations = number(i);
    } else if (name.starts_with("--")) {
      std::cerr << "bench_fit: unknown argument '" << name << "'; pass --threads, --rounds, --max-iterations or files\n";
      std::exit(2);
    } else {
      result.files.push_back(name);
    }
  }
  return result;
}

using Program = std::function<Run()>;

/// Each program's round with the median time.
std::vector<Run> runInTurn(const std::vector<Program>& programs, int rounds) {
  std::vector<std::vector<Run>> all(programs.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t p = 0; p < programs.size(); ++p) all[p].push_back(programs[p]());
  }
  std::vector<Run> result;
  for (std::vector<Run>& runs : all) {
    const auto middle = runs.begin() + static_cast<std::ptrdiff_t>(runs.size() / 2);
    std::nth_element(runs.begin(), middle, runs.end(), [](const Run& a, const Run& b) { return a.seconds < b.seconds; });
    result.push_back(*middle);
  }
  return result;
}

void printHeader() {
  std::cout << "| file | program | threads | setup ms | iteration ms | factorise ms | iterations | to 0.1 % ms | to 1e-6 ms | "
               "final RSS | Ceres / SLoM per iteration, to 1e-6 |\n"
               "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";
}

/// False when the same minimum was found with another cost.
bool printRows(const std::string& name, const std::vector<Run>& runs, int threads) {
  double best = runs[0].finalRss();
  for (const Run& run : runs) best = std::min(best, run.finalRss());
  bool good = true;
  for (const Run& run : runs) {
    const double iteration = run.secondsPerIteration(), reached = run.secondsUntil(best, 1e-6);
    std::printf("| %s | %s | %d | %.2f | %.3f | %.3f | %d | %.2f | %.2f | %.8g | ", name.c_str(), run.program.c_str(), threads,
                1e3 * run.setup_seconds, 1e3 * iteration, 1e3 * run.factor_seconds / std::max(1, run.iterations), run.iterations,
                1e3 * run.secondsUntil(best, 1e-3), 1e3 * reached, run.finalRss());
    if (&run == &runs[0]) {
      std::printf("|\n");
    } else {
      std::printf("%.2f, %.2f |\n", iteration / runs[0].secondsPerIteration(), reached / runs[0].secondsUntil(best, 1e-6));
    }
    const double off = run.finalRss() / best - 1;
    if (off > 1e-8 && off < 1e-6) {
      std::cerr << "bench_fit: " << name << ", " << run.program << ": the final RSS is off by " << off << "\n";
      good = false;
    }
  }
  return good;
}

template <class Pose>
bool compareOnGraph(slom::app::graph::PoseGraph<Pose> graph, const std::string& name, const Arguments& arguments) {
  slom::app::graph::checkInformation(graph, false);
  slom::app::graph::holdGauge(graph, false);
  slom::app::graph::findStart(graph, graph.has_vertices ? slom::app::graph::Init::file : slom::app::graph::Init::spanning_tree);
  std::vector<Program> programs{[&] { return fitBySlom(graph, arguments.limits); }};
#ifdef SLOM_BENCH_CERES
  programs.push_back([&] { return fitByCeres(graph, arguments.limits); });
#endif
  const std::vector<Run> runs = runInTurn(programs, arguments.rounds);
  const bool good = printRows(name, runs, arguments.limits.threads);
#ifdef SLOM_BENCH_CHOLMOD
  const CholmodTimes cholmod = factorizeByCholmod(graph);
  const double own = runs[0].factor_seconds / std::max(1, runs[0].iterations);
  std::printf("| %s | CHOLMOD alone | 1 | %.2f | | %.3f | | | | %.3g Mflop | factorise: %.2f |\n", name.c_str(),
              1e3 * cholmod.symbolic_seconds, 1e3 * cholmod.numeric_seconds, 1e-6 * cholmod.flops,
              cholmod.numeric_seconds / own);
#endif
  return good;
}

bool compareOnBundle(const slom::app::bundle::Scene& scene, const std::string& name, const Arguments& arguments) {
  std::vector<Program> programs{[&] { return fitBySlom(scene, arguments.limits); }};
#ifdef SLOM_BENCH_CERES
  programs.push_back([&] { return fitByCeres(scene, true, arguments.limits); });
  programs.push_back([&] { return fitByCeres(scene, false, arguments.limits); });
#endif
  return printRows(name, runInTurn(programs, arguments.rounds), arguments.limits.threads);
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = parse(argc, argv);
  std::cout << processorName() << ", " << instructionSet() << ", " << compilerName() << " " << compileFlags() << "\n\n";
  printHeader();
  bool good = true;
  for (const std::string& file : arguments.files) {
    try {
      const std::string name = std::filesystem::path(file).stem().string();
      if (!file.ends_with(".g2o") && !file.ends_with(".graph")) {
        good = compareOnBundle(slom::app::bundle::readScene(file), name, arguments) && good;
        continue;
      }
      const auto compare = [&](const auto& graph) { return compareOnGraph(graph, name, arguments); };
      good = std::visit(compare, slom::app::graph::readPoseGraph(file)) && good;
      std::fflush(stdout);
    } catch (const slom::app::UserError& error) {
      std::cerr << "bench_fit: " << error.what() << "\n";
      return 2;
    }
  }
  return good ? 0 : 1;
}
