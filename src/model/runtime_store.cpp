#include "model/runtime_store.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <numeric>
#include <sstream>

#include "base/index.hpp"
#include "slom/model/var_id.hpp"

namespace slom {

namespace {

using FieldKind = RuntimeType::Kind;
using SE2 = mtk::trafo<mtk::SO2<>>;
using SE3 = mtk::trafo<mtk::SO3<>>;

/// Calls f(part, numbers) for each basic part of x; `numbers` are those that store it.
template <class T, class Numbers, class F>
void eachState(T& x, Numbers* numbers, const F& f) {
  mtk::detail::forEachBasicPart(x, x, 0, [&](auto& part, const auto&, int) {
    auto& state = mtk::detail::stateOf(part);
    if constexpr (requires { state.size(); }) {
      f(state.data(), numbers, static_cast<int>(state.size()));
      numbers += state.size();
    } else {
      f(&state, numbers, 1);
      ++numbers;
    }
  });
}
template <class T>
T read(T x, const double* numbers) {
  eachState(x, numbers, [](double* state, const double* from, int n) { std::copy_n(from, n, state); });
  return x;
}
template <class T>
void write(T x, double* numbers) {
  eachState(x, numbers, [](const double* state, double* to, int n) { std::copy_n(state, n, to); });
}

/// Calls f with the value of a field that is made of these numbers.
template <class F>
void withField(const RuntimeType::Field& field, const double* numbers, const F& f) {
  switch (field.kind) {
    case FieldKind::number:
      return f(*numbers);
    case FieldKind::vector:
      if (field.size == 2) return f(read(mtk::vect<2>(), numbers));
      if (field.size == 3) return f(read(mtk::vect<3>(), numbers));
      return f(read(mtk::vect<mtk::Dynamic>(field.size), numbers));
    case FieldKind::so2:
      return f(read(mtk::SO2<>(), numbers));
    case FieldKind::so3:
      return f(read(mtk::SO3<>(), numbers));
    case FieldKind::s2:
      return f(read(mtk::S2<>(), numbers));
    case FieldKind::se2:
      return f(read(SE2(), numbers));
    case FieldKind::se3:
      return f(read(SE3(), numbers));
  }
}

const double* numbersOf(const void* value) { return static_cast<const double*>(value); }

/// Calls f(field value, first component) for each field.
template <class F>
void eachField(const RuntimeType& type, const void* value, const F& f) {
  for (std::size_t i = 0; i < type.fields().size(); ++i) {
    const RuntimeType::Place place = type.places()[i];
    withField(type.fields()[i], numbersOf(value) + place.coordinate,
              [&](const auto& x) { f(x, place.component); });
  }
}

/// Passes on the orientations of a field with their components in the variable.
struct OrientationsOfField final : OrientationSink {
  OrientationSink& sink;
  int first;
  OrientationsOfField(OrientationSink& to, int first_component) : sink(to), first(first_component) {}
  void take(Kind kind, int component, const double* numbers) override {
    sink.take(kind, first + component, numbers);
  }
};

[[noreturn]] void raiseType(const std::string& name, const std::string& fault) {
  throw Error("slom.bad-type", "the type of variables " + name + " " + fault, name);
}

/// Returns a text that is different for different types.
std::string keyOf(const std::string& name, const std::vector<RuntimeType::Field>& fields) {
  std::string key = std::to_string(name.size()) + ' ' + name;
  for (const RuntimeType::Field& field : fields) {
    key += ' ' + std::to_string(field.name.size()) + ' ' + field.name + ' ' +
           std::to_string(static_cast<int>(field.kind)) + ' ' + std::to_string(field.size);
  }
  return key;
}

}  // namespace

RuntimeType::RuntimeType(std::string name, std::vector<Field> fields)
    : name_(std::move(name)), fields_(std::move(fields)) {
  for (const RuntimeType::Field& field : fields_) {
    places_.push_back(end_);
    end_.coordinate += coordinatesOf(field);
    end_.component += dofOf(field);
  }
}

std::shared_ptr<const RuntimeType> RuntimeType::make(std::string name, std::vector<Field> fields) {
  if (fields.empty()) raiseType(name, "has no fields; give it at least one");
  for (Field& field : fields) {
    if (field.kind != FieldKind::vector) field.size = 1;
    if (field.size < 1) {
      raiseType(name, "has the vector " + field.name + " of " + std::to_string(field.size) +
                          " numbers; give it at least one");
    }
  }
  constexpr long most = 65535;
  const long numbers =
      std::accumulate(fields.begin(), fields.end(), 0L,
                      [](long sum, const RuntimeType::Field& field) { return sum + coordinatesOf(field); });
  if (numbers > most) {
    raiseType(name, "has " + std::to_string(numbers) + " numbers; give it at most " + std::to_string(most));
  }
  static std::mutex mutex;
  static auto* const known = new std::map<std::string, std::weak_ptr<const RuntimeType>>;
  static std::size_t room = 64;  // number of types after which those that no longer exist are forgotten
  const std::lock_guard lock(mutex);
  if (known->size() >= room) {
    std::erase_if(*known, [](const auto& own) { return own.second.expired(); });
    room = 2 * known->size() + 64;
  }
  std::weak_ptr<const RuntimeType>& own = (*known)[keyOf(name, fields)];
  std::shared_ptr<const RuntimeType> type = own.lock();
  if (type == nullptr) {
    type.reset(new RuntimeType(std::move(name), std::move(fields)));
    own = type;
  }
  return type;
}

std::shared_ptr<const RuntimeType> RuntimeType::of(const VariableHandle& id) {
  const auto* const store = dynamic_cast<const RuntimeStore*>(id.store_.get());
  return store == nullptr ? nullptr : store->type();
}

int RuntimeType::coordinatesOf(const RuntimeType::Field& field) {
  switch (field.kind) {
    case FieldKind::so3:
      return 4;
    case FieldKind::s2:
    case FieldKind::se2:
      return 3;
    case FieldKind::se3:
      return 7;
    default:
      return dofOf(field);
  }
}

int RuntimeType::dofOf(const RuntimeType::Field& field) {
  switch (field.kind) {
    case FieldKind::vector:
      return field.size;
    case FieldKind::so3:
    case FieldKind::se2:
      return 3;
    case FieldKind::s2:
      return 2;
    case FieldKind::se3:
      return 6;
    default:
      return 1;
  }
}

std::vector<double> RuntimeType::normalized(std::vector<double> numbers) const {
  if (numbers.size() != at(coordinates())) {
    throw Error("slom.wrong-length",
                "a value of the type " + name_ + " has " + std::to_string(coordinates()) +
                    " numbers, it was given " + std::to_string(numbers.size()) +
                    "; pass all of them, field after field",
                name_);
  }
  for (const double number : numbers) {
    if (std::isfinite(number)) continue;
    throw Error("slom.bad-value",
                "a value of the type " + name_ + " has the number " + std::to_string(number) +
                    "; pass finite numbers",
                name_);
  }
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    double* const x = numbers.data() + places_[i].coordinate;
    switch (fields_[i].kind) {
      case FieldKind::so2:
        write(mtk::SO2<>(x[0]), x);
        break;
      case FieldKind::se2:
        write(mtk::SO2<>(x[2]), x + 2);
        break;
      case FieldKind::so3:
        write(mtk::SO3<>(x[3], x[0], x[1], x[2]), x);
        break;
      case FieldKind::se3:
        write(mtk::SO3<>(x[6], x[3], x[4], x[5]), x + 3);
        break;
      case FieldKind::s2:
        write(mtk::S2<>(x[0], x[1], x[2]), x);
        break;
      case FieldKind::number:
      case FieldKind::vector:
        break;
    }
  }
  return numbers;
}

