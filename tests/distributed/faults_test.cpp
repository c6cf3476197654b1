// If something goes wrong on several processes, one sentence says so, once, and no file is left.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include <slom/io/g2o.hpp>

#include "distributed/mpirun.hpp"
#include "io/simulated_graph.hpp"

namespace slom::testing {
namespace {

std::string graph() { return io::toG2o(io::testing::simulateGraph<io::Pose3>(40, 0.01, 3)); }

void expectRefused(const std::string& content, const std::string& sentence,
                   std::vector<std::string> options = {}, const std::string& subcommand = "graph") {
  for (const int processes : {2, 3}) {
    const TemporaryFolder folder;
    const std::string file = (folder / "map.txt").string();
    writeFile(folder / "map.txt", content);
    std::vector<std::string> words{subcommand, file,
                                   "--output", (folder / "fitted.txt").string(),
                                   "--json",   (folder / "result.json").string()};
    words.insert(words.end(), options.begin(), options.end());
    const CommandResult result = runSlom(processes, words);
    EXPECT_EQ(replaced(sentencesOfSlom(result.errors), folder.path().string() + "/", ""),
              "slom: " + sentence + "\n")
        << result.errors;
    EXPECT_EQ(result.exit_code, 2);
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
      EXPECT_EQ(entry.path().filename(), "map.txt") << "was written all the same";
  }
}

int lineOf(const std::string& text, std::size_t place) {
  return 1 + int(std::count(text.begin(), text.begin() + std::ptrdiff_t(place), '\n'));
}

TEST(Faults, OfALineAreNamedByFileAndLineOnce) {
  std::string text = graph();
  const std::size_t last = text.rfind("EDGE_SE3:QUAT");
  const std::size_t word = text.find(' ', text.find(' ', text.find(' ', last) + 1) + 1) + 1;
  text.replace(word, text.find(' ', word) - word, "nonsense");
  expectRefused(text, "map.txt:" + std::to_string(lineOf(text, last)) +
                          ": word 3 after EDGE_SE3:QUAT is \"nonsense\"; write a finite number there");
}

TEST(Faults, OfMissingVerticesAreNamed) {
  std::string text = graph();
  const std::size_t line = text.find("VERTEX_SE3:QUAT 20 ");
  const std::string without = text.substr(0, line) + text.substr(text.find('\n', line) + 1);
  const TemporaryFolder folder;
  writeFile(folder / "map.g2o", without);
  const CommandResult result = runSlom(3, {"graph", (folder / "map.g2o").string()});
  const std::string said = sentencesOfSlom(result.errors);
  EXPECT_NE(said.find(": there is no vertex 20; add a line for it, or remove this one"), std::string::npos)
      << said;
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1);
  EXPECT_EQ(result.exit_code, 2);
}

TEST(Faults, OfOptionsAreRefusedOnce) {
  const std::string text = graph();
  const auto unavailable = [](const std::string& option) {
    return option + ": not available on several processes; drop it, or start one process";
  };
  expectRefused(text, unavailable("--init chordal"), {"--init", "chordal"});
  expectRefused(
      text,
      "--solver qr: works in one process alone; give auto, cholesky or cg, or PETSc's own options in "
      "PETSC_OPTIONS",
      {"--solver", "qr"});
  expectRefused(text, unavailable("--plot"), {"--plot", "map.html"});
}

TEST(Faults, OfScenesAreNamedByFileAndLineOnce) {
  expectRefused("1 2 2\n0 0 1 2\n0 1 x 2\n0 0 0\n0 0 0\n500 0 0\n0 0 -5\n0 1 -5\n",
                "map.txt:3: u of observation 1 is \"x\"; write a finite number there", {}, "bundle");
  expectRefused(
      "1 2 1\n0 0 1 2\n0 0 0\n0 0 0\n500 0 0\n0 0 -5\n0 1 -5\n",
      "map.txt: point 1 has no observation, so nothing determines it; add observations, or remove it", {},
      "bundle");
}

/// Runs one process and three, which must say the same.
void expectRefusedAlike(const std::string& subcommand, const std::string& file, const std::string& sentence) {
  for (const int processes : {1, 3}) {
    const CommandResult result = runSlom(processes, {subcommand, file});
    EXPECT_EQ(sentencesOfSlom(result.errors), "slom: " + sentence + "\n") << result.errors;
    EXPECT_EQ(result.exit_code, 2);
  }
}

TEST(Faults, OfFilesAreNamedAsByOneProcess) {
  const TemporaryFolder folder;
  const std::string name = folder.path().string();
  for (const char* const subcommand : {"graph", "bundle"}) {
    expectRefusedAlike(subcommand, name, name + ": cannot be read (Is a directory); check the path");
    expectRefusedAlike(subcommand, "-", "-: cannot be read (No such file or directory); check the path");
  }
  const std::string file = (folder / "scene.txt").string();
  const auto ofScene = [&](const std::string& content, const std::string& sentence) {
    writeFile(folder / "scene.txt", content);
    expectRefusedAlike("bundle", file, file + sentence);
  };
  ofScene("", ": the file is empty; a BAL file begins with a line \"cameras points observations\"");
  ofScene(
      "1 x 1\n0 0 1 2\n",
      ":1: the number of points is \"x\"; a BAL file begins with a line \"cameras points observations\" of whole "
      "numbers from 1 on");
  ofScene(
      "1 1 1\n0 3 1 2\n",
      ":2: this observation is of point 3, but there is 1 point, with number 0; correct it, or the first line");
  ofScene("1 1 1\n0 0 1 1e7\n",
          ":2: v of observation 0 is \"1e7\"; write a number from -1e+06 to 1e+06 [px] there");
  ofScene(
      "1 1 1\n0 0 1\n",
      ":2: an observation has 4 numbers on a line, \"camera point u v\", but this line has 3; the first line "
      "announces 1 camera, 1 point and 1 observation");
}

TEST(Faults, OfTooManyResidualsAreNamed) {
  // All numbers are there but most of the announced observations, which are missed later.
  const TemporaryFolder folder;
  const std::string file = (folder / "scene.txt").string();
  writeFile(folder / "scene.txt", "1 1 1500000000\n");
  const CommandResult result = runSlom(2, {"bundle", file});
  EXPECT_EQ(
      sentencesOfSlom(result.errors),
      "slom: " + file + ": 3000000000 residuals, more than 2147483647, the limit; give a smaller scene\n");
  EXPECT_EQ(result.exit_code, 2);
}

TEST(Faults, OfContainersAreNamedOnce) {
  const TemporaryFolder folder;
  const std::string text = (folder / "map.g2o").string(), binary = (folder / "map.slomb").string();
  writeFile(folder / "map.g2o", graph());
  ASSERT_EQ(runSlom(1, {"convert", text, binary, "--quiet"}).exit_code, 0);
  std::string content = readFile(binary);
  expectRefusedAlike("bundle", binary, binary + ": the container has a pose graph; fit it by slom graph");
  content[content.size() - 5] = char(content[content.size() - 5] ^ 8);
  writeFile(folder / "map.slomb", content);
  expectRefusedAlike("graph", binary,
                     binary + ": the container is damaged in its section FIX; convert the text file again");
  writeFile(folder / "map.slomb", content.substr(0, 1000));
  expectRefusedAlike("graph", binary,
                     binary + ": the container ends after 1000 of " + std::to_string(content.size()) +
                         " bytes; convert the text file again");
}

TEST(Faults, OfOptionsOfPetscAreNamedOnce) {
  const TemporaryFolder folder;
  writeFile(folder / "map.g2o", graph());
  ::setenv("PETSC_OPTIONS", "-ksp_tpye gmres", 1);
  const CommandResult result = runSlom(2, {"graph", (folder / "map.g2o").string()});
  ::unsetenv("PETSC_OPTIONS");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const std::string warning =
      "  warning: the option -ksp_tpye gmres of PETSC_OPTIONS had no effect; correct its name, or drop it\n";
  const std::size_t first = result.output.find(warning);
  EXPECT_NE(first, std::string::npos) << result.output;
  EXPECT_EQ(result.output.find(warning, first + 1), std::string::npos);
}

TEST(Faults, AnInterruptedFitReports) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("posegraph/city10000.g2o");
  const TemporaryFolder folder;
  const std::string json = (folder / "result.json").string(), output = (folder / "fitted.g2o").string();
  // One of the processes sends itself the signal while they fit, which takes much longer.
  const std::string script =
      "'" + std::string(SLOM_MPIRUN) +
      "' -n 3 sh -c 'if [ \"$OMPI_COMM_WORLD_RANK\" = 1 ]; then (sleep 4; kill -USR1 $$) & fi; exec \"$0\" \"$@\"' ";
  mpirun(1, {});  // sets the environment
  const CommandResult result = runCommand(
      {"sh", "-c",
       script + commandPath().string() + " graph " + sharedDataPath("posegraph/city10000.g2o").string() +
           " --init file --max-iterations 10000 --solver cg --json " + json + " --output " + output});
  EXPECT_EQ(result.exit_code, 1) << result.errors;
  EXPECT_NE(result.output.find("NOT CONVERGED"), std::string::npos) << result.output;
  ASSERT_TRUE(std::filesystem::exists(json)) << result.errors;
  EXPECT_EQ(nlohmann::json::parse(readFile(json))["stop_reason"], "interrupted");
  EXPECT_FALSE(std::filesystem::exists(output));
}

