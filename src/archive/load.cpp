/// Loading: a problem from its text.
#include <cctype>
#include <charconv>
#include <deque>
#include <istream>
#include <locale>
#include <sstream>
#include <system_error>

#include "archive/described.hpp"
#include "archive/tape_text.hpp"
#include "archive/text.hpp"
#include "base/index.hpp"
#include "base/words.hpp"
#include "model/runtime_store.hpp"
#include "slom/archive.hpp"
#include "slom/problem/group_table.hpp"
#include "slom/tape/measurement.hpp"

namespace slom {

using archive_text::inQuotes, archive_text::isAtEnd, archive_text::kFirstWords, archive_text::kVersion;

namespace {

/// Reads a number, which may be infinite, such as a bound or Barron's shape.
bool readNumber(std::istream& is, double& x) {
  std::string word;
  if (!(is >> word)) return false;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
  return error == std::errc() && end == word.data() + word.size();
}

/// Returns a hint about numbers written with a decimal comma, as some languages' locales do; otherwise empty.
std::string commaIn(const std::string& text) {
  const auto is_digit = [&](std::size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
  for (std::size_t comma = text.find(','); comma != std::string::npos; comma = text.find(',', comma + 1)) {
    if (comma > 0 && is_digit(comma - 1) && is_digit(comma + 1))
      return "; the number has a decimal comma, as programs with such a locale write; use decimal points";
  }
  return "";
}

}  // namespace

class ArchiveReader {
 public:
  ArchiveReader(const Archive& archive, std::istream& is, const std::string& source)
      : archive_(archive), is_(is), source_(source) {
    line_.imbue(std::locale::classic());
    rest_.imbue(std::locale::classic());
  }

  StoredProblem read() {
    readFirstLine();
    while (nextLine()) {
      if (text_ == "end") {
        if (nextLine()) raise("there is text after the line \"end\"; remove it");
        result_.sortNames();
        return std::move(result_);
      }
      readLine();
    }
    raiseIncomplete();
  }

 private:
  /// A tape of the file.
  struct StoredTape {
    tape::Tape tape;
    std::shared_ptr<const TracedKind> kind{};  // set by its first measurement
  };

  [[noreturn]] void raiseIncomplete() const {
    throw Error(
        "slom.bad-archive",
        source_ + " is not complete: its last line is not \"end\"; take a file that was written to its end",
        source_);
  }
  [[noreturn]] void raise(const std::string& what) const {
    throw Error("slom.bad-archive", source_ + ":" + std::to_string(line_number_) + ": " + what,
                source_ + ":" + std::to_string(line_number_));
  }

  /// Reads the next line. Skips blank lines and lines that begin with #.
  bool nextLine() {
    while (std::getline(is_, text_)) {
      ++line_number_;
      if (!text_.empty() && text_.back() == '\r') text_.pop_back();
      if (text_.find_first_not_of(" \t") == std::string::npos || text_[0] == '#') continue;
      line_.clear();
      line_.str(text_);
      return true;
    }
    return false;
  }

  void readFirstLine() {
    std::string first, second;
    int version = 0;
    if (!nextLine() || !(line_ >> first >> second >> version) || first + " " + second != kFirstWords) {
      line_number_ = std::max(line_number_, 1);
      raise(std::string("this is not a saved problem: its first line is not \"") + kFirstWords + " " +
            std::to_string(kVersion) + "\"");
    }
    if (version != kVersion) {
      raise("the problem is saved in version " + std::to_string(version) +
            " of the format, but this program reads version " + std::to_string(kVersion) +
            "; use a newer "
            "program");
    }
  }

  void readLine() {
    if (text_[0] == '"') return readVariable();
    if (text_[0] >= '0' && text_[0] <= '9') return readMeasurement();
    std::string word;
    line_ >> word;
    if (word == "variables") return readVariableKind();
    if (word == "measurements") return readMeasurementKind();
    if (word == "tape") return readTape();
    if (word == "fix") return readConstraint(false);
    if (word == "bound") return readConstraint(true);
    if (word == "sigma" || word == "gauge") return readChoice(word);
    raise("a line cannot begin with " + inQuotes(word) +
          "; it begins with a quoted name, a number, variables, fix, bound, "
          "tape, measurements, sigma, gauge or end");
  }

