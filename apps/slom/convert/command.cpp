// `slom convert`: a text file becomes a container, a container becomes a text file.
#include <cstdio>
#include <memory>
#include <string>

#include <fmt/format.h>

#include <slom/io/convert.hpp>

#include "convert/convert.hpp"
#include "fitting/console.hpp"
#include "output_files.hpp"
#include "printable.hpp"
#include "text.hpp"

namespace slom::app {
namespace convert {
namespace {

constexpr const char* help_text =
    R"(slom convert city.g2o city.slomb

Convert a pose graph or scene to a binary container, or back to text.
slom graph and slom bundle read both. Several processes read a container faster, each its own part.
Every number keeps its bits; the memory needed does not grow with the file.
)";

struct Settings {
  std::string input, output;
  bool quiet = false;
};

/// Returns the numbers of records.
std::string contentText(const io::Container& container) {
  const bool is_graph = container.content() == io::ContainerContent::graph;
  std::string text = is_graph ? "pose graph\n" : "bundle adjustment\n";
  for (const io::ContainerSection& section : container.sections()) {
    const auto count = std::size_t(section.count);
    text +=
        "  " + (is_graph ? fmt::format("{} {}", count, section.name) : plural(count, section.name)) + "\n";
  }
  return text;
}

void run(const Settings& settings) {
  const Console console(ReportOptions{"", settings.quiet});
  checkResultPaths({{"IN", settings.input}}, {{"OUT", settings.output}});
  const bool is_container = io::isContainer(settings.input);
  OutputFiles files;
  files.open(settings.output);
  if (is_container) {
    const io::Container container(settings.input);
    console.print(contentText(container));
    io::readAsText(container, [&](std::string_view piece) { files.append(piece); });
  } else {
    const io::UnknownTags unknown = io::writeContainer(settings.input, files.descriptor(), settings.output);
    for (const std::string& sentence : unknown.sentences()) console.print("warning: " + sentence + "\n");
  }
  files.close();
  files.commit();
  if (!is_container) console.print(contentText(io::Container(settings.output)));
  console.print(fmt::format("written: {}\n", oneLine(settings.output)));
}

}  // namespace
}  // namespace convert

void addConvertCommand(CLI::App& app) {
  const auto settings = std::make_shared<convert::Settings>();
  CLI::App& command = *app.add_subcommand("convert", convert::help_text);
  command.footer("Exit code: 0 success; 2 wrong options or data.");
  command.add_option("IN", settings->input, "pose graph (g2o, TORO) or scene (BAL) as text, or a container")
      ->required()
      ->type_name("");
  command.add_option("OUT", settings->output, "container of a text file, or text of a container")
      ->required()
      ->type_name("");
  command.add_flag("--quiet", settings->quiet, "print nothing");
  command.callback([settings] { convert::run(*settings); });
}

}  // namespace slom::app