TEST(Faults, OfOtherSubcommandsAreRefused) {
  const CommandResult result = runSlom(2, {"calibrate", "--corners", "x.csv"});
  EXPECT_EQ(sentencesOfSlom(result.errors),
            "slom: 2 processes were started, but slom calibrate works in one; start it without mpirun\n");
}

TEST(Faults, AKilledProcessEndsTheRun) {
  SLOM_SKIP_WITHOUT_SHARED_DATA("posegraph/city10000.g2o");
  const TemporaryFolder folder;
  const std::string output = (folder / "fitted.g2o").string();
  // One of the processes is ended while they fit, which takes much longer.
  const std::string script = "'" + std::string(SLOM_MPIRUN) +
                             "' -n 3 sh -c 'if [ \"$OMPI_COMM_WORLD_RANK\" = 1 ]; then "
                             "\"$0\" \"$@\" & sleep 2; kill -9 $!; wait $!; else exec \"$0\" \"$@\"; fi' ";
  mpirun(1, {});  // sets the environment
  const auto start = std::chrono::steady_clock::now();
  const CommandResult result = runCommand(
      {"sh", "-c",
       script + commandPath().string() + " graph " + sharedDataPath("posegraph/city10000.g2o").string() +
           " --init file --max-iterations 10000 --solver cg --output " + output});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_NE(result.exit_code, 0);
  EXPECT_LT(seconds, 60);  // the fit takes much longer
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace slom::testing
