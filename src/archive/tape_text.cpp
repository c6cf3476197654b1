#include "archive/tape_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <sstream>
#include <system_error>

#include "archive/text.hpp"
#include "base/index.hpp"
#include "mtk/error.hpp"
#include "tape/instructions.hpp"

namespace slom::archive_text {

namespace {

using tape::Code;
using tape::Instruction;
using tape::Part;

constexpr std::string_view kNameOfKind[]{
#define SLOM_TAPE_NAME(name, operands) #name,
    SLOM_TAPE_SIMPLE(SLOM_TAPE_NAME) SLOM_TAPE_SUMS(SLOM_TAPE_NAME)
#undef SLOM_TAPE_NAME
};
constexpr std::string_view kNameOfPart[]{"vector", "angle", "rotation", "direction"};

[[noreturn]] void raise(const std::string& what) { throw mtk::Error("slom.bad-tape", what, "tape"); }

/// Adds a line to a checksum.
///   source   FNV-1a: Eastlake et al., "The FNV non-cryptographic hash algorithm", 2024
std::uint64_t checksumWith(std::uint64_t checksum, std::string_view line) {
  const auto add = [&](char c) { checksum = (checksum ^ static_cast<unsigned char>(c)) * 0x100000001b3u; };
  for (const char c : line) add(c);
  add('\n');
  return checksum;
}

std::string hexadecimal(std::uint64_t x) {
  std::string text(16, '0');
  for (auto digit = text.rbegin(); digit != text.rend(); ++digit, x >>= 4)
    *digit = "0123456789abcdef"[x & 15];
  return text;
}

/// Returns the shortest text that is read as the same number.
std::string shortest(double x) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), x);
  return error == std::errc() ? std::string(text.data(), end) : "nan";
}

void writeInstructions(std::ostream& os, const std::vector<Instruction>& instructions) {
  for (const Instruction& instruction : instructions) {
    const bool has_two_results = hasTwoResults(static_cast<tape::Kind>(instruction.kind));
    os << instruction.to;
    if (has_two_results) os << ' ' << instruction.from[1];
    os << " = " << kNameOfKind[instruction.kind];
    const int inputs = tape::kOperandsOfKind[instruction.kind] - (has_two_results ? 1 : 0);
    for (int k = 0; k < inputs; ++k) os << ' ' << instruction.from[k];
    os << '\n';
  }
}

}  // namespace

std::string textOf(const tape::Tape& tape) {
  const Code& code = tape.code();
  std::ostringstream os;
  os.imbue(std::locale::classic());
  for (const tape::VariableType& type : code.variables) {
    os << "variable " << inQuotes(type.name);
    for (const Part& part : type.parts) {
      os << ' ' << kNameOfPart[static_cast<int>(part.kind)];
      if (part.kind == Part::Kind::vector) os << ' ' << part.size;
    }
    os << '\n';
  }
  os << "data " << code.data << "\nrows " << code.rows << "\nregisters " << code.registers << "\nconstants";
  for (const double x : code.constants) os << ' ' << shortest(x);
  os << "\nresidual\n";
  writeInstructions(os, code.residual);
  os << "linearization\n";
  writeInstructions(os, code.linearization);
  os << "jacobian\n";
  for (std::size_t i = 0; i < code.entry_register.size(); ++i) {
    if (code.entry_register[i] >= 0) {
      os << code.entry_register[i];
    } else {
      os << '=' << shortest(code.entry_constant[i]);
    }
    os << ((i + 1) % at(code.rows) == 0 ? '\n' : ' ');
  }
  const std::string text = os.str();
  std::uint64_t checksum = TapeReader::kNoLines;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) checksum = checksumWith(checksum, line);
  return text + "checksum " + hexadecimal(checksum) + "\n";
}

/// The words of a line.
class TapeReader::Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}

  /// Returns the next word; empty at the end of the line.
  std::string_view next() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t"), rest_.size()));
    const std::string_view word = rest_.substr(0, rest_.find_first_of(" \t"));
    rest_.remove_prefix(word.size());
    return word;
  }
  template <class N>
  static N asNumber(std::string_view word, const char* what) {
    N x{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
    if (error != std::errc() || end != word.data() + word.size())
      raise(inQuotes(std::string(word)) + " is not " + what);
    return x;
  }
  int count() { return asNumber<int>(next(), "a number of entries"); }
  std::uint16_t toRegister() { return asNumber<std::uint16_t>(next(), "a register, 0 to 65535"); }
  void requireEnd() {
    if (const std::string_view word = next(); !word.empty())
      raise(inQuotes(std::string(word)) + " is too much in this line of the tape");
  }

 private:
  std::string_view rest_;
};

