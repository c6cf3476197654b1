#include <numeric>

#include "slom/tape/input.hpp"

namespace slom::tape {

VariableType typeOf(const RuntimeType& type) {
  using Kind = RuntimeType::Kind;
  VariableType result{type.name(), {}};
  for (const RuntimeType::Field& field : type.fields()) {
    switch (field.kind) {
      case Kind::number:
        result.parts.push_back({Part::Kind::vector, 1});
        break;
      case Kind::vector:
        result.parts.push_back({Part::Kind::vector, field.size});
        break;
      case Kind::so2:
        result.parts.push_back({Part::Kind::angle, 0});
        break;
      case Kind::so3:
        result.parts.push_back({Part::Kind::rotation, 0});
        break;
      case Kind::s2:
        result.parts.push_back({Part::Kind::direction, 0});
        break;
      case Kind::se2:
        result.parts.push_back({Part::Kind::vector, 2});
        result.parts.push_back({Part::Kind::angle, 0});
        break;
      case Kind::se3:
        result.parts.push_back({Part::Kind::vector, 3});
        result.parts.push_back({Part::Kind::rotation, 0});
        break;
    }
  }
  return result;
}

Layout layoutOf(const RuntimeType& type) {
  Layout layout(static_cast<std::size_t>(type.coordinates()));
  for (std::size_t i = 0; i < layout.size(); ++i) layout[i] = static_cast<std::uint32_t>(i * sizeof(double));
  return layout;
}

}  // namespace slom::tape
