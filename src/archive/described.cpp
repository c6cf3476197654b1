#include "archive/described.hpp"

#include <algorithm>
#include <iomanip>
#include <istream>
#include <iterator>
#include <ostream>

#include "archive/text.hpp"
#include "base/index.hpp"
#include "model/runtime_store.hpp"

namespace slom::archive_text {

namespace {

using Field = RuntimeType::Field;
using Kind = RuntimeType::Kind;
using Part = tape::Part;

constexpr const char* kNameOfField[]{"number", "vector", "so2", "so3", "s2", "se2", "se3"};

/// Returns the numbers of one value; false if the stream has fewer.
bool readNumbers(std::istream& is, int count, std::vector<double>& numbers) {
  for (double x = 0; count > 0 && is >> x; --count) numbers.push_back(x);
  return count == 0;
}

void write(const detail::StoredVariable& self, std::ostream& os, const void* value) {
  const char* separator = "";
  for (const std::uint32_t place : self.layout) {
    os << separator << *reinterpret_cast<const double*>(static_cast<const std::byte*>(value) + place);
    separator = " ";
  }
}

bool read(const detail::StoredVariable& self, std::istream& is, Problem* problem, bool optimize,
          const std::string& name, VariableHandle& id) {
  std::vector<double> numbers;
  if (!readNumbers(is, self.runtime_type->coordinates(), numbers)) return false;
  numbers = self.runtime_type->normalized(std::move(numbers));
  if (problem != nullptr) id = problem->insertVariable(self.runtime_type, numbers.data(), optimize, name);
  return true;
}

bool readValue(const detail::StoredVariable& self, std::istream& is, void* context,
               void (*take)(void*, const void*, int)) {
  std::vector<double> numbers;
  if (!readNumbers(is, self.runtime_type->coordinates(), numbers)) return false;
  take(context, self.runtime_type->normalized(std::move(numbers)).data(), self.runtime_type->dof());
  return true;
}

bool describe(const detail::StoredVariable& self, detail::TracedType& traced) {
  traced = {typeid(RuntimeType), tape::typeOf(*self.runtime_type), tape::layoutOf(*self.runtime_type)};
  return true;
}

/// Returns the path of a part, which its component lies in.
std::string parentOf(const std::string& component) {
  const std::size_t dot = component.rfind('.');
  return dot == std::string::npos ? "" : component.substr(0, dot);
}

/// Appends a vector with these names of components: as one field, unless it would give its components other names.
void appendVector(const std::string* names, int size, std::vector<Field>& fields) {
  const std::string path = parentOf(names[0]);
  if (size > 1) {
    const std::vector<std::string> own = mtk::componentNames(mtk::vect<mtk::Dynamic>(size), path);
    if (std::equal(own.begin(), own.end(), names)) return fields.push_back({path, Kind::vector, size});
  }
  for (int i = 0; i < size; ++i) fields.push_back({names[i], Kind::number});
}

/// Joins a position and the orientation after it to a pose.
void joinPose(std::vector<Field>& fields) {
  if (fields.size() < 2) return;
  const Field &position = *(fields.end() - 2), &orientation = fields.back();
  const bool is_in_space = orientation.kind == Kind::so3;
  const std::string path = parentOf(position.name);
  const bool is_pose = (is_in_space || orientation.kind == Kind::so2) && position.kind == Kind::vector &&
                       position.size == (is_in_space ? 3 : 2) &&
                       position.name == mtk::detail::joinPath(path, "pos") &&
                       orientation.name == mtk::detail::joinPath(path, "orient");
  if (!is_pose) return;
  fields.resize(fields.size() - 2);
  fields.push_back({path, is_in_space ? Kind::se3 : Kind::se2});
}

/// Returns the parts with one vector for vectors that follow one another.
std::vector<Part> joined(const std::vector<Part>& parts) {
  std::vector<Part> result;
  for (const Part& part : parts) {
    const bool is_vector = part.kind == Part::Kind::vector;
    if (is_vector && !result.empty() && result.back().kind == Part::Kind::vector) {
      result.back().size += part.size;
    } else {
      result.push_back({part.kind, is_vector ? part.size : 0});
    }
  }
  return result;
}

}  // namespace

std::string textOf(const RuntimeType& type) {
  std::string text;
  for (const Field& field : type.fields()) {
    text +=
        (text.empty() ? "" : " ") + inQuotes(field.name) + " " + kNameOfField[static_cast<int>(field.kind)];
    if (field.kind == Kind::vector) text += " " + std::to_string(field.size);
  }
  return text;
}

std::shared_ptr<const RuntimeType> readType(std::istream& is, const std::string& name) {
  std::vector<Field> fields;
  while (!isAtEnd(is)) {
    Field field;
    std::string kind;
    if (!(is >> std::quoted(field.name) >> kind)) return nullptr;
    const auto found = std::find(std::begin(kNameOfField), std::end(kNameOfField), kind);
    if (found == std::end(kNameOfField)) return nullptr;
    field.kind = static_cast<Kind>(found - std::begin(kNameOfField));
    if (field.kind == Kind::vector && !(is >> field.size)) return nullptr;
    fields.push_back(std::move(field));
  }
  return RuntimeType::make(name, std::move(fields));
}

std::shared_ptr<const RuntimeType> describedType(std::string name, const tape::VariableType& parts,
                                                 const std::vector<std::string>& components) {
  std::vector<Field> fields;
  const std::string* names = components.data();
  for (const Part& part : parts.parts) {
    switch (part.kind) {
      case Part::Kind::vector:
        appendVector(names, part.size, fields);
        break;
      case Part::Kind::angle:
        fields.push_back({parentOf(*names), Kind::so2});
        break;
      case Part::Kind::rotation:
        fields.push_back({parentOf(*names), Kind::so3});
        break;
      case Part::Kind::direction:
        fields.push_back({parentOf(*names), Kind::s2});
        break;
    }
    joinPose(fields);
    names += part.dof();
  }
  return RuntimeType::make(std::move(name), std::move(fields));
}

detail::StoredVariable describedVariable(std::string name, std::type_index store,
                                         std::shared_ptr<const RuntimeType> type, tape::Layout layout) {
  return {std::move(name), store, &write, &read, &readValue, &describe, std::move(type), std::move(layout)};
}

bool areAlike(const tape::VariableType& a, const tape::VariableType& b) {
  return joined(a.parts) == joined(b.parts);
}

}  // namespace slom::archive_text