  void readChoice(const std::string& word) {
    std::string choice;
    line_ >> choice;
    if (word == "sigma" && choice == "estimated") return result_.estimator.setSigma(Sigma::estimated);
    if (word == "gauge" && choice == "inner-constraints")
      return result_.estimator.setFreeGauge(FreeGauge::inner_constraints);
    raise(word == "sigma" ? "write \"sigma estimated\", or nothing for stated ones"
                          : "write \"gauge inner-constraints\", or nothing for an error at a free gauge");
  }

  template <class Kinds>
  const auto* kindNamed(const Kinds& kinds, const std::string& name, const char* what) const {
    for (const auto& kind : kinds) {
      if (kind.name == name) return &kind;
    }
    std::vector<std::string> known;
    for (const auto& kind : kinds) known.push_back(inQuotes(kind.name));
    raise(std::string(what) + " " + inQuotes(name) + " are not known to this program" +
          (known.empty() ? "" : ", which knows " + listed(known, known.size())) +
          "; a program that includes slom/archive.hpp can register more");
  }

  void readVariableKind() {
    std::string name, word;
    if (!(line_ >> std::quoted(name))) raise("write variables \"TYPE\"");
    if (isAtEnd(line_)) {
      variable_kind_ = kindNamed(archive_.variables_, name, "variables");
      return;
    }
    line_ >> word;
    const bool may_be_registered = word == "or";
    if (may_be_registered) line_ >> word;
    std::shared_ptr<const RuntimeType> type;
    if (word == "fields") withLine([&] { type = archive_text::readType(line_, name); });
    if (type == nullptr) {
      raise(
          "write variables \"TYPE\" fields or variables \"TYPE\" or fields, then for each field its \"NAME\" and "
          "number, vector N, so2, so3, s2, se2 or se3");
    }
    if (may_be_registered) {
      for (const detail::StoredVariable& kind : archive_.variables_) {
        detail::TracedType known{typeid(void), {}, {}};
        if (kind.name != name || !kind.describe(kind, known)) continue;
        if (!archive_text::areAlike(known.parts, tape::typeOf(*type))) continue;
        variable_kind_ = &kind;
        return;
      }
    }
    described_.push_back(
        archive_text::describedVariable(name, typeid(RuntimeStore), type, tape::layoutOf(*type)));
    variable_kind_ = &described_.back();
  }

  void readVariable() {
    std::string name, state;
    if (variable_kind_ == nullptr) raise("a variable comes before the first line that begins with variables");
    if (!(line_ >> std::quoted(name) >> state) || (state != "free" && state != "fixed")) {
      raise("write \"NAME\" free VALUE or \"NAME\" fixed VALUE");
    }
    const detail::StoredVariable& kind = *variable_kind_;
    VariableHandle id;
    bool is_good = false;
    withLine([&] { is_good = kind.read(kind, rest(), nullptr, true, "", id); });
    if (!is_good || !isAtEnd(rest_)) {
      raise("variable " + inQuotes(name) + " has no value that is a " + kind.name + ":" + rest_.str() +
            commaIn(rest_.str()));
    }
    kind.read(kind, restAgain(), &problem(), state == "free", name, id);
    result_.entries_.push_back({name, kind.type, id});
    variable_kinds_.push_back(&kind);
    indices_.push_back(static_cast<int>(problem().variables().size()) - 1);
  }

  int readVariableNumber() {
    long number = -1;
    if (!(line_ >> number)) raise("the number of a variable is missing here");
    if (number < 0 || number >= static_cast<long>(indices_.size())) {
      raise("there is no variable " + std::to_string(number) +
            (indices_.empty() ? "; no variable is defined above"
                              : "; defined above are 0 to " + std::to_string(indices_.size() - 1)));
    }
    return static_cast<int>(number);
  }

