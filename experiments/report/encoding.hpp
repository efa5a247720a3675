// Values and texts as files, pages and shells take them.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace modcal::report {

/// The text between two marks, marks inside it written as `inside`.
std::string quoted(std::string_view text, char mark, std::string_view inside);

/// A field of a CSV file without commas, quotes, line ends and #; what a spreadsheet would take for
/// a formula has an apostrophe before it.
std::string csv_field(std::string_view text);
/// With all its digits; "nan" for a NaN.
std::string csv_field(double value);

/// Lines of a CSV file: the headings, then field(row, column) of every cell.
std::string csv_text(const std::vector<std::string>& headings, std::size_t rows,
                     const std::function<std::string(std::size_t, std::size_t)>& field);

/// Text for HTML content and quoted attributes: & < > " ' are escaped.
std::string html_escaped(std::string_view text);

/// The text, escaped and with its formulas set, as <p> elements; an empty line starts a new one.
std::string html_paragraphs(std::string_view text);

/// RFC 4648 with padding.
std::string base64(std::span<const unsigned char> bytes);

/// Writes beside `file` and renames: readers see the old or the new content, never a part of it.
/// Throws InvalidInput where it cannot be written.
void write_file_atomically(const std::filesystem::path& file, std::string_view content);

}  // namespace modcal::report
