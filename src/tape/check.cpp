#include "tape/check.hpp"

#include "mtk/error.hpp"
#include "tape/instructions.hpp"
#include "tape/kernels.hpp"

namespace slom::tape {

namespace {

[[noreturn]] void raiseBadTape(const std::string& fault) {
  throw mtk::Error("slom.bad-tape", "the tape " + fault + "; write it again with the program that made it",
                   "tape");
}

void checkSizes(const Code& code) {
  constexpr long most = kMostRegisters;
  long coordinates = 0, columns = 0;
  const auto isWithin = [&](long x) { return x >= 0 && x <= most; };
  bool good = true;
  for (const VariableType& type : code.variables) {
    for (const Part& part : type.parts) {
      good = good && part.kind <= Part::Kind::direction && isWithin(part.size);
      if (!good) raiseBadTape("has a variable of unknown type");
      coordinates += part.coordinates();
      columns += part.dof();
      good = good && isWithin(coordinates);
    }
  }
  const auto constants = static_cast<long>(code.constants.size());
  good =
      good && isWithin(code.data) && isWithin(code.rows) && isWithin(constants) && isWithin(code.registers);
  if (!good) raiseBadTape("has more than " + std::to_string(most) + " numbers");
  const long entries = code.rows * columns;
  if (entries > static_cast<long>(kMostEntries))
    raiseBadTape("has a Jacobian of more than " + std::to_string(kMostEntries) + " entries");
  if (static_cast<long>(code.entry_register.size()) != entries ||
      static_cast<long>(code.entry_constant.size()) != entries)
    raiseBadTape("has a Jacobian of another size than residual and variables");
  if (coordinates + code.data + constants + code.rows > code.registers)
    raiseBadTape("has fewer registers than inputs and outputs");
  if (code.residual.size() > kMostInstructions || code.linearization.size() > kMostInstructions)
    raiseBadTape("has more than " + std::to_string(kMostInstructions) + " instructions");
  if (code.place_of.size() != code.linearization.size())
    raiseBadTape("has another number of places than of instructions");
  for (const std::uint32_t place : code.place_of) {
    if (place > code.places.size()) raiseBadTape("refers to a place that it does not have");
  }
}

/// Checks instructions. Returns which registers have a value after the last one.
std::vector<bool> checkInstructions(const Code& code, const std::vector<Instruction>& instructions) {
  const auto first_result = static_cast<std::size_t>(code.coordinates() + code.data) + code.constants.size();
  std::vector<bool> has_value(static_cast<std::size_t>(code.registers), false);
  for (std::size_t i = 0; i < first_result; ++i) has_value[i] = true;
  const auto write = [&](std::uint16_t to, std::size_t number) {
    if (to < first_result || to >= has_value.size())
      raiseBadTape("writes to register " + std::to_string(to) + " in instruction " + std::to_string(number) +
                   ", which holds no results");
  };
  for (std::size_t i = 0; i < instructions.size(); ++i) {
    const Instruction& instruction = instructions[i];
    if (instruction.kind >= kKinds)
      raiseBadTape("has the unknown instruction " + std::to_string(instruction.kind));
    const Kind kind = static_cast<Kind>(instruction.kind);
    const int inputs = kOperandsOfKind[instruction.kind] - (hasTwoResults(kind) ? 1 : 0);
    for (int k = 0; k < inputs; ++k) {
      const std::uint16_t from = instruction.from[k];
      if (from >= has_value.size() || !has_value[from])
        raiseBadTape("reads register " + std::to_string(from) + " in instruction " + std::to_string(i) +
                     ", which has no value");
    }
    write(instruction.to, i);
    has_value[instruction.to] = true;
    if (hasTwoResults(kind)) {
      write(instruction.from[1], i);
      has_value[instruction.from[1]] = true;
    }
  }
  for (std::size_t row = 0; row < static_cast<std::size_t>(code.rows); ++row) {
    if (!has_value[first_result + row]) raiseBadTape("does not compute its residual");
  }
  return has_value;
}

}  // namespace

void checkCode(const Code& code) {
  checkSizes(code);
  checkInstructions(code, code.residual);
  const std::vector<bool> has_value = checkInstructions(code, code.linearization);
  for (const std::int32_t entry : code.entry_register) {
    const bool is_good =
        entry == -1 || (entry >= 0 && entry < code.registers && has_value[static_cast<std::size_t>(entry)]);
    if (!is_good) raiseBadTape("does not compute its Jacobian");
  }
}

int lanesFor(const Code& code) {
  constexpr int first_level = 32 * 1024 / static_cast<int>(sizeof(double));
  return code.registers * kManyLanes > first_level ? kFewLanes : kManyLanes;
}

}  // namespace slom::tape
