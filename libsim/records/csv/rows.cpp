#include "libsim/records/csv/rows.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libsim/base/units.hpp"

namespace modcal {

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

}  // namespace modcal
