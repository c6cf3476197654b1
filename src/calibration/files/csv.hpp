// Tables of numbers in CSV files. Errors name file, line and column.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/files/times.hpp"

namespace slom::calibration {

/// One line below the header. A field is text until it is read as a number.
class CsvRow {
 public:
  /// Takes the fields of a row. `fields` belong to the table.
  CsvRow(const std::string& file, const std::vector<std::string>& columns, int line, std::size_t first_field,
         const std::vector<std::string_view>& fields);

  int line() const { return line_; }
  /// Returns `file:line`, the beginning of an error.
  std::string place() const;
  /// Returns the field as a finite number. Throws DataError [slom.calibration.bad-file] otherwise.
  double number(std::size_t column) const;
  /// Returns the field as a finite number of magnitude `most` at most. Throws likewise.
  double number(std::size_t column, double most) const;
  /// Returns the field as a whole number from 0 on. Throws DataError [slom.calibration.bad-file] otherwise.
  int index(std::size_t column) const;
  /// Returns the digits of a whole number of any size, without leading zeros. Throws likewise.
  std::string digits(std::size_t column) const;
  /// Returns a time in this unit as whole nanoseconds from 0 on. Throws likewise.
  std::string nanoseconds(std::size_t column, TimeUnit unit) const;

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

/// Returns the names of the columns of a table with a header.
std::vector<std::string> columnsOf(std::string_view text);

/// A file with a header line of known column names. Fields are separated by commas, semicolons or tabs; the header
/// decides. With semicolons or tabs, numbers may have a decimal comma. Skipped are blank lines, lines that start with
/// #, spaces around fields and a byte order mark. A line ends with a line feed, a carriage return or both.
class CsvTable {
 public:
  /// Takes the whole text of the file. Throws DataError [slom.calibration.bad-file] if the header is different, a row
  /// has a different number of fields than the header, or there is no row.
  CsvTable(std::string file, std::string text, std::vector<std::string> columns);
  CsvTable(const CsvTable&) = delete;
  CsvTable& operator=(const CsvTable&) = delete;

  const std::string& file() const { return file_; }
  const std::vector<CsvRow>& rows() const { return rows_; }
  /// Returns the texts of the lines that start with #.
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
