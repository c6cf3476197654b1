#include "value_type.hpp"

#include <algorithm>
#include <cmath>

#include <nanobind/eigen/dense.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "manifolds.hpp"
#include "recorded.hpp"
#include "slom/tape/rotation.hpp"

namespace slom::python {

using Kind = RuntimeType::Kind;
using tape::Number;

namespace {

std::string typeNameOf(nb::handle x) { return nb::cast<std::string>(x.type().attr("__name__")); }

std::string textOf(const std::vector<std::size_t>& shape) {
  std::string text = "(";
  for (std::size_t i = 0; i < shape.size(); ++i) text += (i == 0 ? "" : ", ") + std::to_string(shape[i]);
  return text + (shape.size() == 1 ? ",)" : ")");
}

template <class T>
bool isA(nb::handle x) {
  return nb::isinstance<T>(x);
}
template <class R>
void appendPose(const mtk::trafo<R>& T, std::vector<double>& numbers) {
  numbers.insert(numbers.end(), T.pos.begin(), T.pos.end());
  if constexpr (R::DOF == 1) {
    numbers.push_back(T.orient.angle());
  } else {
    numbers.insert(numbers.end(), T.orient.coeffs().begin(), T.orient.coeffs().end());
  }
}

/// Returns the next N numbers as a vector.
template <int N, class S>
mtk::vect<N, S> take(const S*& numbers) {
  mtk::vect<N, S> v;
  for (int i = 0; i < N; ++i) v[i] = *numbers++;
  return v;
}
template <class S>
mtk::SO2<S> takeSO2(const S*& numbers, const S*& tangent) {
  if (tangent != nullptr) ++tangent;
  mtk::SO2<S> R;
  mtk::detail::stateOf(R) = *numbers++;
  return R;
}
template <class S>
mtk::SO3<S> takeSO3(const S*& numbers, const S*& tangent) {
  const mtk::vect<4, S> q = take<4>(numbers);
  if constexpr (std::is_same_v<S, Number>) {
    mtk::SO3<Number>::Tangent right;
    if (tangent != nullptr) {
      right = {tangent[0], tangent[1], tangent[2]};
      tangent += 3;
    }
    return mtk::SO3<Number>(mtk::SO3<Number>::Coefficients(q[0], q[1], q[2], q[3]), right);
  } else {
    mtk::SO3<S> R;
    mtk::detail::stateOf(R) = q;
    return R;
  }
}
template <class S>
mtk::S2<S> takeS2(const S*& numbers, const S*& tangent) {
  if (tangent != nullptr) tangent += 2;
  mtk::S2<S> v;
  mtk::detail::stateOf(v) = take<3>(numbers);
  return v;
}

}  // namespace

std::shared_ptr<const ValueType> ValueType::of(nb::handle value, const std::string& subject) {
  const std::shared_ptr<ValueType> type(new ValueType);
  if (isA<mtk::SO2<double>>(value)) {
    type->kind_ = Kind::so2;
  } else if (isA<mtk::SO3<double>>(value)) {
    type->kind_ = Kind::so3;
  } else if (isA<mtk::S2<double>>(value)) {
    type->kind_ = Kind::s2;
  } else if (isA<SE2<double>>(value)) {
    type->kind_ = Kind::se2;
  } else if (isA<SE3<double>>(value)) {
    type->kind_ = Kind::se3;
  } else if (nb::hasattr(value.type(), "__slom_fields__")) {
    type->is_compound_ = true;
    type->class_ = nb::borrow(value.type());
    for (const nb::handle field : nb::object(value.type().attr("__slom_fields__"))) {
      const auto name = nb::cast<std::string>(field);
      type->members_.emplace_back(name, of(value.attr(name.c_str()), subject + "." + name));
    }
  } else {
    return array(shapeOf(realArray(value, subject)));
  }
  type->finish();
  return type;
}

std::shared_ptr<const ValueType> ValueType::array(std::vector<std::size_t> shape) {
  const std::shared_ptr<ValueType> type(new ValueType);
  type->kind_ = shape.empty() ? Kind::number : Kind::vector;
  type->shape_ = std::move(shape);
  type->finish();
  return type;
}

std::shared_ptr<const ValueType> ValueType::of(const std::shared_ptr<const RuntimeType>& runtime) {
  const std::vector<RuntimeType::Field>& fields = runtime->fields();
  const auto type = std::make_shared<ValueType>(*ofFields(fields.data(), fields.size(), 0));
  type->runtime_ = runtime;  // with its own name
  return type;
}

/// Returns the type of these fields; the first `depth` characters of their names are those of the compound around them.
std::shared_ptr<const ValueType> ValueType::ofFields(const RuntimeType::Field* first, std::size_t count,
                                                     std::size_t depth) {
  const std::shared_ptr<ValueType> type(new ValueType);
  if (count == 1 && first->name.size() <= depth) {
    type->kind_ = first->kind;
    if (first->kind == Kind::vector) type->shape_ = {static_cast<std::size_t>(first->size)};
    type->finish();
    return type;
  }
  type->is_compound_ = true;
  type->class_ = nb::module_::import_("types").attr("SimpleNamespace");
  const auto nameOf = [&](const RuntimeType::Field& field) {
    return field.name.substr(depth, field.name.find('.', depth) - depth);
  };
  for (std::size_t i = 0, end = 0; i < count; i = end) {
    const std::string name = nameOf(first[i]);
    while (end < count && nameOf(first[end]) == name) ++end;
    const bool is_nested = first[i].name.size() > depth + name.size();
    type->members_.emplace_back(name,
                                ofFields(first + i, end - i, depth + name.size() + (is_nested ? 1 : 0)));
  }
  type->finish();
  return type;
}

void ValueType::finish() {
  std::vector<RuntimeType::Field> fields;
  appendFields("", fields);
  std::string name = is_compound_ ? nb::cast<std::string>(class_.attr("__name__")) : "";
  if (!is_compound_) {
    constexpr const char* names[] = {"number", "vector", "SO2", "SO3", "S2", "SE2", "SE3"};
    name = names[static_cast<int>(kind_)];
    if (kind_ == Kind::vector) {  // so that messages can say: all 5 3-vectors
      std::string sizes;
      for (const std::size_t n : shape_) sizes += (sizes.empty() ? "" : "x") + std::to_string(n);
      name = sizes + (shape_.size() == 1 ? "-vector" : "-array");
    }
  }
  runtime_ = RuntimeType::make(std::move(name), std::move(fields));
}

void ValueType::appendFields(const std::string& path, std::vector<RuntimeType::Field>& fields) const {
  if (!is_compound_) {
    std::size_t size = 1;
    for (const std::size_t n : shape_) size *= n;
    fields.push_back({path, kind_, kind_ == Kind::vector ? static_cast<int>(size) : 1});
    return;
  }
  for (const auto& [name, type] : members_)
    type->appendFields(path.empty() ? name : path + "." + name, fields);
}

bool ValueType::operator==(const ValueType& other) const {
  return this == &other || (runtime_ == other.runtime_ && shape_ == other.shape_ &&
                            is_compound_ == other.is_compound_ && class_.is(other.class_));
}

void ValueType::append(nb::handle value, std::vector<double>& numbers, const std::string& subject) const {
  const std::size_t first = numbers.size();
  appendUnchecked(value, numbers, subject);
  if (!std::all_of(numbers.begin() + static_cast<std::ptrdiff_t>(first), numbers.end(),
                   [](double x) { return std::isfinite(x); }))
    raiseValue(subject, "has a number that is not finite", "pass finite numbers");
}

void ValueType::appendUnchecked(nb::handle value, std::vector<double>& numbers,
                                const std::string& subject) const {
  const auto requireType = [&](bool is_right) {
    if (!is_right)
      raiseValue(subject, "is a " + typeNameOf(value) + " in place of a " + runtime_->name(),
                 "pass a " + runtime_->name());
  };
  if (is_compound_) {
    requireType(value.type().is(class_));
    for (const auto& [name, type] : members_)
      type->appendUnchecked(value.attr(name.c_str()), numbers, subject + "." + name);
    return;
  }
  switch (kind_) {
    case Kind::number:
    case Kind::vector: {
      const nb::object array = realArray(value, subject);
      if (shapeOf(array) != shape_)
        raiseValue(subject, "has the shape " + textOf(shapeOf(array)), "pass one of shape " + textOf(shape_));
      const auto flat = nb::cast<Eigen::VectorXd>(array.attr("ravel")());
      numbers.insert(numbers.end(), flat.begin(), flat.end());
      break;
    }
    case Kind::so2:
      requireType(isA<mtk::SO2<double>>(value));
      numbers.push_back(nb::cast<mtk::SO2<double>>(value).angle());
      break;
    case Kind::so3: {
      requireType(isA<mtk::SO3<double>>(value));
      const auto q = nb::cast<mtk::SO3<double>>(value).coeffs();
      numbers.insert(numbers.end(), q.begin(), q.end());
      break;
    }
    case Kind::s2: {
      requireType(isA<mtk::S2<double>>(value));
      const auto v = nb::cast<mtk::S2<double>>(value).vector();
      numbers.insert(numbers.end(), v.begin(), v.end());
      break;
    }
    case Kind::se2:
      requireType(isA<SE2<double>>(value));
      appendPose(nb::cast<SE2<double>>(value), numbers);
      break;
    case Kind::se3:
      requireType(isA<SE3<double>>(value));
      appendPose(nb::cast<SE3<double>>(value), numbers);
      break;
  }
}

template <class S>
nb::object ValueType::make(const S*& numbers, const S*& tangent) const {
  if (is_compound_) {
    std::vector<nb::object> members;
    for (const auto& [name, type] : members_) members.push_back(type->make(numbers, tangent));
    return compound(members);
  }
  switch (kind_) {
    case Kind::number:
    case Kind::vector: {
      const S* const first = numbers;
      numbers += coordinates();
      if (tangent != nullptr) tangent += coordinates();
      return toPython(first, shape_);
    }
    case Kind::so2:
      return nb::cast(takeSO2(numbers, tangent));
    case Kind::so3:
      return nb::cast(takeSO3(numbers, tangent));
    case Kind::s2:
      return nb::cast(takeS2(numbers, tangent));
    case Kind::se2: {
      SE2<S> T;
      T.pos = take<2>(numbers);
      if (tangent != nullptr) tangent += 2;
      T.orient = takeSO2(numbers, tangent);
      return nb::cast(T);
    }
    case Kind::se3: {
      SE3<S> T;
      T.pos = take<3>(numbers);
      if (tangent != nullptr) tangent += 3;
      T.orient = takeSO3(numbers, tangent);
      return nb::cast(T);
    }
  }
  return nb::none();
}

/// Makes an instance without calling the constructor, which may check the values of numbers.
nb::object ValueType::compound(const std::vector<nb::object>& members) const {
  const nb::object object = nb::module_::import_("builtins").attr("object");
  nb::object result = class_.attr("__new__")(class_);
  for (std::size_t i = 0; i < members.size(); ++i)
    object.attr("__setattr__")(result, members_[i].first, members[i]);
  return result;
}

nb::object ValueType::value(const double* numbers) const {
  const double* none = nullptr;
  return make(numbers, none);
}

nb::object ValueType::recorded(const tape::Recording::Input& input) const {
  const Number* numbers = input.coordinates.data();
  const Number* tangent = input.tangent.empty() ? nullptr : input.tangent.data();
  return make(numbers, tangent);
}

std::pair<std::shared_ptr<const ValueType>, int> ValueType::member(const std::string& name) const {
  int first = 0;
  for (const auto& [own, type] : members_) {
    if (own == name) return {type, first};
    first += type->coordinates();
  }
  if (!is_compound_ && (kind_ == Kind::se2 || kind_ == Kind::se3)) {
    const std::size_t dim = kind_ == Kind::se2 ? 2 : 3;
    if (name == "pos") return {array({dim}), 0};
    if (name == "orient") {
      const std::shared_ptr<ValueType> type(new ValueType);
      type->kind_ = kind_ == Kind::se2 ? Kind::so2 : Kind::so3;
      type->finish();
      return {type, static_cast<int>(dim)};
    }
  }
  return {nullptr, 0};
}

}  // namespace slom::python
