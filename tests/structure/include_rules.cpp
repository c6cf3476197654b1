#include "structure/include_rules.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <set>

namespace slom::testing {

namespace {

namespace fs = std::filesystem;

// Levels: mtk, then the steps in the order of the data flow, then the facade, then rooms that stand on it.
constexpr std::array<const char*, 12> kLevels{"mtk",          "base",    "model",    "filter",
                                              "measurements", "problem", "tape",     "linearize",
                                              "solve",        "online",  "optimize", "analyze"};
constexpr int kMtk = 0;
constexpr int kMeasurements = 4;
constexpr int kFacade = static_cast<int>(kLevels.size());
constexpr int kTrajectory = kFacade + 1;
constexpr int kInitialize = kFacade + 2;
constexpr int kIo = kFacade + 3;  // libraries of their own
constexpr int kDistributed = kFacade + 4;
constexpr int kCalibration = kFacade + 5;

std::string levelName(int level) {
  return level == kFacade        ? "the facade"
         : level == kTrajectory  ? "trajectory"
         : level == kInitialize  ? "initialize"
         : level == kIo          ? "io"
         : level == kDistributed ? "distributed"
         : level == kCalibration ? "calibration"
                                 : kLevels[static_cast<std::size_t>(level)];
}

/// Returns the level of the file `<step>/...` or, for a name without folder, of the facade. The facade's own rooms are
/// `estimator` and `archive`.
std::optional<int> levelBelowSlom(const fs::path& path) {
  if (path.begin()->stem() == "estimator" || path.begin()->stem() == "archive") return kFacade;
  if (path.begin()->stem() == "trajectory") return kTrajectory;
  if (path.begin()->stem() == "initialize") return kInitialize;
  if (path.begin()->stem() == "io") return kIo;
  if (path.begin()->stem() == "distributed") return kDistributed;
  if (path.begin()->stem() == "calibration") return kCalibration;
  if (std::next(path.begin()) == path.end()) return kFacade;
  const auto step = std::find(kLevels.begin() + 1, kLevels.end(), path.begin()->string());
  if (step == kLevels.end()) return std::nullopt;
  return static_cast<int>(step - kLevels.begin());
}

bool startsWith(const std::string& text, const std::string& beginning) {
  return text.rfind(beginning, 0) == 0;
}

/// Level of a file of the tree, by its path from the root.
std::optional<int> levelOf(const fs::path& path) {
  const std::string name = path.generic_string();
  if (startsWith(name, "include/mtk/")) return kMtk;
  if (startsWith(name, "include/slom/")) return levelBelowSlom(fs::path(name.substr(13)));
  if (startsWith(name, "src/")) return levelBelowSlom(fs::path(name.substr(4)));
  return std::nullopt;
}

struct Include {
  std::string name;
  bool quoted;
};

std::optional<Include> parseInclude(const std::string& line) {
  static const std::regex pattern(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
  std::smatch match;
  if (!std::regex_search(line, match, pattern)) return std::nullopt;
  return Include{match[2], match[1] == "\""};
}

/// Returns the included file as a path from the root, if it is one of the project's.
std::optional<fs::path> projectFile(const fs::path& root, const fs::path& file, const Include& include) {
  if (startsWith(include.name, "mtk/") || startsWith(include.name, "slom/"))
    return fs::path("include") / include.name;
  if (include.quoted) {
    const fs::path beside = (file.parent_path() / include.name).lexically_normal();
    if (fs::exists(root / beside)) return beside;
    if (fs::exists(root / "src" / include.name)) return (fs::path("src") / include.name).lexically_normal();
  }
  if (fs::exists(root / include.name)) return fs::path(include.name).lexically_normal();
  return std::nullopt;
}

bool isStandardHeader(const std::string& name) {
  return name.find('/') == std::string::npos && name.find('.') == std::string::npos;
}
bool isEigen(const std::string& name) {
  return startsWith(name, "Eigen/") || startsWith(name, "unsupported/Eigen/");
}
bool isTbb(const std::string& name) { return startsWith(name, "tbb/") || startsWith(name, "oneapi/tbb"); }
bool isOfTheCommandAlone(const std::string& name) {
  return startsWith(name, "fmt/") || startsWith(name, "CLI/") || startsWith(name, "opencv") ||
         name.find("json") != std::string::npos;
}

/// Returns the rule that the include breaks; empty if it breaks none.
std::string brokenRule(const fs::path& root, const fs::path& file, int level, const Include& include) {
  const bool is_public = startsWith(file.generic_string(), "include/");
  if (const auto target = projectFile(root, file, include)) {
    if (startsWith(target->generic_string(), "apps/")) return "nobody includes apps/";
    const auto target_level = levelOf(*target);
    if (!target_level) return "not a file of include/ or of a folder of the data flow";
    if (*target_level > level) {
      return levelName(level) + " may include only what stands above it, " + levelName(*target_level) +
             " stands below";
    }
    if (*target_level == kMeasurements && level != kMeasurements && level < kFacade)
      return "only the facade and users include measurements";
    if (is_public && startsWith(target->generic_string(), "src/"))
      return "a public header includes public headers";
    if (level >= kIo && *target_level != level && startsWith(target->generic_string(), "src/"))
      return levelName(level) + " is a user of the library, whose src/ is its own";
    return "";
  }
  if (include.quoted) return "no such file of the project";
  if (include.name == "iostream" && is_public) return "a public header holds no <iostream>";
  if (level >= kIo && !is_public && startsWith(include.name, "fmt/")) return "";
  if (isOfTheCommandAlone(include.name)) return "the libraries do without it, only the command may use it";
  if (isStandardHeader(include.name) || isEigen(include.name)) return "";
  if (level == kMtk) return "mtk uses Eigen alone";
  if (isTbb(include.name))
    return file.generic_string() == "src/base/threads.hpp" ? "" : "oneTBB is behind base/threads.hpp";
  if (is_public) return "a public header needs no other library than Eigen";
  return "";
}

// ---- the command -----------------------------------------------------------------------------------------

const fs::path kCommand = "apps/slom";

/// Returns the part that a file of the command belongs to: the shared parts ("": beside main.cpp, and "fitting"), or a
/// subcommand.
std::string partOf(const fs::path& path) {
  const fs::path inside = path.lexically_relative(kCommand);
  return std::next(inside.begin()) == inside.end() ? "" : inside.begin()->string();
}

/// Returns the rule of the command that the include breaks; empty if it breaks none.
std::string brokenRuleOfCommand(const fs::path& root, const fs::path& file, const Include& include) {
  if (startsWith(include.name, "slom/") || startsWith(include.name, "mtk/")) return "";
  const bool is_own = include.quoted && fs::exists(root / kCommand / include.name);
  if (!is_own && fs::exists(root / "src" / include.name))
    return "the command is a user of the library, whose src/ is its own";
  if (!include.quoted) return "";
  if (!is_own) return "no such file of the command; name it by its path from apps/slom";
  const std::string own = partOf(file), other = partOf(kCommand / include.name);
  if (own == other || other.empty() || file == kCommand / "main.cpp") return "";
  if (other == "fitting" && !own.empty()) return "";
  if (own.empty() || own == "fitting") return "what subcommands share includes none of them";
  return own + " may not include another subcommand";
}

using Edges = std::map<std::string, std::set<std::string>>;

/// Returns a circle of folders that include each other, with the first folder again at the end; empty if there is none.
std::vector<std::string> circleFrom(const std::string& folder, const Edges& edges,
                                    std::vector<std::string>& path, std::set<std::string>& done) {
  const auto seen = std::find(path.begin(), path.end(), folder);
  if (seen != path.end()) {
    std::vector<std::string> circle(seen, path.end());
    circle.push_back(folder);
    return circle;
  }
  if (!done.insert(folder).second) return {};
  path.push_back(folder);
  if (const auto found = edges.find(folder); found != edges.end()) {
    for (const std::string& next : found->second) {
      if (auto circle = circleFrom(next, edges, path, done); !circle.empty()) return circle;
    }
  }
  path.pop_back();
  return {};
}

void checkCommand(const fs::path& root, const fs::path& file, IncludeReport& report, Edges& edges) {
  ++report.files;
  std::ifstream stream(root / file);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const auto include = parseInclude(line);
    if (!include) continue;
    const std::string rule = brokenRuleOfCommand(root, file, *include);
    if (!rule.empty()) {
      report.violations.push_back(file.generic_string() + ":" + std::to_string(number) + ": includes " +
                                  include->name + ": " + rule);
    }
    // Files beside a subcommand's folders are above or below any of these.
    const fs::path target = (kCommand / include->name).parent_path(), own = file.parent_path();
    const auto depth = [](const fs::path& path) { return std::distance(path.begin(), path.end()); };
    if (include->quoted && depth(own) > 3 && depth(target) > 3 && own != target)
      edges[own.generic_string()].insert(target.generic_string());
  }
}

/// Benchmarks are users of the libraries, too.
void checkBenchmark(const fs::path& root, const fs::path& file, IncludeReport& report) {
  ++report.files;
  std::ifstream stream(root / file);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const auto include = parseInclude(line);
    if (!include || !include->quoted) continue;
    const bool is_own = fs::exists(root / "bench" / include->name) ||
                        fs::exists(root / "tests" / include->name) ||
                        fs::exists(root / file.parent_path() / include->name);
    if (is_own) continue;
    const std::string rule = fs::exists(root / kCommand / include->name)
                                 ? "a benchmark is a user of the libraries, not of the command"
                                 : "no such file of bench/ or tests/";
    report.violations.push_back(file.generic_string() + ":" + std::to_string(number) + ": includes " +
                                include->name + ": " + rule);
  }
}

/// Rooms below src/ do not include each other in a circle.
void addEdge(const fs::path& root, const fs::path& file, const Include& include, Edges& edges) {
  if (!include.quoted || !startsWith(file.generic_string(), "src/") ||
      !fs::exists(root / "src" / include.name))
    return;
  const fs::path own = file.parent_path(), target = (fs::path("src") / include.name).parent_path();
  if (own != target) edges[own.generic_string()].insert(target.generic_string());
}

void checkFile(const fs::path& root, const fs::path& file, IncludeReport& report, Edges& edges) {
  ++report.files;
  const auto level = levelOf(file);
  if (!level) {
    report.violations.push_back(file.generic_string() + ":1: its folder is not a step of the data flow");
    return;
  }
  std::ifstream stream(root / file);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const auto include = parseInclude(line);
    if (!include) continue;
    addEdge(root, file, *include, edges);
    const std::string rule = brokenRule(root, file, *level, *include);
    if (rule.empty()) continue;
    report.violations.push_back(file.generic_string() + ":" + std::to_string(number) + ": includes " +
                                include->name + ": " + rule);
  }
}

}  // namespace

