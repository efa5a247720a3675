#include <set>

#include "experiments/report/encoding.hpp"
#include "experiments/report/result.hpp"

namespace modcal::report {
namespace {

void check_column(const Column& column, const Table& table) {
  try {
    static_cast<void>(fmt::format(fmt::runtime(column.format), 1.0));
  } catch (const fmt::format_error& error) {
    throw_invalid_input("table \"{}\": format \"{}\" of column \"{}\" cannot print a number ({})",
                        table.id, column.format, column.key, error.what());
  }
}

template <typename... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
template <typename... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

std::string csv_cell(const Cell& cell) {
  return std::visit(Overloaded{[](std::monostate) { return std::string(); },
                               [](bool flag) { return std::string(flag ? "true" : "false"); },
                               [](std::int64_t number) { return std::to_string(number); },
                               [](const auto& value) { return csv_field(value); }},
                    cell.value);
}

Json json_cell(const Cell& cell) {
  return std::visit(Overloaded{[](std::monostate) { return Json(); },
                               [](double number) { return number_json(number); },
                               [](const auto& value) { return Json(value); }},
                    cell.value);
}

}  // namespace

void check_table(const Table& table) {
  MODCAL_REQUIRE(is_file_stem(table.id),
                 "\"{}\" cannot name the files of a table; use letters, digits, - and _", table.id);
  MODCAL_REQUIRE(!table.columns.empty(), "table \"{}\" has no column; give 1 or more", table.id);
  std::set<std::string> keys;
  for (const Column& column : table.columns) {
    MODCAL_REQUIRE(!column.key.empty() && keys.insert(column.key).second,
                   "table \"{}\": column key \"{}\" is empty or used twice", table.id, column.key);
    check_column(column, table);
  }
  MODCAL_REQUIRE(table.row_tags.empty() || table.row_tags.size() == table.rows.size(),
                 "table \"{}\" has {} rows and tags of {}; give one list a row or none", table.id,
                 table.rows.size(), table.row_tags.size());
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    MODCAL_REQUIRE(table.rows[i].size() == table.columns.size(),
                   "table \"{}\": row {} has {} cells for {} columns", table.id, i + 1,
                   table.rows[i].size(), table.columns.size());
  }
}

std::string cell_text(const Cell& cell, const Column& column) {
  if (!cell.shown.empty()) return cell.shown;
  return std::visit(Overloaded{[](std::monostate) { return std::string("–"); },
                               [](bool flag) { return std::string(flag ? "yes" : "no"); },
                               [](std::int64_t number) { return std::to_string(number); },
                               [&](double number) {
                                 return std::isnan(number)
                                            ? "NaN"
                                            : fmt::format(fmt::runtime(column.format), number);
                               },
                               [](const std::string& text) { return text; }},
                    cell.value);
}

std::string table_csv(const Table& table) {
  std::vector<std::string> headings;
  for (const Column& column : table.columns) {
    headings.push_back(Axis{.label = column.key, .unit = column.unit}.text());
  }
  return csv_text(headings, table.rows.size(),
                  [&](std::size_t i, std::size_t j) { return csv_cell(table.rows[i][j]); });
}

std::string table_json(const Table& table) {
  Json rows = Json::array();
  for (const auto& row : table.rows) {
    Json object = Json::object();
    for (std::size_t j = 0; j < row.size(); ++j) object[table.columns[j].key] = json_cell(row[j]);
    rows.push_back(std::move(object));
  }
  return json_file(rows);
}

}  // namespace modcal::report
