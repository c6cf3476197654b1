#include "fitting/words.hpp"

#include <array>
#include <string_view>

namespace slom::app {

namespace {

struct Phrase {
  std::string_view library, command;
};

constexpr std::array<Phrase, 11> phrases{{
    {"derivatives may be wrong (slom::checkDerivatives(est) compares them with differences), residuals may jump",
     "residuals may jump"},
    {" (slom::checkDerivatives(est) compares them with differences)", ""},
    {", pass a larger scale, or set Options::graduated_non_convexity", " or pass a larger scale to --robust"},
    {"fix a variable with fix(id) or a part of it with fix(id, \"path\"), or use LevenbergMarquardt to get one "
     "of the many solutions",
     "fix a variable in the file, or pass --algorithm lm to get one of the many solutions"},
    {"fix it with fix(id)", "fix it in the file"},
    {"start nearer, or use LevenbergMarquardt", "start nearer, or pass --algorithm lm"},
    {"; slom::outliers(est) names the worst data, Sigma::estimated takes the scale from the residuals", ""},
    {"; slom::diagnose(est) lists what is not determined", "; add measurements"},
    {", or BlockQR, which needs", ", or --solver qr, which needs"},
    {"; raise max_iterations", "; raise --max-iterations"},
    {"optimize()", "the batch fit"},
}};

}  // namespace

std::string inWordsOfTheCommand(std::string sentence) {
  for (const auto& [library, command] : phrases) {
    for (std::size_t at = 0; (at = sentence.find(library, at)) != std::string::npos; at += command.size())
      sentence.replace(at, library.size(), command);
  }
  return sentence;
}

void putIntoWordsOfTheCommand(Summary& summary) {
  summary.message = inWordsOfTheCommand(summary.message);
  constexpr const char* remedy = "; raise --max-iterations";
  if (summary.stop_reason == StopReason::max_iterations && summary.message.find(remedy) == std::string::npos)
    summary.message += remedy;
  for (auto* const texts : {&summary.warnings, &summary.undetermined}) {
    for (std::string& text : *texts) text = inWordsOfTheCommand(text);
  }
}

}  // namespace slom::app