IncludeReport checkIncludes(const fs::path& root) {
  IncludeReport report;
  Edges edges;
  for (const char* folder : {"include", "src"}) {
    if (!fs::exists(root / folder)) continue;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension();
      if (extension == ".hpp" || extension == ".cpp")
        checkFile(root, entry.path().lexically_relative(root), report, edges);
    }
  }
  if (fs::exists(root / kCommand)) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / kCommand)) {
      const std::string extension = entry.path().extension();
      if (extension == ".hpp" || extension == ".cpp")
        checkCommand(root, entry.path().lexically_relative(root), report, edges);
    }
  }
  if (fs::exists(root / "bench")) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / "bench")) {
      const std::string extension = entry.path().extension();
      if (extension == ".hpp" || extension == ".cpp")
        checkBenchmark(root, entry.path().lexically_relative(root), report);
    }
  }
  std::set<std::string> done;
  for (const auto& [folder, targets] : edges) {
    std::vector<std::string> path;
    const std::vector<std::string> circle = circleFrom(folder, edges, path, done);
    if (circle.empty()) continue;
    std::string text = "folders include each other in a circle: " + circle.front();
    for (std::size_t i = 1; i < circle.size(); ++i) text += " -> " + circle[i];
    report.violations.push_back(text);
  }
  std::sort(report.violations.begin(), report.violations.end());
  return report;
}

}  // namespace slom::testing
