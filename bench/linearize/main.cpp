// Time of a residual with its Jacobian: written by hand, by Ceres' automatic derivatives, by SLoM.
//
//   bench_linearize [--repetitions N] [--json FILE]   checks all variants, times them, prints a Markdown table
//   bench_linearize --check                           checks them only
//
// Every variant must agree with the one written by hand. If one does not, the program ends with status 1.
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>

#include "linearize/variants.hpp"
#include "support/table.hpp"

namespace {

using namespace slom::bench;

struct Arguments {
  int repetitions = 51;
  bool check_only = false;
  std::string json;
};

Arguments parse(int argc, char** argv) {
  Arguments result;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--check") {
      result.check_only = true;
    } else if (name == "--repetitions" && i + 1 < argc) {
      result.repetitions = std::atoi(argv[++i]);
    } else if (name == "--json" && i + 1 < argc) {
      result.json = argv[++i];
    } else {
      std::cerr << "bench_linearize: unknown argument '" << name
                << "'; pass --check, --repetitions N or --json FILE\n";
      std::exit(2);
    }
  }
  if (result.repetitions < 15) {
    std::cerr << "bench_linearize: --repetitions must be 15 or more\n";
    std::exit(2);
  }
  return result;
}

/// Returns all variants of one data set, the reference first.
template <class Data>
std::vector<Variant> variantsOf(const Data& data) {
  std::vector<Variant> all{byHand(data)};
#ifdef SLOM_BENCH_CERES
  all.push_back(byCeres(data));
#endif
  for (Variant& variant : bySlom(data)) all.push_back(std::move(variant));
  return all;
}

/// Appends the rows of one measurement. Returns false if a variant deviates from the reference.
template <class Data>
bool measure(const std::string& measurement, const Data& data, const Arguments& arguments, Table& table) {
  const std::vector<Variant> variants = variantsOf(data);
  const Derivatives reference = variants[0].derivatives();
  std::vector<Timing> times(variants.size());
  if (!arguments.check_only) times = timeInTurn(variants, kMeasurements, arguments.repetitions);
  bool ok = true;
  for (std::size_t v = 0; v < variants.size(); ++v) {
    const double off = deviation(variants[v].derivatives(), reference);
    table.rows.push_back({measurement, variants[v].name, off, times[v]});
    if (off <= variants[v].tolerance) continue;
    std::cerr << "bench_linearize: " << measurement << ", " << variants[v].name << ": deviates by " << off
              << " from what is written by hand, more than " << variants[v].tolerance << "\n";
    ok = false;
  }
  return ok;
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = parse(argc, argv);
  Table table{"by hand", "Ceres, automatic", arguments.repetitions, {}};
  bool ok = measure("bundle adjustment, 2 x 12", simulateBal(), arguments, table);
  ok = measure("relative pose, 6 x 12", simulatePoseGraph(), arguments, table) && ok;
  ok = measure("stereo camera, 4 x 30", simulateStereo(), arguments, table) && ok;
  if (!ok) return 1;
  if (arguments.check_only) {
    for (const Row& row : table.rows) {
      std::cout << row.measurement << ", " << row.variant << ": deviation " << row.deviation << "\n";
    }
    return 0;
  }
  writeMarkdown(std::cout, table);
  if (!arguments.json.empty()) {
    std::ofstream file(arguments.json);
    writeJson(file, table);
    if (!file.flush()) {
      std::cerr << "bench_linearize: cannot write " << arguments.json << "\n";
      return 1;
    }
  }
}
