/// Container: a binary file of records in sections, of which each process reads its part by offsets. docs/convert.md
/// describes the format.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom::io {

/// The problem in a container.
enum class ContainerContent : std::uint64_t { graph = 1, bundle = 2 };

/// A section of a container: records of one kind, one after another. A record is `whole` whole numbers from 0 on, then
/// `real` numbers, each in 8 bytes.
struct ContainerSection {
  std::string name;  ///< at most 24 bytes
  int whole = 0;
  int real = 0;
  std::uint64_t count = 0;   ///< number of records
  std::uint64_t offset = 0;  ///< first byte in the file
  std::uint64_t checksum =
      0;  ///< sum over the records of the WordHash of their number and words, modulo 2^64

  /// Returns the number of words of a record.
  int words() const { return whole + real; }
};

/// Records `begin` to `end` - 1 of a section.
struct ContainerRange {
  std::uint64_t begin = 0, end = 0;
};
/// Returns the records of part `part` of `parts` with about equal numbers of records.
ContainerRange rangeOf(const ContainerSection& section, int part, int parts);

/// Returns whether a file is a container. A pipe is none. Throws the errors of openInput.
bool isContainer(const std::string& file);

/// A container that is read.
class Container {
 public:
  /// Calls f(number, words) with a record: its number in the section, its words.
  using Visit = std::function<void(std::uint64_t number, std::span<const std::uint64_t> words)>;

  /// Reads the table of the sections. Throws the errors of openInput. Throws [slom.io.damaged] if the file is cut or its
  /// table damaged, and [slom.io.other-container] for another version or byte order.
  explicit Container(const std::string& file);

  /// Returns the name of the file.
  const std::string& file() const { return file_; }
  /// Returns what the container holds.
  ContainerContent content() const { return content_; }
  /// Returns the sections in the order of the file.
  const std::vector<ContainerSection>& sections() const { return sections_; }
  /// Returns the section with this name. Throws [slom.io.damaged] if there is none with so many numbers.
  const ContainerSection& section(std::string_view name, int whole, int real) const;
  /// Throws [slom.io.other-container] unless the content is what the reader wants.
  void requireContent(ContainerContent content) const;

  /// Visits the records of a range, in pieces of constant memory.
  void read(const ContainerSection& section, const ContainerRange& range, const Visit& visit) const;
  /// Returns the sum for the checksum over these records.
  std::uint64_t sum(const ContainerSection& section, const ContainerRange& range) const;
  /// Throws [slom.io.damaged] unless the sum over all records of the section is its checksum.
  void requireSum(const ContainerSection& section, std::uint64_t sum) const;
  /// Reads everything once and compares all checksums.
  void requireWhole() const;

 private:
  std::string file_;
  ContainerContent content_ = ContainerContent::graph;
  std::vector<ContainerSection> sections_;
};

/// A container that is written, in constant memory.
class ContainerWriter {
 public:
  /// Begins a container in an open file. The sections must have their names, numbers and counts. `file` is for messages.
  ContainerWriter(int descriptor, std::string file, ContainerContent content,
                  std::vector<ContainerSection> sections);
  /// Adds a record to section number `section`. Throws [slom.io.cannot-write].
  void add(std::size_t section, std::span<const std::uint64_t> words);
  /// Writes the rest and the table. Throws [slom.io.cannot-write].
  void finish();

 private:
  void flush(std::size_t section);

  int descriptor_;
  std::string file_;
  ContainerContent content_;
  std::vector<ContainerSection> sections_;
  std::vector<std::uint64_t> written_;               // records by section
  std::vector<std::vector<std::uint64_t>> buffers_;  // words by section
};

}  // namespace slom::io