  void readConstraint(bool is_bound) {
    const int variable = indices_[at(readVariableNumber())];
    std::string component;
    double lower = 0, upper = 0;
    if (!(line_ >> std::quoted(component)) ||
        (is_bound && !(readNumber(line_, lower) && readNumber(line_, upper))) || !isAtEnd(line_)) {
      raise((is_bound ? "write bound NUMBER \"COMPONENT\" LOWER UPPER" : "write fix NUMBER \"COMPONENT\"") +
            commaIn(text_));
    }
    withLine([&] {
      const std::vector<int> components = problem().componentsAt(variable, component);
      is_bound ? problem().setBound(variable, components, lower, upper)
               : problem().setFixed(variable, components, true);
    });
  }

  void readTape() {
    int version = 0;
    if (!(line_ >> version) || !isAtEnd(line_)) raise("write tape VERSION");
    if (version != archive_text::kTapeVersion) {
      raise("the tape is saved in version " + std::to_string(version) +
            " of the format of tapes, but this program reads version " +
            std::to_string(archive_text::kTapeVersion) + "; use a newer program");
    }
    archive_text::TapeReader reader;
    for (bool is_last = false; !is_last;) {
      if (!nextLine()) raiseIncomplete();
      withLine([&] { is_last = reader.take(text_); });
    }
    withLine([&] { tapes_.push_back({reader.finish()}); });
  }

  void readMeasurementKind() {
    line_ >> std::ws;
    const bool is_traced = line_.peek() == 't';
    std::string name;
    int number = -1;
    if (is_traced ? !(line_ >> name >> number) || name != "tape" : !(line_ >> std::quoted(name)))
      raise("write measurements \"TYPE\" \"LABEL\" or measurements tape NUMBER \"LABEL\"");
    if (!(line_ >> std::quoted(options_.label)) || !isAtEnd(line_))
      raise("write measurements \"TYPE\" \"LABEL\" or measurements tape NUMBER \"LABEL\"");
    tape_ = nullptr;
    if (!is_traced) {
      measurement_kind_ = kindNamed(archive_.measurements_, name, "measurements");
    } else if (number >= 0 && number < static_cast<int>(tapes_.size())) {
      tape_ = &tapes_[at(number)];
    } else {
      raise("there is no tape " + std::to_string(number) +
            (tapes_.empty() ? "; no tape is defined above"
                            : "; defined above are 0 to " + std::to_string(tapes_.size() - 1)));
    }
  }

  void readMeasurement() {
    if (tape_ != nullptr) return readTraced();
    if (measurement_kind_ == nullptr)
      raise("a measurement comes before the first line that begins with measurements");
    handles_.clear();
    kinds_.clear();
    if (measurement_kind_->is_list) readList();
    for (const std::type_index type : measurement_kind_->variables) {
      const int number = readVariableNumber();
      if (variable_kinds_[at(number)]->type != type)
        raiseWrongType(number, measurement_kind_->name, archive_.findVariable(type)->name);
      handles_.push_back(result_.entries_[at(number)].handle);
    }
    expectBar("the numbers of " + counted(static_cast<int>(handles_.size()), "variable"));
    readOptions();
    const int count = static_cast<int>(handles_.size());
    bool is_good = false;
    withLine([&] {
      is_good = measurement_kind_->read(rest(), nullptr, {nullptr, kinds_.data(), count}, {});
    });
    if (!is_good || !isAtEnd(rest_)) {
      raise("the text after the second | is not the data of " + measurement_kind_->name + ":" + rest_.str() +
            commaIn(rest_.str()));
    }
    withLine([&] {
      const std::uint64_t before = problem().structureRevision();
      measurement_kind_->read(restAgain(), &problem(), {handles_.data(), kinds_.data(), count}, options_);
      assignGroups(before);
    });
  }

  [[noreturn]] void raiseWrongType(int variable, const std::string& taker, const std::string& type) const {
    raise("variable " + std::to_string(variable) + ", " + inQuotes(result_.entries_[at(variable)].name) +
          ", is a " + variable_kinds_[at(variable)]->name + " where " + taker + " takes a " + type);
  }

