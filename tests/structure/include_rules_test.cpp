// The project keeps its include rule, and the check that says so notices when it does not.

#include "structure/include_rules.hpp"

#include <gtest/gtest.h>

#include "support/paths.hpp"
#include "support/temporary_folder.hpp"

namespace slom::testing {
namespace {

std::string lines(const std::vector<std::string>& violations) {
  std::string text;
  for (const std::string& violation : violations) text += violation + "\n";
  return text;
}

TEST(IncludeRules, ProjectKeepsThem) {
  const IncludeReport report = checkIncludes(sourcePath("."));
  EXPECT_GT(report.files, 10);
  EXPECT_EQ(lines(report.violations), "");
}

TEST(IncludeRules, AllowedIncludesAreNotReported) {
  const TemporaryFolder root;
  writeFile(root / "include/mtk/a.hpp", "#include <vector>\n#include <Eigen/Core>\n#include \"mtk/b.hpp\"\n");
  writeFile(root / "include/mtk/b.hpp", "#include <iosfwd>\n#include <ostream>\n#include <sstream>\n");
  writeFile(root / "include/slom/model/m.hpp", "#include <mtk/a.hpp>\n#include \"n.hpp\"\n");
  writeFile(root / "include/slom/model/n.hpp", "// #include <iostream>\n");
  writeFile(root / "include/slom/measurements/k.hpp",
            "#include \"mtk/a.hpp\"\n#include \"slom/model/m.hpp\"\n#include \"slom/measurements/l.hpp\"\n");
  writeFile(root / "include/slom/measurements/l.hpp", "");
  writeFile(root / "include/slom/measurements.hpp", "#include \"slom/measurements/k.hpp\"\n");
  writeFile(root / "include/slom/solve/s.hpp", "#include \"slom/model/m.hpp\"\n");
  writeFile(root / "src/base/threads.hpp", "#include <tbb/parallel_for.h>\n");
  writeFile(root / "include/slom/slom.hpp",
            "#include \"slom/estimator.hpp\"\n#include \"slom/solve/s.hpp\"\n");
  writeFile(root / "include/slom/estimator.hpp", "#include \"slom/model/m.hpp\"\n");
  writeFile(root / "src/solve/s.cpp",
            "#include \"slom/solve/s.hpp\"\n#include <iostream>\n#include \"local.hpp\"\n");
  writeFile(root / "src/solve/local.hpp", "#include <cholmod.h>\n");
  writeFile(root / "src/estimator/estimator.cpp",
            "#include \"slom/estimator.hpp\"\n#include \"solve/local.hpp\"\n");
  EXPECT_EQ(lines(checkIncludes(root.path()).violations), "");
}

TEST(IncludeRules, EachViolationIsReportedWithItsPlace) {
  const TemporaryFolder root;
  writeFile(root / "apps/slom/error.hpp", "");
  writeFile(root / "include/mtk/a.hpp",
            "#include <vector>\n#include \"slom/model/m.hpp\"\n#include <tbb/tbb.h>\n");
  writeFile(root / "include/slom/extra/e.hpp", "");
  writeFile(root / "include/slom/measurements/k.hpp", "#include \"slom/solve/s.hpp\"\n");
  writeFile(root / "include/slom/model/m.hpp",
            "#include \"../solve/s.hpp\"\n  #  include <slom/estimator.hpp>\n");
  writeFile(root / "include/slom/optimize/o.hpp", "#include <iostream>\n#include <nlohmann/json.hpp>\n");
  writeFile(root / "include/slom/problem/p.hpp", "#include \"slom/measurements/k.hpp\"\n");
  writeFile(root / "include/slom/solve/s.hpp", "\n\n#include <cholmod.h>\n#include \"nowhere.hpp\"\n");
  writeFile(root / "src/linearize/l.cpp", "#include \"slom/analyze/report.hpp\"\n#include <fmt/core.h>\n");
  writeFile(root / "src/solve/s.cpp",
            "#include \"../../apps/slom/error.hpp\"\n#include <apps/slom/error.hpp>\n#include <tbb/tbb.h>\n");
  EXPECT_EQ(
      lines(checkIncludes(root.path()).violations),
      "include/mtk/a.hpp:2: includes slom/model/m.hpp: mtk may include only what stands above it, model "
      "stands "
      "below\n"
      "include/mtk/a.hpp:3: includes tbb/tbb.h: mtk uses Eigen alone\n"
      "include/slom/extra/e.hpp:1: its folder is not a step of the data flow\n"
      "include/slom/measurements/k.hpp:1: includes slom/solve/s.hpp: measurements may include only what stands "
      "above it, solve stands below\n"
      "include/slom/model/m.hpp:1: includes ../solve/s.hpp: model may include only what stands above it, "
      "solve "
      "stands below\n"
      "include/slom/model/m.hpp:2: includes slom/estimator.hpp: model may include only what stands above it, "
      "the "
      "facade stands below\n"
      "include/slom/optimize/o.hpp:1: includes iostream: a public header holds no <iostream>\n"
      "include/slom/optimize/o.hpp:2: includes nlohmann/json.hpp: the libraries do without it, only the "
      "command "
      "may use it\n"
      "include/slom/problem/p.hpp:1: includes slom/measurements/k.hpp: only the facade and users include "
      "measurements\n"
      "include/slom/solve/s.hpp:3: includes cholmod.h: a public header needs no other library than Eigen\n"
      "include/slom/solve/s.hpp:4: includes nowhere.hpp: no such file of the project\n"
      "src/linearize/l.cpp:1: includes slom/analyze/report.hpp: linearize may include only what stands above "
      "it, "
      "analyze stands below\n"
      "src/linearize/l.cpp:2: includes fmt/core.h: the libraries do without it, only the command may use it\n"
      "src/solve/s.cpp:1: includes ../../apps/slom/error.hpp: nobody includes apps/\n"
      "src/solve/s.cpp:2: includes apps/slom/error.hpp: nobody includes apps/\n"
      "src/solve/s.cpp:3: includes tbb/tbb.h: oneTBB is behind base/threads.hpp\n");
}

TEST(IncludeRules, OfReadersAndBenchmarks) {
  const TemporaryFolder root;
  writeFile(root / "apps/slom/text.hpp", "");
  writeFile(root / "include/slom/estimator.hpp", "#include \"slom/io.hpp\"\n");
  writeFile(root / "include/slom/initialize/start.hpp", "#include \"slom/io/g2o.hpp\"\n");
  writeFile(root / "include/slom/trajectory/spline.hpp",
            "#include \"slom/estimator.hpp\"\n#include \"slom/initialize/start.hpp\"\n");
  writeFile(root / "include/slom/io.hpp", "#include \"slom/io/g2o.hpp\"\n");
  writeFile(root / "include/slom/io/g2o.hpp", "#include \"slom/estimator.hpp\"\n#include <fmt/core.h>\n");
  writeFile(root / "src/base/words.hpp", "");
  writeFile(root / "src/io/words.hpp", "#include <fmt/core.h>\n#include <bzlib.h>\n");
  writeFile(root / "src/io/g2o.cpp", "#include \"base/words.hpp\"\n#include \"io/words.hpp\"\n");
  writeFile(root / "bench/fit/main.cpp",
            "#include \"fit/run.hpp\"\n#include \"text.hpp\"\n#include <slom/io.hpp>\n");
  writeFile(root / "bench/fit/run.hpp", "#include \"support/models.hpp\"\n#include \"nowhere.hpp\"\n");
  writeFile(root / "tests/support/models.hpp", "");
  EXPECT_EQ(
      lines(checkIncludes(root.path()).violations),
      "bench/fit/main.cpp:2: includes text.hpp: a benchmark is a user of the libraries, not of the command\n"
      "bench/fit/run.hpp:2: includes nowhere.hpp: no such file of bench/ or tests/\n"
      "include/slom/estimator.hpp:1: includes slom/io.hpp: the facade may include only what stands above it, io "
      "stands below\n"
      "include/slom/initialize/start.hpp:1: includes slom/io/g2o.hpp: initialize may include only what stands above "
      "it, io stands below\n"
      "include/slom/io/g2o.hpp:2: includes fmt/core.h: the libraries do without it, only the command may use it\n"
      "include/slom/trajectory/spline.hpp:2: includes slom/initialize/start.hpp: trajectory may include only what stands "
      "above it, initialize stands below\n"
      "src/io/g2o.cpp:1: includes base/words.hpp: io is a user of the library, whose src/ is its own\n");
}

TEST(IncludeRules, OfTheCalibration) {
  const TemporaryFolder root;
  writeFile(root / "include/slom/slom.hpp", "");
  writeFile(root / "include/slom/calibration.hpp",
            "#include \"slom/calibration/result.hpp\"\n#include <fmt/core.h>\n");
  writeFile(root / "include/slom/calibration/result.hpp", "#include \"slom/slom.hpp\"\n");
  writeFile(root / "include/slom/estimator.hpp", "#include \"slom/calibration.hpp\"\n");
  writeFile(root / "src/base/words.hpp", "");
  writeFile(root / "src/calibration/fit/fit.hpp", "#include <fmt/core.h>\n#include <nlohmann/json.hpp>\n");
  writeFile(
      root / "src/calibration/fit.cpp",
      "#include \"calibration/fit/fit.hpp\"\n#include \"slom/calibration/result.hpp\"\n#include \"base/words.hpp\"\n"
      "#include <slom/slom.hpp>\n");
  writeFile(root / "include/slom/io/file.hpp", "#include \"slom/calibration/result.hpp\"\n");
  writeFile(root / "src/calibration/files/read.cpp", "#include \"slom/io/file.hpp\"\n");
  writeFile(root / "src/solve/solve.cpp", "#include \"calibration/fit/fit.hpp\"\n");
  EXPECT_EQ(
      lines(checkIncludes(root.path()).violations),
      "include/slom/calibration.hpp:2: includes fmt/core.h: the libraries do without it, only the command may use it\n"
      "include/slom/estimator.hpp:1: includes slom/calibration.hpp: the facade may include only what stands above it, "
      "calibration stands below\n"
      "include/slom/io/file.hpp:1: includes slom/calibration/result.hpp: io may include only what stands above it, "
      "calibration stands below\n"
      "src/calibration/fit.cpp:3: includes base/words.hpp: calibration is a user of the library, whose src/ is its own\n"
      "src/calibration/fit/fit.hpp:2: includes nlohmann/json.hpp: the libraries do without it, only the command may use "
      "it\n"
      "src/solve/solve.cpp:1: includes calibration/fit/fit.hpp: solve may include only what stands above it, calibration "
      "stands below\n");
}

TEST(IncludeRules, RoomsOfALibraryFormNoCircle) {
  const TemporaryFolder root;
  writeFile(root / "src/calibration/text.hpp", "");
  writeFile(root / "src/calibration/fit/fit.hpp", "#include \"calibration/text.hpp\"\n");
  writeFile(root / "src/calibration/fit/fit.cpp", "#include \"calibration/quality/lens.hpp\"\n");
  writeFile(root / "src/calibration/quality/lens.hpp", "#include \"calibration/fit/fit.hpp\"\n");
  EXPECT_EQ(lines(checkIncludes(root.path()).violations),
            "folders include each other in a circle: src/calibration/fit -> src/calibration/quality -> "
            "src/calibration/fit\n");
}

TEST(IncludeRules, OfTheCommand) {
  const TemporaryFolder root;
  writeFile(root / "src/base/words.hpp", "");
  writeFile(root / "include/slom/slom.hpp", "");
  writeFile(root / "apps/slom/text.hpp", "#include <fmt/core.h>\n#include \"graph/graph.hpp\"\n");
  writeFile(root / "apps/slom/main.cpp", "#include \"graph/graph.hpp\"\n#include \"bundle/bundle.hpp\"\n");
  writeFile(root / "apps/slom/fitting/options.hpp", "#include \"text.hpp\"\n#include <slom/slom.hpp>\n");
  writeFile(
      root / "apps/slom/graph/graph.hpp",
      "#include \"fitting/options.hpp\"\n#include \"bundle/bundle.hpp\"\n#include \"base/words.hpp\"\n");
  writeFile(root / "apps/slom/graph/input/read.hpp",
            "#include \"graph/graph.hpp\"\n#include \"read_more.hpp\"\n#include <base/words.hpp>\n");
  writeFile(root / "apps/slom/bundle/bundle.hpp", "#include \"bundle/fit/fit.hpp\"\n");
  writeFile(root / "apps/slom/bundle/fit/fit.hpp", "#include \"bundle/output/write.hpp\"\n");
  writeFile(root / "apps/slom/bundle/output/write.hpp", "#include \"bundle/fit/fit.hpp\"\n");
  EXPECT_EQ(
      lines(checkIncludes(root.path()).violations),
      "apps/slom/graph/graph.hpp:2: includes bundle/bundle.hpp: graph may not include another subcommand\n"
      "apps/slom/graph/graph.hpp:3: includes base/words.hpp: the command is a user of the library, whose src/ is its "
      "own\n"
      "apps/slom/graph/input/read.hpp:2: includes read_more.hpp: no such file of the command; name it by its path from "
      "apps/slom\n"
      "apps/slom/graph/input/read.hpp:3: includes base/words.hpp: the command is a user of the library, whose src/ is "
      "its own\n"
      "apps/slom/text.hpp:2: includes graph/graph.hpp: what subcommands share includes none of them\n"
      "folders include each other in a circle: apps/slom/bundle/fit -> apps/slom/bundle/output -> "
      "apps/slom/bundle/fit\n");
}

}  // namespace
}  // namespace slom::testing