RuntimeStore::RuntimeStore(std::shared_ptr<const RuntimeType> type)
    : VariableStoreBase(at(type->coordinates()) * sizeof(double), alignof(double)), type_(std::move(type)) {}

bool RuntimeStore::hasTypeOf(const VariableStoreBase& other) const {
  const auto* const own = dynamic_cast<const RuntimeStore*>(&other);
  return own != nullptr && own->type_ == type_;
}

std::unique_ptr<VariableStoreBase> RuntimeStore::makeEmpty() const {
  return std::make_unique<RuntimeStore>(type_);
}

std::vector<std::string> RuntimeStore::componentNames(std::uint32_t slot, const std::string& path) const {
  std::vector<std::string> names;
  const double* const numbers = numbersOf(valueAt(slot));
  for (std::size_t i = 0; i < type_->fields().size(); ++i) {
    const RuntimeType::Field& field = type_->fields()[i];
    const std::string own = field.name.empty() ? path : mtk::detail::joinPath(path, field.name);
    withField(field, numbers + type_->places()[i].coordinate, [&](const auto& x) {
      for (std::string& name : mtk::componentNames(x, own)) names.push_back(std::move(name));
    });
  }
  return names;
}

std::string RuntimeStore::valueText(std::uint32_t slot) const {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  const double* const numbers = numbersOf(valueAt(slot));
  for (int i = 0; i < type_->coordinates(); ++i) text << (i == 0 ? "" : " ") << numbers[i];
  return text.str();
}