  void readTraced() {
    TracedMeasurement measurement;
    std::vector<std::type_index> types;
    std::vector<tape::Layout> layouts;
    for (const tape::VariableType& type : tape_->tape.code().variables) {
      const int number = readVariableNumber();
      detail::TracedType known{typeid(void), {}, {}};
      const detail::StoredVariable& kind = *variable_kinds_[at(number)];
      if (!kind.describe(kind, known) || !archive_text::areAlike(known.parts, type))
        raiseWrongType(number, "the tape", type.name);
      types.push_back(known.type);
      layouts.push_back(std::move(known.layout));
      measurement.variables.emplace_back(AnyVarID(result_.entries_[at(number)].handle));
    }
    const int count = static_cast<int>(measurement.variables.size());
    expectBar("the numbers of " + counted(count, "variable"));
    readOptions();
    const auto columns = at(tape_->tape.data());
    std::istream& data = rest();
    for (double x = 0; measurement.data.size() < columns && data >> x;) measurement.data.push_back(x);
    if (measurement.data.size() < columns || !isAtEnd(data)) {
      raise("the text after the second | is not " + counted(tape_->tape.data(), "number") +
            ", the data of the tape:" + rest_.str() + commaIn(rest_.str()));
    }
    if (tape_->kind == nullptr) {
      tape_->kind = TracedKind::shared(tape_->tape, types, layouts);
    } else if (tape_->kind->types != types || tape_->kind->layouts != layouts) {
      raise(
          "the variables are of other types than those of the tape's first measurement; write the tape once more for "
          "these types");
    }
    measurement.kind = tape_->kind;
    withLine([&] {
      const std::uint64_t before = problem().structureRevision();
      insertTraced(problem(), measurement, options_.noise, options_.label, options_.loss);
      assignGroups(before);
    });
  }

  /// Reads the variables of a measurement over a list, up to the bar.
  void readList() {
    while ((line_ >> std::ws) && std::isdigit(line_.peek()) != 0) {
      const int number = readVariableNumber();
      handles_.push_back(result_.entries_[at(number)].handle);
      kinds_.push_back(variable_kinds_[at(number)]);
    }
    line_.clear();
  }

  /// Returns the part of the line that has not been read yet.
  std::istream& rest() {
    std::string text;
    std::getline(line_, text);
    rest_.str(text);
    return restAgain();
  }
  std::istream& restAgain() {
    rest_.clear();
    rest_.seekg(0);
    return rest_;
  }

  void expectBar(const std::string& before) {
    std::string word;
    if (!(line_ >> word) || word != "|") raise("a | is missing after " + before);
  }

  /// Reads the noise and the loss, up to the second bar. Reading the noise does not require the length of the residual.
  void readOptions() {
    std::string word;
    line_ >> word;
    noise_.clear();
    const std::string kind = word;
    if (kind != "unit" && kind != "scalar" && kind != "diagonal" && kind != "matrix") {
      raise("the noise is " + inQuotes(kind) + "; write unit, scalar, diagonal or matrix, and its numbers");
    }
    for (double x = 0; line_ >> word;) {
      std::istringstream one(word);
      if (!readNumber(one, x)) break;
      noise_.push_back(x);
    }
    options_.loss = Loss();
    groups_.clear();
    const bool is_more = line_ && word != "|";
    if (is_more && word != "group") {
      readLoss(word);
      line_ >> word;
    }
    while (line_ && word == "group") {
      readGroup();
      line_ >> word;
    }
    if (is_more && (!line_ || word != "|")) raise("a | is missing after the noise and the loss");
    setNoise(kind);
  }

  /// Reads a group: the name of its dimension and its key, a number or a text in quotes.
  void readGroup() {
    StoredGroup group;
    line_ >> std::ws;
    if (line_.peek() != '"' || !(line_ >> std::quoted(group.dimension) >> std::ws))
      raise("write group \"NAME\" KEY");
    group.is_text = line_.peek() == '"';
    if (!(group.is_text ? line_ >> std::quoted(group.text) : line_ >> group.number))
      raise("the key of a group is a whole number or a text in quotes");
    groups_.push_back(std::move(group));
  }

