#include "slom/tape/tape.hpp"

#include <algorithm>
#include <bit>
#include <unordered_map>

#include "mtk/error.hpp"
#include "tape/check.hpp"

namespace slom::tape {

int Part::coordinates() const {
  switch (kind) {
    case Kind::vector:
      return size;
    case Kind::angle:
      return 1;
    case Kind::rotation:
      return 4;
    case Kind::direction:
      return 3;
  }
  return 0;
}
int Part::dof() const {
  switch (kind) {
    case Kind::vector:
      return size;
    case Kind::angle:
      return 1;
    case Kind::rotation:
      return 3;
    case Kind::direction:
      return 2;
  }
  return 0;
}

int VariableType::coordinates() const {
  int sum = 0;
  for (const Part& part : parts) sum += part.coordinates();
  return sum;
}
int VariableType::dof() const {
  int sum = 0;
  for (const Part& part : parts) sum += part.dof();
  return sum;
}

int Code::coordinates() const {
  int sum = 0;
  for (const VariableType& type : variables) sum += type.coordinates();
  return sum;
}
int Code::columns() const {
  int sum = 0;
  for (const VariableType& type : variables) sum += type.dof();
  return sum;
}

namespace {

bool areSameNumbers(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

std::uint64_t hashOf(const Code& code) {
  std::uint64_t h = 0xcbf29ce484222325u;
  const auto mix = [&](std::uint64_t x) { h = (std::rotl(h, 23) ^ x) * 0x9E3779B97F4A7C15u; };
  for (const VariableType& type : code.variables) {
    for (const char c : type.name) mix(static_cast<unsigned char>(c));
    for (const Part& part : type.parts) {
      mix(static_cast<std::uint64_t>(part.kind));
      mix(static_cast<std::uint64_t>(part.size));
    }
    mix(type.parts.size());
  }
  mix(static_cast<std::uint64_t>(code.data));
  mix(static_cast<std::uint64_t>(code.rows));
  mix(static_cast<std::uint64_t>(code.registers));
  for (const double x : code.constants) mix(std::bit_cast<std::uint64_t>(x));
  for (const auto* instructions : {&code.residual, &code.linearization}) {
    mix(instructions->size());
    for (const Instruction& instruction : *instructions) {
      mix((std::uint64_t{instruction.kind} << 16) | instruction.to);
      for (const std::uint16_t from : instruction.from) mix(from);
    }
  }
  for (const std::int32_t entry : code.entry_register) mix(static_cast<std::uint64_t>(entry));
  for (const double x : code.entry_constant) mix(std::bit_cast<std::uint64_t>(x));
  return h;
}

}  // namespace

Tape::Tape(Code code) : code_(std::move(code)) {
  checkCode(code_);
  for (const VariableType& type : code_.variables) sizes_.push_back(type.coordinates());
  coordinates_ = code_.coordinates();
  columns_ = code_.columns();
  std::unordered_map<std::uint64_t, int> row_of_constant;  // by its bits
  for (std::size_t i = 0; i < code_.entry_register.size(); ++i) {
    if (code_.entry_register[i] >= 0) {
      entry_row_.push_back(code_.entry_register[i]);
      continue;
    }
    const double constant = code_.entry_constant[i];
    const auto [known, is_new] = row_of_constant.try_emplace(
        std::bit_cast<std::uint64_t>(constant), code_.registers + static_cast<int>(entries_.size()));
    entry_row_.push_back(known->second);
    if (is_new) entries_.push_back(constant);
  }
  lanes_ = lanesFor(code_);
  hash_ = hashOf(code_);
}

bool Tape::isZero(int row, int column) const {
  return isConstant(row, column) &&
         code_.entry_constant[static_cast<std::size_t>(column * code_.rows + row)] == 0;
}

bool Tape::operator==(const Tape& other) const {
  const Code &a = code_, &b = other.code_;
  return hash_ == other.hash_ && a.variables == b.variables && a.data == b.data && a.rows == b.rows &&
         a.registers == b.registers && areSameNumbers(a.constants, b.constants) && a.residual == b.residual &&
         a.linearization == b.linearization && a.entry_register == b.entry_register &&
         areSameNumbers(a.entry_constant, b.entry_constant);
}

}  // namespace slom::tape
