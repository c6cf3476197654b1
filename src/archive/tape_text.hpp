/// Tapes as text. The lines, in this order:
///   variable "TYPE" PARTS            for each variable: vector N, angle, rotation, direction
///   data N                           number of columns of data
///   rows N                           length of the residual
///   registers N
///   constants X ...                  one register each
///   residual                         its instructions follow, one a line: REGISTERS = KIND REGISTERS
///   linearization                    its instructions follow
///   jacobian                         its columns follow: for each row the register, or =X for a constant
///   checksum HEX                     of the lines above
/// docs/saved_problem.md describes it. Places in the user's source are not stored: no message refers to them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "slom/tape/tape.hpp"

namespace slom::archive_text {

inline constexpr int kTapeVersion = 1;

/// Returns the lines of a tape.
std::string textOf(const tape::Tape& tape);

/// Makes a tape of its lines. Functions throw [slom.bad-tape].
class TapeReader {
 public:
  /// The checksum of no lines.
  static constexpr std::uint64_t kNoLines = 0xcbf29ce484222325u;

  /// Takes the next line. Returns whether it is the last one. The memory used is proportional to the text.
  bool take(const std::string& line);
  /// Returns the tape, whose code is checked.
  tape::Tape finish() { return tape::Tape(std::move(code_)); }

 private:
  class Words;
  enum class Section : std::uint8_t { head, residual, linearization, jacobian };
  void takeHead(std::string_view word, Words& words);
  bool startSection(std::string_view word);
  void takeVariable(const std::string& line);
  void takeInstruction(Words& words);
  void takeColumn(Words& words);
  void requireChecksum(std::string_view stated) const;

  tape::Code code_;
  Section section_ = Section::head;
  std::uint64_t checksum_ = kNoLines;
};

}  // namespace slom::archive_text