bool TapeReader::take(const std::string& line) {
  Words words(line);
  const std::string_view word = words.next();
  if (word == "checksum") {
    requireChecksum(words.next());
    words.requireEnd();
    return true;
  }
  checksum_ = checksumWith(checksum_, line);
  if (startSection(word)) {
    words.requireEnd();
  } else if (section_ == Section::head) {
    if (word == "variable") {
      takeVariable(line);
    } else {
      takeHead(word, words);
    }
  } else {
    Words all(line);
    section_ == Section::jacobian ? takeColumn(all) : takeInstruction(all);
  }
  return false;
}

bool TapeReader::startSection(std::string_view word) {
  if (word == "residual") {
    section_ = Section::residual;
  } else if (word == "linearization") {
    section_ = Section::linearization;
  } else if (word == "jacobian") {
    section_ = Section::jacobian;
  } else {
    return false;
  }
  return true;
}

void TapeReader::takeHead(std::string_view word, Words& words) {
  if (word == "constants") {
    for (std::string_view x = words.next(); !x.empty(); x = words.next())
      code_.constants.push_back(Words::asNumber<double>(x, "a number"));
    return;
  }
  if (word == "data") {
    code_.data = words.count();
  } else if (word == "rows") {
    code_.rows = words.count();
  } else if (word == "registers") {
    code_.registers = words.count();
  } else {
    raise(
        "a line of a tape cannot begin with " + inQuotes(std::string(word)) +
        "; write variable, data, rows, registers, constants, residual, linearization, jacobian or checksum");
  }
  words.requireEnd();
}

void TapeReader::takeVariable(const std::string& line) {
  std::istringstream is(line);
  is.imbue(std::locale::classic());
  std::string word;
  tape::VariableType type;
  is >> word >> std::quoted(type.name);
  if (is.fail()) raise("write variable \"TYPE\" and its parts");
  while (is >> word) {
    const auto name = std::find(std::begin(kNameOfPart), std::end(kNameOfPart), word);
    if (name == std::end(kNameOfPart))
      raise(inQuotes(word) + " is not a part of a variable; write vector N, angle, rotation or direction");
    Part part{static_cast<Part::Kind>(name - std::begin(kNameOfPart)), 0};
    if (part.kind == Part::Kind::vector && !(is >> part.size)) raise("the size of a vector is missing");
    type.parts.push_back(part);
  }
  code_.variables.push_back(std::move(type));
}

void TapeReader::takeInstruction(Words& words) {
  std::vector<Instruction>& instructions =
      section_ == Section::residual ? code_.residual : code_.linearization;
  if (instructions.size() == tape::kMostInstructions)
    raise("the tape has more than " + std::to_string(tape::kMostInstructions) + " instructions");
  Instruction instruction;
  instruction.to = words.toRegister();
  std::string_view word = words.next();
  const bool has_two_results = word != "=";
  std::uint16_t second = 0;
  if (has_two_results) {
    second = Words::asNumber<std::uint16_t>(word, "= or a register");
    word = words.next();
  }
  const std::string_view name = words.next();
  const auto kind = std::find(std::begin(kNameOfKind), std::end(kNameOfKind), name);
  if (word != "=" || kind == std::end(kNameOfKind))
    raise(inQuotes(std::string(name)) +
          " is not an instruction of tapes; write REGISTER = INSTRUCTION REGISTERS");
  instruction.kind = static_cast<std::uint16_t>(kind - std::begin(kNameOfKind));
  if (has_two_results != hasTwoResults(static_cast<tape::Kind>(instruction.kind)))
    raise("the instruction " + std::string(name) + " has " +
          (has_two_results ? "one result" : "two results"));
  const int inputs = tape::kOperandsOfKind[instruction.kind] - (has_two_results ? 1 : 0);
  for (int k = 0; k < inputs; ++k) instruction.from[k] = words.toRegister();
  if (has_two_results) instruction.from[1] = second;
  words.requireEnd();
  instructions.push_back(instruction);
  if (section_ == Section::linearization) code_.place_of.push_back(0);
}

void TapeReader::takeColumn(Words& words) {
  for (int row = 0; row < code_.rows; ++row) {
    const std::string_view word = words.next();
    const bool is_constant = word.starts_with('=');
    code_.entry_register.push_back(
        is_constant ? -1 : Words::asNumber<std::uint16_t>(word, "a register or = and a number"));
    code_.entry_constant.push_back(is_constant ? Words::asNumber<double>(word.substr(1), "a number") : 0.0);
  }
  words.requireEnd();
}

void TapeReader::requireChecksum(std::string_view stated) const {
  const std::string own = hexadecimal(checksum_);
  if (stated == own) return;
  raise("the lines of the tape have the checksum " + own + ", but the file states " +
        (stated.empty() ? "none" : std::string(stated)) +
        ": the tape was changed or damaged; write it again with the program that made it");
}

}  // namespace slom::archive_text
