/// Saving: the text of a problem.
#include <limits>
#include <locale>
#include <ostream>
#include <sstream>

#include "archive/text.hpp"
#include "base/index.hpp"
#include "base/words.hpp"
#include "slom/archive.hpp"
#include "slom/problem/group_table.hpp"

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

}  // namespace

void Archive::save(const Estimator& estimator, std::ostream& os) const {
  const Problem& problem = estimator.problem();
  std::ostringstream text;
  text.imbue(std::locale::classic());
  Writer writer(text);
  text << archive_text::kFirstWords << ' ' << archive_text::kVersion << '\n';
  if (estimator.sigma() == Sigma::estimated) text << "sigma estimated\n";
  if (estimator.freeGauge() == FreeGauge::inner_constraints) text << "gauge inner-constraints\n";

  std::vector<int> number(problem.variables().size(), -1);
  int count = 0;
  const detail::StoredVariable* last = nullptr;
  for (std::size_t v = 0; v < number.size(); ++v) {
    const VariableRecord& record = problem.variables()[v];
    if (record.store == nullptr) continue;
    const VariableStoreBase& store = *record.store;
    const detail::StoredVariable* const kind = findVariable(typeid(store));
    if (kind == nullptr) {
      throw Error("slom.not-in-archive",
                  "variable " + problem.variableName(static_cast<int>(v)) + " is of the type " +
                      store.typeName() +
                      ", which is not registered with the archive; name it by "
                      "archive.variable<" +
                      store.typeName() + ">",
                  problem.variableName(static_cast<int>(v)));
    }
    if (kind != last) text << "variables " << inQuotes(kind->name) << '\n';
    last = kind;
    text << inQuotes(record.name)
         << (problem.activeSet().isOptimized(static_cast<int>(v)) ? " free " : " fixed ");
    VariableHandle unused;
    writer.add([&](std::ostream& value) { kind->write(value, record.store->valueAt(record.slot)); },
               [&](std::istream& is) { return kind->read(is, nullptr, true, "", unused); },
               [&] { return "variable " + problem.variableName(static_cast<int>(v)); });
    text << '\n';
    number[v] = count++;
  }
  for (const int v : problem.activeSet().constrained()) writeConstraints(text, problem, v, number[at(v)]);

  for (const auto& pool : problem.pools()) {
    if (pool->size() == 0) continue;
    const auto kind = std::find_if(measurements_.begin(), measurements_.end(),
                                   [&](const auto& known) { return known.type == *pool->type().id; });
    if (kind == measurements_.end()) {
      throw Error(
          "slom.not-in-archive",
          "the type of the measurements " + pool->name() +
              " is not registered with the archive; name it by archive.measurement, with the function's type and those of its "
              "arguments",
          pool->name());
    }
    text << "measurements " << inQuotes(kind->name) << ' ' << inQuotes(pool->label()) << '\n';
    for (int i = 0; i < pool->size(); ++i) {
      for (int k = 0; k < pool->arity(); ++k) text << number[at(pool->variables(i)[k])] << ' ';
      text << "| ";
      std::vector<const detail::StoredVariable*> kinds;
      for (int k = 0; kind->is_list && k < pool->arity(); ++k) {
        const VariableStoreBase& store = *problem.variables()[at(pool->variables(i)[k])].store;
        kinds.push_back(findVariable(typeid(store)));
      }
      const detail::StoredArguments arguments{nullptr, kinds.data(), pool->arity()};
      writeNoise(text, *pool, i);
      writeLoss(text, *pool, i);
      writeGroups(text, problem, *pool, i);
      text << " | ";
      writer.add([&](std::ostream& data) { kind->write(data, arguments, *pool, i); },
                 [&](std::istream& is) { return kind->read(is, nullptr, arguments, {}); },
                 [&] { return "the data of measurement " + pool->measurementName(i); });
      text << '\n';
    }
  }
  text << "end\n";
  os << text.str();
}

}  // namespace slom
