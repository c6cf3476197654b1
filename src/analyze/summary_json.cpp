// A summary as JSON (RFC 8259), written by hand so that the library needs no JSON library.
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "slom/optimize/summary.hpp"

namespace slom {

namespace {

/// Returns the number of bytes of the UTF-8 character (RFC 3629) that begins the text; 0 if there is none.
std::size_t lengthOfCharacter(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  const std::size_t length = first < 0x80                     ? 1
                             : first >= 0xC2 && first <= 0xDF ? 2
                             : first >= 0xE0 && first <= 0xEF ? 3
                             : first >= 0xF0 && first <= 0xF4 ? 4
                                                              : 0;
  if (length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return 0;
  }
  // Excluded are overlong forms, surrogates, and code points beyond U+10FFFF.
  const bool is_excluded =
      length > 2 && ((first == 0xE0 && byte(1) < 0xA0) || (first == 0xED && byte(1) > 0x9F) ||
                     (first == 0xF0 && byte(1) < 0x90) || (first == 0xF4 && byte(1) > 0x8F));
  return is_excluded ? 0 : length;
}

/// Returns the text in quotes. Bytes that are not UTF-8 become U+FFFD.
std::string jsonText(std::string_view text) {
  constexpr char digits[] = "0123456789abcdef";
  std::string json = "\"";
  while (!text.empty()) {
    const std::size_t length = lengthOfCharacter(text);
    const char c = text[0];
    if (length == 0) {
      json += "\xEF\xBF\xBD";
    } else if (c == '"' || c == '\\') {
      json += {'\\', c};
    } else if (static_cast<unsigned char>(c) < 0x20) {
      json += "\\u00";
      json += {digits[static_cast<unsigned char>(c) / 16], digits[static_cast<unsigned char>(c) % 16]};
    } else {
      json += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return json + "\"";
}

/// Writes x with the digits that give the same double again; null if x is not finite.
std::string jsonNumber(double x) {
  if (!std::isfinite(x)) return "null";
  if (x == 0) return std::signbit(x) ? "-0.0" : "0";
  char text[40];
  return {text, std::to_chars(text, text + sizeof text, x).ptr};
}

/// Builder of the members of an object or the entries of an array.
class JsonList {
 public:
  explicit JsonList(char open, char close) : text_(1, open), close_(close) {}
  void addRaw(const std::string& json) {
    if (text_.size() > 1) text_ += ", ";
    text_ += json;
  }
  JsonList& add(const char* key, const std::string& json) {
    addRaw(jsonText(key) + ": " + json);
    return *this;
  }
  JsonList& add(const char* key, double x) { return add(key, jsonNumber(x)); }
  JsonList& add(const char* key, int x) { return add(key, std::to_string(x)); }
  std::string text() const { return text_ + close_; }

 private:
  std::string text_;
  char close_;
};

JsonList jsonObject() { return JsonList('{', '}'); }

/// Returns an array of f(entry).
template <class T, class F>
std::string jsonArray(const std::vector<T>& entries, const F& f) {
  JsonList array('[', ']');
  for (const T& entry : entries) array.addRaw(f(entry));
  return array.text();
}
std::string jsonTexts(const std::vector<std::string>& texts) { return jsonArray(texts, jsonText); }

std::string jsonOf(const LossSummary& loss) {
  return jsonObject()
      .add("loss", jsonText(loss.loss))
      .add("measurements", loss.measurements)
      .add("down_weighted", loss.down_weighted)
      .add("weightless", loss.weightless)
      .text();
}

std::string jsonOf(const GroupSummary& group) {
  return jsonObject()
      .add("name", jsonText(group.name))
      .add("measurements", group.measurements)
      .add("residuals", group.residuals)
      .add("initial_rss", group.initial_rss)
      .add("final_rss", group.final_rss)
      .add("redundancy", group.redundancy < 0 ? "null" : jsonNumber(group.redundancy))
      .add("derivatives", jsonText(group.derivatives))
      .add("losses", jsonArray(group.losses, [](const LossSummary& loss) { return jsonOf(loss); }))
      .text();
}

std::string jsonOf(const ParameterSummary& parameter) {
  JsonList json = jsonObject();
  json.add("name", jsonText(parameter.name))
      .add("value", parameter.value)
      .add("std", parameter.standard_deviation);
  if (!parameter.text.empty()) json.add("text", jsonText(parameter.text));
  if (!std::isnan(parameter.clustered)) {
    json.add("clustered", parameter.clustered);
    json.add("clustered_dof", parameter.clustered_dof);
  }
  return json.text();
}

std::string jsonOf(const CorrelationSummary& pair) {
  return jsonObject()
      .add("a", jsonText(pair.a))
      .add("b", jsonText(pair.b))
      .add("correlation", pair.correlation)
      .text();
}

std::string jsonOf(const IterationRecord& record) {
  return jsonObject()
      .add("iteration", record.iteration)
      .add("algorithm", jsonText(record.algorithm))
      .add("rss", record.rss)
      .add("relative_decrease", record.relative_decrease)
      .add("gradient", record.gradient)
      .add("step", record.step)
      .add("damping", record.damping)
      .add("trials", record.trials)
      .add("graduation", record.graduation)
      .add("seconds", record.seconds)
      .text();
}

std::string secondsJson(const Summary& summary) {
  return jsonObject()
      .add("setup", summary.phases.setup)
      .add("linearize", summary.phases.linearize)
      .add("factorize", summary.phases.factorize)
      .add("solve", summary.phases.solve)
      .add("total", summary.seconds)
      .text();
}

}  // namespace

std::string Summary::json() const {
  const auto each = [](const auto& entry) { return jsonOf(entry); };
  return jsonObject()
      .add("converged", converged ? "true" : "false")
      .add("stop_reason", jsonText(toString(stop_reason)))
      .add("message", jsonText(message))
      .add("warnings", jsonTexts(warnings))
      .add("algorithm", jsonText(algorithm))
      .add("solver", jsonText(solver))
      .add("iterations", iterations)
      .add("stages", stages)
      .add("variables", variables)
      .add("measurements", measurements)
      .add("unknowns", unknowns)
      .add("free_directions", free_directions)
      .add("free_network", is_free_network)
      .add("redundancy", redundancy)
      .add("initial_rss", initial_rss)
      .add("final_rss", final_rss)
      .add("chi2_per_dof", chi2PerDof())
      .add("sigma", jsonText(sigma_is_estimated ? "estimated" : "known"))
      .add("stated_noise", jsonText(stated_noise == StatedNoise::all    ? "all"
                                    : stated_noise == StatedNoise::some ? "some"
                                                                        : "none"))
      .add("seconds", secondsJson(*this))
      .add("groups", jsonArray(groups, each))
      .add("parameters", jsonArray(parameters, each))
      .add("undetermined", jsonTexts(undetermined))
      .add("parameters_not_shown", parameters_not_shown)
      .add("clustered_notes", jsonTexts(clustered_notes))
      .add("correlations", jsonArray(correlations, each))
      .add("correlations_not_shown", correlations_not_shown)
      .add("active_bounds", jsonTexts(active_bounds))
      .add("trace", jsonArray(trace, each))
      .text();
}

}  // namespace slom