void RuntimeStore::construct(void* place, const void* value) const {
  std::uninitialized_copy_n(numbersOf(value), type_->coordinates(), static_cast<double*>(place));
}

void RuntimeStore::assign(void* to, const void* from) const {
  std::copy_n(numbersOf(from), type_->coordinates(), static_cast<double*>(to));
}

void RuntimeStore::boxplus(void* value, const double* d) const {
  for (std::size_t i = 0; i < type_->fields().size(); ++i) {
    const RuntimeType::Field& field = type_->fields()[i];
    const RuntimeType::Place place = type_->places()[i];
    double* const numbers = static_cast<double*>(value) + place.coordinate;
    if (field.kind == FieldKind::number || field.kind == FieldKind::vector) {
      for (int k = 0; k < RuntimeType::dofOf(field); ++k) numbers[k] += d[place.component + k];
    } else {
      withField(field, numbers, [&](auto x) {
        using T = decltype(x);
        mtk::boxplus<T>(x, mtk::vectview<const double, mtk::DOF_v<T>>(d + place.component, mtk::dof(x)));
        write(x, numbers);
      });
    }
  }
}

void RuntimeStore::boxminus(double* out, const void* x, const void* y) const {
  for (std::size_t i = 0; i < type_->fields().size(); ++i) {
    const RuntimeType::Place place = type_->places()[i];
    withField(type_->fields()[i], numbersOf(x) + place.coordinate, [&](const auto& to) {
      using T = std::remove_cvref_t<decltype(to)>;
      const T from = read(T(to), numbersOf(y) + place.coordinate);
      mtk::boxminus<T>(mtk::vectview<double, mtk::DOF_v<T>>(out + place.component, mtk::dof(to)), to, from);
    });
  }
}

void RuntimeStore::boxminusDerivative(const void* x, const void* y, double* D) const {
  const int n = type_->dof();
  for (int i = 0; i < n * n; ++i) D[i] = i % (n + 1) == 0 ? 1 : 0;
  for (std::size_t i = 0; i < type_->fields().size(); ++i) {
    const RuntimeType::Place place = type_->places()[i];
    withField(type_->fields()[i], numbersOf(x) + place.coordinate, [&](const auto& to) {
      using T = std::remove_cvref_t<decltype(to)>;
      const T from = read(T(to), numbersOf(y) + place.coordinate);
      mtk::detail::forEachBasicPart(from, to, place.component,
                                    [&](const auto& part_y, const auto& part_x, int at) {
                                      detail::writePart(part_x, part_y, D + at * n + at, n);
                                    });
    });
  }
}

void RuntimeStore::typicalSizesOf(const void* value, double* out) const {
  eachField(*type_, value, [&](const auto& x, int first) {
    using T = std::remove_cvref_t<decltype(x)>;
    mtk::typicalSizes<T>(mtk::vectview<double, mtk::DOF_v<T>>(out + first, mtk::dof(x)), x);
  });
}

void RuntimeStore::leftPerturbation(const void* value, double* A) const {
  const int n = type_->dof();
  for (int i = 0; i < n * n; ++i) A[i] = i % (n + 1) == 0 ? 1 : 0;
  eachField(*type_, value, [&](const auto& x, int first) { detail::writeLeftPerturbation(x, first, A, n); });
}

void RuntimeStore::coordinates(const void* value, double* out) const {
  eachField(*type_, value, [&](const auto& x, int first) { slom::coordinates(x, out + first); });
}

void RuntimeStore::visitOrientations(const void* value, OrientationSink& sink) const {
  eachField(*type_, value, [&](const auto& x, int first) {
    OrientationsOfField own(sink, first);
    slom::visitOrientations(x, own);
  });
}

void RuntimeStore::gaugeGenerators(const void* value, WorldRole role, double* out) const {
  const int n = type_->dof();
  for (int i = 0; i < n * kGaugeGenerators; ++i) out[i] = 0;
  const detail::GaugeGeneratorWriter writer(out, n, role);
  eachField(*type_, value, [&](const auto& x, int first) { writer.add(x, first); });
}

}  // namespace slom
