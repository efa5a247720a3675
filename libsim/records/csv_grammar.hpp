// The grammar of a CSV file: lines, comments, separators and quotes; numbers are not its business.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace modcal {

/// Receives what a CSV file is made of, in its order.
class CsvHandler {
 public:
  virtual ~CsvHandler() = default;
  /// A line whose first character (blanks aside) is '#'; `text` is what follows it.
  virtual void comment(std::string_view text) = 0;
  /// Field `index` (from 0) of the current row, without its quotes and the blanks around it.
  virtual void field(std::size_t index, std::string_view text) = 0;
  virtual void end_row(std::size_t fields) = 0;
};

/// A CSV file opened for one pass (RFC 4180, with comment lines; the separator is a tab, else a
/// semicolon, else a comma, the first of these that stands in the header; LF, CRLF or CR ends a
/// line; a UTF-8 byte order mark is skipped). Memory: one line.
class CsvFile {
 public:
  /// Throws InvalidInput where the file cannot be read, is empty or is not 8-bit text.
  explicit CsvFile(const std::filesystem::path& path);

  /// Reads the file to its end. Throws InvalidInput where a quote is misplaced or never closed.
  void parse(CsvHandler& handler);

  const std::string& name() const { return name_; }
  /// The separator found; 0 before the header is read.
  char separator() const { return separator_; }
  /// Number of the line being read, from 1.
  std::size_t line() const { return line_; }
  /// "file:line:column" of field `index` of the line being read.
  std::string place(std::size_t index) const;

 private:
  class Parser;
  bool next_line();

  std::string name_;
  std::ifstream file_;
  char newline_ = '\n';
  char separator_ = 0;
  std::string text_;
  std::size_t line_ = 0;
};

}  // namespace modcal
