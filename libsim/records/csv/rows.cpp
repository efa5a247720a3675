#include "libsim/records/csv/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/base/units.hpp"
#include "libsim/records/tuning.hpp"

namespace modcal {

std::string unnamed_text(std::string_view place, std::size_t column) {
  return fmt::format("{}: column {} has no name; name every column", place, column);
}

std::vector<ColumnHeading> headings_of_row(std::span<const std::string> fields,
                                           const CsvFile& file) {
  MODCAL_REQUIRE(!are_numbers(fields, file.separator()),
                 "{}: the first row holds numbers; put a row of names before it, such as "
                 "t [s],R1 [N] (with numpy.savetxt: comments=\"\")",
                 file.place(0));
  std::vector<ColumnHeading> headings;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const ColumnHeading heading = parse_column_heading(fields[i]);
    MODCAL_REQUIRE(!heading.name.empty() || (i == 0 && fields.size() > 1), "{}",
                   unnamed_text(file.place(i), i + 1));
    for (std::size_t j = 0; j < i; ++j) {
      MODCAL_REQUIRE(headings[j].name != heading.name,
                     "{}: columns {} and {} are both named \"{}\"; give them different names",
                     file.place(i), j + 1, i + 1, heading.name);
    }
    headings.push_back(heading);
  }
  return headings;
}

bool numbers_rows(std::span<const double> column) {
  for (std::size_t i = 0; i < column.size(); ++i) {
    if (column[i] != column[0] + static_cast<double>(i)) return false;
  }
  return !column.empty() && column[0] == std::round(column[0]);
}

std::vector<std::string> units_of_row(std::span<const std::string> fields) {
  std::vector<std::string> units;
  for (std::string text : fields) {
    const bool in_brackets = text.size() > 2 && ((text.front() == '[' && text.back() == ']') ||
                                                 (text.front() == '(' && text.back() == ')'));
    if (in_brackets) text = text.substr(1, text.size() - 2);
    const bool may_be_unit = parse_number(text).kind == NumberKind::kText && is_unit(text);
    if (!text.empty() && !may_be_unit) return {};
    units.push_back(std::move(text));
  }
  const bool has_one = std::ranges::any_of(units, [](const auto& unit) { return !unit.empty(); });
  return has_one ? units : std::vector<std::string>();
}

std::string ragged_row_text(const CsvFile& file, std::size_t fields, std::size_t columns) {
  const bool decimal_commas = file.separator() == ',' && fields > columns;
  return fmt::format("{}:{}:1: the row has {} field{}, the header names {} column{}; {}",
                     file.name(), file.line(), fields, fields == 1 ? "" : "s", columns,
                     columns == 1 ? "" : "s",
                     decimal_commas ? "if these are decimal commas, write decimal points"
                                    : "give every row one number per column");
}

std::string hidden_row_text(const CsvFile& file, std::string_view text, std::size_t columns) {
  const std::size_t first = text.find(file.separator());
  const auto separators = std::count(text.begin(), text.end(), file.separator());
  if (first == std::string_view::npos || separators + 1 != static_cast<std::ptrdiff_t>(columns)) {
    return {};
  }
  const std::string_view second =
      text.substr(first + 1, text.find(file.separator(), first + 1) - first - 1);
  if (DecimalMark().parse(second, file.separator()).kind != NumberKind::kNumber) return {};
  return fmt::format(
      "{}:{}:1: \"#{}\" begins a row of samples, which is left out as a comment; write its number, "
      "or delete the rows from there on",
      file.name(), file.line(), text.substr(0, first));
}

void CommentedRate::read(std::string_view text, const CsvFile& file) {
  const std::optional<PrintedRate> told = rate_in_comment(text, file);
  if (!told) return;
  const double same = kSameRate + rate.rounding + told->rounding;
  MODCAL_REQUIRE(!(std::abs(told->hertz / rate.hertz - 1.0) > same),
                 "{}:{}: the comment says {:.9g} Hz, that on line {} {:.9g} Hz; delete one of them",
                 file.name(), file.line(), told->hertz, line, rate.hertz);
  // Of several the one with the most digits.
  if (line > 0 &&
      (!std::isfinite(told->hertz) || (is_known() && told->rounding >= rate.rounding))) {
    return;
  }
  rate = *told;
  line = file.line();
}

}  // namespace modcal
