/// Saving: the text of a problem.
#include <limits>
#include <locale>
#include <map>
#include <ostream>
#include <sstream>

#include "archive/described.hpp"
#include "archive/tape_text.hpp"
#include "archive/text.hpp"
#include "base/index.hpp"
#include "base/words.hpp"
#include "model/runtime_store.hpp"
#include "slom/archive.hpp"
#include "slom/problem/group_table.hpp"
#include "tape/traced_pool.hpp"

namespace slom {

using archive_text::inQuotes, archive_text::isAtEnd;

namespace {

/// Returns the number with all its digits.
std::string exact(double x) { return number(x, std::numeric_limits<double>::max_digits10); }

/// Writer that checks that each item can be read again.
class Writer {
 public:
  explicit Writer(std::ostream& os) : os_(os) {
    for (std::ios* stream : {static_cast<std::ios*>(&text_), static_cast<std::ios*>(&check_)})
      stream->imbue(std::locale::classic());
    text_.precision(std::numeric_limits<double>::max_digits10);
  }
  /// Writes a value by `write` and checks it by `read`. `subject()` names the value in the error if it cannot be read
  /// again.
  template <class Write, class Read, class Subject>
  void add(const Write& write, const Read& read, const Subject& subject) {
    text_.str("");
    write(text_);
    std::string text = text_.str();
    if (!text.empty() && text.back() == ' ') text.pop_back();
    check_.clear();
    check_.str(text);
    if (text.find('\n') != std::string::npos || !read(check_) || !isAtEnd(check_)) {
      throw Error(
          "slom.not-savable",
          subject() + " is not finite, or cannot be read again from what its operator<< writes: " + text,
          subject());
    }
    os_ << text;
  }

 private:
  std::ostream& os_;
  std::ostringstream text_;
  std::istringstream check_;
};

void writeNoise(std::ostream& os, const MeasurementPool& pool, int i) {
  const auto [kind, W] = pool.whitening(i);
  const int n = pool.rows(i);
  constexpr const char* names[] = {"unit", "scalar", "diagonal", "matrix"};
  os << names[static_cast<int>(kind)];
  for (int k = 0; k < whiteningSize(kind, n); ++k) {
    os << ' ' << exact(kind == WhiteningKind::full ? W[k / n + k % n * n] : W[k]);  // row by row
  }
}

void writeLoss(std::ostream& os, const MeasurementPool& pool, int i) {
  const Loss* const loss = pool.lossOf(i);
  if (loss == nullptr) return;
  if (loss->kind()->stored_name == nullptr) {
    throw Error("slom.not-savable",
                "the loss " + loss->text() + " of measurement " + pool.measurementName(i) +
                    " is a function of this program, which cannot be saved to a file; insert the "
                    "measurement with one of the library's losses",
                pool.measurementName(i));
  }
  os << ' ' << loss->kind()->stored_name;
  if (loss->kind()->has_shape) os << ' ' << exact(loss->shape());
  os << ' ' << exact(loss->scale());
}

void writeGroups(std::ostream& os, const Problem& problem, const MeasurementPool& pool, int i) {
  const GroupTable* const table = problem.groups();
  for (int d = 0; table != nullptr && d < table->dimensionCount(); ++d) {
    const int number = pool.groupKey(d, i);
    if (number < 0) continue;
    const GroupKey& key = table->keys(d)[at(number)];
    os << " group " << inQuotes(table->dimension(d)) << ' '
       << (key.is_text ? inQuotes(key.text) : key.name());
  }
}

void writeConstraints(std::ostream& os, const Problem& problem, int variable, int number) {
  const VariableRecord& record = problem.variables()[at(variable)];
  const std::vector<char>& fixed = problem.activeSet().fixed(variable);
  const std::vector<std::string> names = record.store->componentNames(record.slot, "");
  for (std::size_t c = 0; c < fixed.size(); ++c) {
    if (fixed[c] != 0) os << "fix " << number << ' ' << inQuotes(names[c]) << '\n';
  }
  for (const ComponentBound& bound : problem.activeSet().bounds(variable)) {
    os << "bound " << number << ' ' << inQuotes(names[at(bound.component)]) << ' ' << exact(bound.lower)
       << ' ' << exact(bound.upper) << '\n';
  }
}

/// A type of variables in the file: the functions that write its values, and its line.
struct SavedType {
  detail::StoredVariable stored;
  std::string line;
};

/// What tapes see of a C++ type.
struct SeenByTapes {
  const tape::VariableType* parts = nullptr;
  const tape::Layout* layout = nullptr;
};

/// The types of a problem's variables.
class SavedTypes {
 public:
  explicit SavedTypes(const Problem& problem) : problem_(problem) {
    for (const auto& pool : problem.pools()) {
      const TracedKind* const kind = tracedKindOf(*pool);
      for (int k = 0; kind != nullptr && pool->size() > 0 && k < pool->arity(); ++k)
        seen_[&storeOf(pool->variables(0)[k])] = {&kind->tape.code().variables[at(k)], &kind->layouts[at(k)]};
    }
  }

