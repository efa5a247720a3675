// What a row of a CSV file may be that is none of samples.
#pragma once

#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libsim/records/csv_grammar.hpp"

namespace modcal {

/// The headings of a first row; the first of several may have no name. Throws InvalidInput, with
/// the place, for numbers, other columns without a name and equal names.
std::vector<ColumnHeading> headings_of_row(std::span<const std::string> fields,
                                           const CsvFile& file);

/// Why a column, from 1, cannot be read.
std::string unnamed_text(std::string_view place, std::size_t column);

/// Whether each is one more than the one before, from a whole number on.
bool numbers_rows(std::span<const double> column);

/// The units of a row below the names, as loggers write it: "N" of "N", "[N]" or "(N)", where every
/// field is a unit or empty and one at least a unit; else nothing.
std::vector<std::string> units_of_row(std::span<const std::string> fields);

/// Why a row of so many fields is none of a file with so many columns.
std::string ragged_row_text(const CsvFile& file, std::size_t fields, std::size_t columns);

/// Why the comment `text` may be a row of samples; empty: it is none. A spreadsheet's #DIV/0!
/// begins a row as "#" begins a comment: its sample would be lost.
std::string hidden_row_text(const CsvFile& file, std::string_view text, std::size_t columns);

/// The rate that the comments of a file tell.
struct CommentedRate {
  PrintedRate rate = {};
  std::size_t line = 0;  ///< of the first one

  bool is_known() const { return std::isfinite(rate.hertz); }
  /// Throws InvalidInput where the comment tells another rate than one before.
  void read(std::string_view text, const CsvFile& file);
};

}  // namespace modcal
