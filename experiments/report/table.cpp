#include "experiments/report/table.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "experiments/report/csv_field.hpp"
#include "experiments/report/figure.hpp"
#include "libsim/base/error.hpp"

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

std::string csv_cell(const Cell& cell) {
  struct Writer {
    std::string operator()(std::monostate) const { return {}; }
    std::string operator()(bool flag) const { return flag ? "true" : "false"; }
    std::string operator()(std::int64_t number) const { return std::to_string(number); }
    std::string operator()(double number) const { return csv_field(number); }
    std::string operator()(const std::string& text) const { return csv_field(text); }
  };
  return std::visit(Writer{}, cell.value);
}

nlohmann::ordered_json json_cell(const Cell& cell) {
  struct Writer {
    nlohmann::ordered_json operator()(std::monostate) const { return nullptr; }
    nlohmann::ordered_json operator()(double number) const {
      return std::isfinite(number) ? nlohmann::ordered_json(number) : nlohmann::ordered_json();
    }
    nlohmann::ordered_json operator()(bool flag) const { return flag; }
    nlohmann::ordered_json operator()(std::int64_t number) const { return number; }
    nlohmann::ordered_json operator()(const std::string& text) const { return text; }
  };
  return std::visit(Writer{}, cell.value);
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
  struct Writer {
    const Column& column;
    std::string operator()(std::monostate) const { return "–"; }
    std::string operator()(bool flag) const { return flag ? "yes" : "no"; }
    std::string operator()(std::int64_t number) const { return std::to_string(number); }
    std::string operator()(double number) const {
      return std::isnan(number) ? "NaN" : fmt::format(fmt::runtime(column.format), number);
    }
    std::string operator()(const std::string& text) const { return text; }
  };
  return std::visit(Writer{column}, cell.value);
}

std::string table_csv(const Table& table) {
  std::string text;
  for (std::size_t j = 0; j < table.columns.size(); ++j) {
    const Axis heading{.label = table.columns[j].key, .unit = table.columns[j].unit};
    text += (j == 0 ? "" : ",") + csv_field(heading.text());
  }
  text += '\n';
  for (const auto& row : table.rows) {
    for (std::size_t j = 0; j < row.size(); ++j) text += (j == 0 ? "" : ",") + csv_cell(row[j]);
    text += '\n';
  }
  return text;
}

std::string table_json(const Table& table) {
  auto rows = nlohmann::ordered_json::array();
  for (const auto& row : table.rows) {
    auto object = nlohmann::ordered_json::object();
    for (std::size_t j = 0; j < row.size(); ++j) {
      object[table.columns[j].key] = json_cell(row[j]);
    }
    rows.push_back(std::move(object));
  }
  return rows.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

}  // namespace modcal::report