  const VariableStoreBase& storeOf(int variable) const { return *problem_.variables()[at(variable)].store; }

  /// Returns how variables of this store are saved; null if neither the archive nor a tape knows their type.
  /// `registered`: the type of the archive, if any.
  template <class Find>
  const SavedType* of(int variable, const Find& registered) {
    const VariableStoreBase& store = storeOf(variable);
    const auto [found, is_new] = types_.try_emplace(&store);
    if (is_new) found->second = make(variable, store, registered(typeid(store)));
    return found->second.get();
  }

 private:
  std::unique_ptr<SavedType> make(int variable, const VariableStoreBase& store,
                                  const detail::StoredVariable* registered) const {
    using archive_text::describedVariable, archive_text::textOf;
    if (const auto* const own = dynamic_cast<const RuntimeStore*>(&store)) {
      const RuntimeType& type = *own->type();
      return std::make_unique<SavedType>(
          SavedType{describedVariable(type.name(), typeid(store), own->type(), tape::layoutOf(type)),
                    inQuotes(type.name()) + " fields " + textOf(type)});
    }
    const auto seen = seen_.find(&store);
    if (seen == seen_.end()) {
      if (registered == nullptr) return nullptr;
      return std::make_unique<SavedType>(SavedType{*registered, inQuotes(registered->name)});
    }
    const std::string name = registered == nullptr ? store.typeName() : registered->name;
    const VariableRecord& record = problem_.variables()[at(variable)];
    const auto type =
        archive_text::describedType(name, *seen->second.parts, store.componentNames(record.slot, ""));
    const detail::StoredVariable described =
        describedVariable(name, typeid(store), type, *seen->second.layout);
    const std::string or_fields = inQuotes(name) + " or fields " + textOf(*type);
    if (registered == nullptr) return std::make_unique<SavedType>(SavedType{described, or_fields});
    return std::make_unique<SavedType>(
        SavedType{*registered, areWrittenAlike(*registered, described, store) ? or_fields : inQuotes(name)});
  }

  /// Returns whether the values of a store are written as their numbers.
  bool areWrittenAlike(const detail::StoredVariable& registered, const detail::StoredVariable& described,
                       const VariableStoreBase& store) const {
    const auto text = [](const detail::StoredVariable& kind, const void* value) {
      std::ostringstream os;
      os.imbue(std::locale::classic());
      os.precision(std::numeric_limits<double>::max_digits10);
      kind.write(kind, os, value);
      return os.str();
    };
    for (const VariableRecord& record : problem_.variables()) {
      if (record.store != &store) continue;
      const void* const value = record.store->valueAt(record.slot);
      if (text(registered, value) != text(described, value)) return false;
    }
    return true;
  }

