// Names of files that are no UTF-8, that span lines, and that look like markup or commands to a terminal;
// output that is lost.
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calibrate/faults.hpp"
#include "printable.hpp"
#include "support/paths.hpp"
#include "support/run_command.hpp"

namespace slom::app {
namespace {

using slom::testing::commandPath;
using slom::testing::CommandResult;
using slom::testing::readFile;
using slom::testing::runCommand;
using slom::testing::sourcePath;
using slom::testing::TemporaryFolder;
using slom::testing::writeFile;

TEST(Printable, KeepsTextAndEscapesTheRest) {
  EXPECT_EQ(printable("Gr\xC3\xBC\xC3\x9F"
                      "e \xE2\x82\xAC \xF0\x9F\x98\x80\n\t."),
            "Gr\xC3\xBC\xC3\x9F"
            "e \xE2\x82\xAC \xF0\x9F\x98\x80\n\t.");
  EXPECT_EQ(printable("\x1b[31m\r\x7f\x9b"), "\\x1b[31m\\x0d\\x7f\\x9b");
  EXPECT_EQ(printable("\xC2\x9B|"), "\\xc2\\x9b|") << "a control character in two bytes";
  for (const std::string bad : {"\xFF", "\xC3", "\xC0\xAF", "\xE2\x82", "\xED\xA0\x80", "\xF4\x90\x80\x80",
                                "\xF5\x80\x80\x80", "\x80"})
    EXPECT_EQ(printable(bad).size(), 4 * bad.size());
  EXPECT_EQ(oneLine("a\nb\r\tc"), "a\\x0ab\\x0d\\x09c");
  EXPECT_EQ(printable(std::string_view("\0", 1)), "\\x00");
}

TEST(Printable, XmlText) {
  EXPECT_EQ(xmlText("a]]><b>&\"\xC3\xBC"), "a]]&gt;&lt;b&gt;&amp;&quot;\xC3\xBC");
  EXPECT_EQ(xmlText("\x1b|\xFF|\xEF\xBF\xBF|\t\n"), "\xEF\xBF\xBD|\xEF\xBF\xBD|\xEF\xBF\xBD|\t\n");
}

const std::string odd_names[] = {"\xFF\xC3.g2o", "a\nb.g2o", "\x1b[31mred\x07.g2o",
                                 "]]><title><script>&\".g2o", "\xED\xA0\x80.g2o"};
const std::string graph = "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 1 2 1 0 0 1 0 0 1 0 1\nODD\x1b[0m 1\n";

/// Names cannot begin lines or columns of their own.
void expectEscaped(const std::string& text) {
  EXPECT_EQ(text.find("FORGED\n"), std::string::npos) << text;
  EXPECT_EQ(text.find('\t'), std::string::npos) << text;
  EXPECT_EQ(text.find('\r'), std::string::npos) << text;
  EXPECT_NE(text.find("a\\x0aFORGED\\x0a\\x09\\x0d"), std::string::npos) << text;
}

void expectPrintable(const std::string& text) { EXPECT_EQ(printable(text), text); }

TEST(OddNames, OfGraphs) {
  for (const std::string& name : odd_names) {
    const TemporaryFolder folder;
    writeFile(folder / name, graph);
    const auto result = runCommand({commandPath().string(), "graph", (folder / name).string(), "--json",
                                    (folder / ("j" + name)).string(), "--output",
                                    (folder / ("o" + name)).string(), "--plot", (folder / "p.svg").string()});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    expectPrintable(result.output);
    EXPECT_TRUE(nlohmann::json::accept(readFile(folder / ("j" + name))));
    EXPECT_TRUE(std::filesystem::exists(folder / ("o" + name)));
    const auto parsed =
        runCommand({"/usr/bin/python3", "-c", "import sys, xml.etree.ElementTree as e; e.parse(sys.argv[1])",
                    (folder / "p.svg").string()});
    EXPECT_EQ(parsed.exit_code, 0) << parsed.errors << readFile(folder / "p.svg").substr(0, 400);
    const auto page = runCommand({commandPath().string(), "graph", (folder / name).string(), "--quiet",
                                  "--plot", (folder / "p.html").string()});
    EXPECT_EQ(page.exit_code, 0) << page.errors;
    EXPECT_EQ(readFile(folder / "p.html").find("<title><script>&"), std::string::npos);
    const auto missing = runCommand({commandPath().string(), "graph", (folder / ("no" + name)).string()});
    EXPECT_EQ(missing.exit_code, 2);
    expectPrintable(missing.errors);
  }
}

TEST(OddNames, OfCorners) {
  for (const std::string& name : odd_names) {
    const TemporaryFolder folder;
    const calib::testing::Files files;
    writeFile(folder / name, "# image_size_px: 640 x 480\n# photo 1: \xFF\x1b]0;x\x07\n" + files.left);
    const auto result =
        runCommand({commandPath().string(), "calibrate", "--camera", "left=" + (folder / name).string(),
                    "--intrinsics", "radial1", "--json", (folder / "r.json").string(), "--report",
                    (folder / "r.html").string(), "--output", (folder / "r.yaml").string()});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    expectPrintable(result.output);
    EXPECT_TRUE(nlohmann::json::accept(readFile(folder / "r.json")));
    EXPECT_EQ(readFile(folder / "r.html").find("<title><script>&"), std::string::npos);
    const std::string page = readFile(folder / "r.html");
    EXPECT_EQ(page.find('\x1b'), std::string::npos);
    EXPECT_EQ(page.find('\xFF'), std::string::npos);
  }
}

TEST(OddNames, ThatSpanLinesStayInTheirs) {
  const TemporaryFolder folder;
  const std::string name = "a\nFORGED\n\t\r", file = folder / name;
  const calib::testing::Files files;
  writeFile(file, graph);
  for (const std::string command : {"graph", "bundle", "replay"}) {
    const auto missing = runCommand({commandPath().string(), command, file + "2"});
    EXPECT_EQ(missing.exit_code, 2);
    expectEscaped(missing.errors);
  }
  const auto fitted = runCommand({commandPath().string(), "graph", file, "--output", file + ".g2o"});
  EXPECT_EQ(fitted.exit_code, 0) << fitted.errors;
  expectEscaped(fitted.output);
  writeFile(file, "# photo 2: b\x1b\tFORGED\n" + files.left);
  const auto calibrated = runCommand({commandPath().string(), "calibrate", "--camera", "left=" + file,
                                      "--intrinsics", "radial1", "--json", file + ".json"});
  EXPECT_EQ(calibrated.exit_code, 0) << calibrated.errors;
  expectEscaped(calibrated.output);
  const auto refused =
      runCommand({commandPath().string(), "calibrate", "--camera", "left=" + file, "--json", file});
  EXPECT_EQ(refused.exit_code, 2);
  expectEscaped(refused.errors);
  const auto wrong =
      runCommand({commandPath().string(), "calibrate", "--camera", "left=" + file, "--sigma-px", file});
  EXPECT_EQ(wrong.exit_code, 2);
  expectEscaped(wrong.errors);
}

TEST(OddNames, OfScenesAndProblems) {
  for (const std::string& name : odd_names) {
    const TemporaryFolder folder;
    writeFile(folder / name, "x");
    for (const std::string command : {"bundle", "replay"}) {
      const auto result = runCommand({commandPath().string(), command, (folder / name).string()});
      EXPECT_EQ(result.exit_code, 2);
      expectPrintable(result.errors);
    }
  }
}

/// `command` of the shell, with $0 the program and $1 a graph.
CommandResult inShell(const std::string& command) {
  const TemporaryFolder folder;
  writeFile(folder / "map.g2o", graph);
  CommandResult result = runCommand({"/usr/bin/env", "-C", folder.path().string(), "/bin/sh", "-c", command,
                                     commandPath().string(), "map.g2o"});
  if (std::filesystem::exists(folder / "fitted.g2o")) {
    EXPECT_EQ(readFile(folder / "fitted.g2o").find("graph in"), std::string::npos);
  }
  return result;
}

TEST(LostOutput, IsAFailure) {
  const std::string lost = "slom: standard output could not be written";
  for (const std::string command :
       {"\"$0\" graph \"$1\" --quiet --json - >/dev/full", "\"$0\" graph \"$1\" >/dev/full",
        "\"$0\" graph \"$1\" >&-", "\"$0\" graph \"$1\" --output fitted.g2o >&- <&-",
        "\"$0\" --help >/dev/full", "\"$0\" --version >/dev/full"}) {
    const CommandResult result = inShell(command);
    EXPECT_EQ(result.exit_code, 1) << command;
    EXPECT_TRUE(result.errors.starts_with(lost)) << command << "\n" << result.errors;
    EXPECT_NE(result.errors.find("; redirect it to a writable file, or pass --quiet\n"), std::string::npos)
        << result.errors;
  }
}

TEST(LostOutput, IsNoFailureWhereThereIsNone) {
  EXPECT_EQ(inShell("\"$0\" graph \"$1\" --quiet --output fitted.g2o >&-").exit_code, 0);
  EXPECT_EQ(inShell("\"$0\" graph \"$1\" --quiet >/dev/full 2>/dev/full").exit_code, 0);
}

TEST(LostOutput, ErrorsKeepTheirExitCode) {
  EXPECT_EQ(inShell("\"$0\" graph missing >/dev/full 2>/dev/full").exit_code, 2);
  EXPECT_EQ(inShell("\"$0\" graph missing >&- 2>&-").exit_code, 2);
  EXPECT_EQ(inShell("\"$0\" graph >&- 2>&- <&-").exit_code, 2);
}

}  // namespace
}  // namespace slom::app
