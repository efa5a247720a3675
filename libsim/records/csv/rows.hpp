// What a row of a CSV file may be that is none of samples.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libsim/records/csv_grammar.hpp"

namespace modcal {

/// The units of a row below the names, as loggers write it: "N" of "N", "[N]" or "(N)", where every
/// field is a unit or empty and one at least a unit; else nothing.
std::vector<std::string> units_of_row(std::span<const std::string> fields);

/// Why a row of so many fields is none of a file with so many columns.
std::string ragged_row_text(const CsvFile& file, std::size_t fields, std::size_t columns);

/// Why the comment `text` may be a row of samples; empty: it is none. A spreadsheet's #DIV/0!
/// begins a row as "#" begins a comment: its sample would be lost.
std::string hidden_row_text(const CsvFile& file, std::string_view text, std::size_t columns);

}  // namespace modcal