  /// Puts the measurement inserted last into the groups that were read.
  void assignGroups(std::uint64_t revision_before) {
    if (groups_.empty()) return;
    std::vector<Group> groups;
    for (const StoredGroup& one : groups_)
      groups.push_back({one.dimension, one.text, one.number, one.is_text});
    const int count = static_cast<int>(groups.size());
    detail::requireDistinctDimensions(groups.data(), count);
    const std::optional<std::span<const Change>> changes = problem().changesSince(revision_before);
    const Change& inserted = changes.value().back();
    problem().assignGroups(*problem().pools()[at(inserted.pool)], inserted.index, groups.data(), count);
  }

  void readLoss(const std::string& word) {
    const LossKind* const kind = lossNamed(word);
    double shape = 0, scale = 0;
    if (kind == nullptr)
      raise(inQuotes(word) + " is neither a number of the noise nor a loss nor a |" + commaIn(word));
    if ((kind->has_shape && !readNumber(line_, shape)) || !readNumber(line_, scale)) {
      raise("numbers are missing after " + word + commaIn(text_));
    }
    options_.loss = Loss(*kind, scale, shape);
  }

  void setNoise(const std::string& kind) {
    const int n = static_cast<int>(noise_.size());
    options_.noise = {NoiseView::Shape::unit, NoiseForm::whitening, noise_.data(), n, 1};
    if (kind == "scalar" && n == 1) options_.noise.shape = NoiseView::Shape::scalar;
    if (kind == "diagonal") options_.noise.shape = NoiseView::Shape::vector;
    if (kind == "matrix") {
      int side = 0;
      while (side * side < n) ++side;
      if (side * side != n) raise("the noise matrix has " + counted(n, "number") + ", which is not a square");
      std::vector<double> by_columns(noise_.size());
      for (int k = 0; k < n; ++k) by_columns[at(k % side * side + k / side)] = noise_[at(k)];
      noise_ = by_columns;
      options_.noise = {NoiseView::Shape::matrix, NoiseForm::whitening, noise_.data(), side, side};
    }
    if ((kind == "unit" && n != 0) || (kind == "scalar" && n != 1)) {
      raise("the noise is " + kind + " with " + counted(n, "number") + "; unit has none, scalar one");
    }
  }

  /// Calls f() and prefixes its errors with the line.
  template <class F>
  void withLine(const F& f) const {
    try {
      f();
    } catch (const Error& error) {
      raise(std::string(error.sentence()));
    }
  }

  Problem& problem() { return Archive::problemOf(result_.estimator); }

  const Archive& archive_;
  std::istream& is_;
  const std::string& source_;
  StoredProblem result_;
  std::string text_;
  std::istringstream line_, rest_;
  int line_number_ = 0;
  const detail::StoredVariable* variable_kind_ = nullptr;
  std::deque<detail::StoredVariable> described_;  // types that the file describes
  const detail::StoredMeasurement* measurement_kind_ = nullptr;
  std::deque<StoredTape> tapes_;
  StoredTape* tape_ = nullptr;  // of the next measurements; null: measurement_kind_
  std::vector<const detail::StoredVariable*> variable_kinds_;  // of the variables, by number in the file
  std::vector<int> indices_;  // indices in the problem, by number in the file
  std::vector<VariableHandle> handles_;
  std::vector<const detail::StoredVariable*> kinds_;  // the types of these variables, for a list
  std::vector<double> noise_;
  detail::StoredOptions options_;
  struct StoredGroup {
    std::string dimension, text;
    std::int64_t number = 0;
    bool is_text = false;
  };
  std::vector<StoredGroup> groups_;
};

StoredProblem Archive::load(std::istream& is, const std::string& source) const {
  return ArchiveReader(*this, is, source).read();
}

}  // namespace slom
