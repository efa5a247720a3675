// What one run of a list leaves.
#include <algorithm>
#include <set>

#include "experiments/kinds/kind_list.hpp"

namespace modcal {
namespace {

// That of the column, or what the row says.
std::string unit_of(const report::Table& table, const std::vector<report::Cell>& row,
                    std::size_t column) {
  if (!table.columns[column].unit.empty()) return table.columns[column].unit;
  const auto unit = std::ranges::find(table.columns, "unit", &report::Column::key);
  if (unit == table.columns.end()) return {};
  const auto place = static_cast<std::size_t>(unit - table.columns.begin());
  const auto* text = std::get_if<std::string>(&row[place].value);
  return text != nullptr ? *text : std::string();
}

void add_numbers(const report::Table& table, RunOutcome& outcome) {
  std::set<std::string> labels;
  for (const std::vector<report::Cell>& row : table.rows) {
    // A table of one row needs no names of rows; rows of one name are counted.
    std::string prefix = table.id + ".";
    const bool is_one = table.rows.size() == 1;
    if (!is_one) {
      std::string label = report::cell_text(row[0], table.columns[0]);
      if (!labels.insert(label).second) label += fmt::format(".{}", labels.size());
      labels.insert(label);
      prefix += label + ".";
    }
    for (std::size_t c = is_one ? 0 : 1; c < row.size(); ++c) {
      const auto* number = std::get_if<double>(&row[c].value);
      const auto* count = std::get_if<std::int64_t>(&row[c].value);
      if ((number == nullptr && count == nullptr) || table.columns[c].is_effort) continue;
      std::string name = prefix + table.columns[c].key, unit = unit_of(table, row, c);
      if (!unit.empty() && unit != "1") outcome.units.emplace_back(name, std::move(unit));
      outcome.numbers.emplace_back(std::move(name),
                                   number != nullptr ? *number : static_cast<double>(*count));
    }
  }
}

}  // namespace

void RunOutcome::visit(ResultVisitor& visitor) {
  visitor({.key = "failure", .optional = true}, failure);
  if (!failure.empty()) return;
  visitor({.key = "numbers"}, numbers);
  visitor({.key = "units", .optional = true}, units);
  visitor({.key = "warnings", .optional = true}, warnings);
}

RunOutcome run_outcome(const StudyResult& result) {
  RunOutcome outcome{.warnings = result.warnings};
  if (result.status == report::Status::kFailed) {
    outcome.failure = !result.answer.empty()    ? result.answer
                      : !result.summary.empty() ? result.summary
                                                : "the run has failed";
  }
  for (const report::Block& block : result.blocks) {
    if (const auto* table = std::get_if<report::Table>(&block)) add_numbers(*table, outcome);
  }
  return outcome;
}

}  // namespace modcal