  const Problem& problem_;
  std::map<const VariableStoreBase*, SeenByTapes> seen_;
  std::map<const VariableStoreBase*, std::unique_ptr<SavedType>> types_;
};

/// Returns the number of each kind of traced measurements in the file, and writes their tapes.
std::map<const TracedKind*, int> writeTapes(std::ostream& os, const Problem& problem) {
  std::map<const TracedKind*, int> numbers;
  for (const auto& pool : problem.pools()) {
    const TracedKind* const kind = tracedKindOf(*pool);
    if (kind == nullptr || pool->size() == 0) continue;
    if (numbers.try_emplace(kind, static_cast<int>(numbers.size())).second)
      os << "tape " << archive_text::kTapeVersion << '\n' << archive_text::textOf(kind->tape);
  }
  return numbers;
}

void writeTracedData(std::ostream& os, const MeasurementPool& pool, int i) {
  const double* const data = tracedDataOf(pool, i);
  for (int k = 0; k < tracedKindOf(pool)->tape.data(); ++k) os << data[k] << ' ';
}

bool readTracedData(std::istream& is, int count) {
  for (double x = 0; count > 0 && is >> x; --count) {
  }
  return count == 0;
}

}  // namespace

void Archive::save(const Estimator& estimator, std::ostream& os) const {
  const Problem& problem = estimator.problem();
  std::ostringstream text;
  text.imbue(std::locale::classic());
  Writer writer(text);
  text << archive_text::kFirstWords << ' ' << archive_text::kVersion << '\n';
  if (estimator.sigma() == Sigma::estimated) text << "sigma estimated\n";
  if (estimator.freeGauge() == FreeGauge::inner_constraints) text << "gauge inner-constraints\n";

  SavedTypes types(problem);
  const auto typeOf = [&](int variable) {
    const SavedType* const type =
        types.of(variable, [this](std::type_index store) { return findVariable(store); });
    if (type != nullptr) return type;
    const std::string own = types.storeOf(variable).typeName();
    throw Error("slom.not-in-archive",
                "variable " + problem.variableName(variable) + " is of the type " + own +
                    ", which is not registered with the archive; name it by archive.variable<" + own + ">",
                problem.variableName(variable));
  };
  std::vector<int> number(problem.variables().size(), -1);
  int count = 0;
  const SavedType* last = nullptr;
  for (std::size_t v = 0; v < number.size(); ++v) {
    const VariableRecord& record = problem.variables()[v];
    if (record.store == nullptr) continue;
    const SavedType* const type = typeOf(static_cast<int>(v));
    if (type != last) text << "variables " << type->line << '\n';
    last = type;
    text << inQuotes(record.name)
         << (problem.activeSet().isOptimized(static_cast<int>(v)) ? " free " : " fixed ");
    VariableHandle unused;
    const detail::StoredVariable& kind = type->stored;
    writer.add([&](std::ostream& value) { kind.write(kind, value, record.store->valueAt(record.slot)); },
               [&](std::istream& is) { return kind.read(kind, is, nullptr, true, "", unused); },
               [&] { return "variable " + problem.variableName(static_cast<int>(v)); });
    text << '\n';
    number[v] = count++;
  }
  for (const int v : problem.activeSet().constrained()) writeConstraints(text, problem, v, number[at(v)]);

  const std::map<const TracedKind*, int> tapes = writeTapes(text, problem);
  for (const auto& pool : problem.pools()) {
    if (pool->size() == 0) continue;
    const TracedKind* const traced = tracedKindOf(*pool);
    const auto kind = std::find_if(measurements_.begin(), measurements_.end(),
                                   [&](const auto& known) { return known.type == *pool->type().id; });
    if (traced == nullptr && kind == measurements_.end()) {
      throw Error(
          "slom.not-in-archive",
          "the type of the measurements " + pool->name() +
              " is not registered with the archive; name it by archive.measurement, with the function's type and those of its "
              "arguments",
          pool->name());
    }
    text << "measurements "
         << (traced != nullptr ? "tape " + std::to_string(tapes.at(traced)) : inQuotes(kind->name)) << ' '
         << inQuotes(pool->label()) << '\n';
    for (int i = 0; i < pool->size(); ++i) {
      std::vector<const detail::StoredVariable*> kinds;
      for (int k = 0; k < pool->arity(); ++k) {
        const int variable = pool->variables(i)[k];
        text << number[at(variable)] << ' ';
        if (traced == nullptr && kind->is_list) kinds.push_back(&typeOf(variable)->stored);
      }
      text << "| ";
      const detail::StoredArguments arguments{nullptr, kinds.data(), pool->arity()};
      writeNoise(text, *pool, i);
      writeLoss(text, *pool, i);
      writeGroups(text, problem, *pool, i);
      text << " | ";
      writer.add(
          [&](std::ostream& data) {
            traced != nullptr ? writeTracedData(data, *pool, i) : kind->write(data, arguments, *pool, i);
          },
          [&](std::istream& is) {
            return traced != nullptr ? readTracedData(is, traced->tape.data())
                                     : kind->read(is, nullptr, arguments, {});
          },
          [&] { return "the data of measurement " + pool->measurementName(i); });
      text << '\n';
    }
  }
  text << "end\n";
  os << text.str();
}

}  // namespace slom
