// Tables of numbers in CSV files, with errors that name file, line and column.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace slom::calibration {

/// One line below the header. Fields are text until they are asked for as numbers.
class CsvRow {
 public:
  /// `fields` live in the table.
  CsvRow(const std::string& file, const std::vector<std::string>& columns, int line, std::size_t first_field,
         const std::vector<std::string_view>& fields);

  int line() const { return line_; }
  /// `file:line`, as errors begin.
  std::string place() const;
  /// The field as a finite number; DataError [slom.calibration.bad-file] otherwise.
  double number(std::size_t column) const;
  /// The same, of magnitude `most` at most.
  double number(std::size_t column, double most) const;
  /// The field as a whole number from 0 on; DataError [slom.calibration.bad-file] otherwise.
  int index(std::size_t column) const;
  /// The same without a limit: its digits, without leading zeros.
  std::string digits(std::size_t column) const;

 private:
  [[noreturn]] void fail(std::size_t column, const std::string& expectation) const;

  const std::string* file_;
  const std::vector<std::string>* columns_;
  const std::vector<std::string_view>* fields_;
  std::size_t first_field_;
  int line_;
};

struct CsvComment {
  std::string text;  ///< without the #
  int line = 0;
};

/// A file with a header line of known column names. Fields are separated by commas, semicolons or tabs, as the header is; between semicolons
/// and tabs, numbers may have a decimal comma. Blank lines and lines that start with # are skipped; spaces around fields, a byte order mark and
/// whether lines end by a line feed, a carriage return or both do not matter.
class CsvTable {
 public:
  /// Takes all of the file's text; DataError [slom.calibration.bad-file] if its header is another one, a row has another number of
  /// fields than the header, or there is no row at all.
  CsvTable(std::string file, std::string text, std::vector<std::string> columns);
  CsvTable(const CsvTable&) = delete;
  CsvTable& operator=(const CsvTable&) = delete;

  const std::string& file() const { return file_; }
  const std::vector<CsvRow>& rows() const { return rows_; }
  /// What lines that start with # say.
  const std::vector<CsvComment>& comments() const { return comments_; }

 private:
  std::string file_;
  std::vector<std::string> columns_;
  std::string text_;
  std::vector<std::string_view> fields_;  // fields of all rows, in text_
  std::vector<CsvRow> rows_;
  std::vector<CsvComment> comments_;
};

}  // namespace slom::calibration
