// Tables of a report: shown in the page, written as CSV and as JSON rows.
#pragma once

#include <type_traits>
#include <utility>
#include <variant>

#include "experiments/report/figure.hpp"

namespace modcal::report {

enum class Highlight { kNone, kPass, kFail };

/// One value; std::monostate: there is none (an empty cell).
struct Cell {
  using Value = std::variant<std::monostate, bool, std::int64_t, double, std::string>;

  Cell() = default;
  Cell(double number, Highlight mark = Highlight::kNone) : value(number), highlight(mark) {}
  Cell(std::string text, Highlight mark = Highlight::kNone)
      : value(std::move(text)), highlight(mark) {}
  Cell(const char* text, Highlight mark = Highlight::kNone)
      : value(std::string(text)), highlight(mark) {}
  Cell(bool flag, Highlight mark = Highlight::kNone) : value(flag), highlight(mark) {}
  template <typename Integer>
  requires(std::is_integral_v<Integer> && !std::is_same_v<Integer, bool>)
      Cell(Integer number, Highlight mark = Highlight::kNone)
      : value(static_cast<std::int64_t>(number)), highlight(mark) {}

  Value value = {};
  /// What the page shows in its place: rounded, in another unit. Empty: the value by the column's
  /// format. The files keep the value.
  std::string shown = {};
  Highlight highlight = Highlight::kNone;
  double heat = -1.0;      ///< shade of its ground in the page, 0 to 1; below: none
  std::int64_t task = -1;  ///< task behind it, whose replay the page offers; below 0: none
};

struct Column {
  std::string key = {};           ///< name in CSV and JSON
  std::string name = {};          ///< heading in the page; empty: the key
  std::string unit = {};          ///< "1" or empty: none
  std::string format = "{:.4g}";  ///< of floating-point numbers in the page (std::format syntax)
  bool is_effort = false;         ///< ResultField::is_effort
};

struct Table {
  std::string id = {};  ///< name of its files: [A-Za-z0-9_-]+
  std::string title = {};
  std::string caption = {};
  std::vector<Column> columns = {};
  std::vector<std::vector<Cell>> rows = {};
  std::vector<Tags> row_tags = {};  ///< empty or one a row
  std::string command = {};         ///< what regenerates its numbers
};

/// Throws InvalidInput where a row has not one cell per column, tags do not come one list a row, a
/// key is empty or used twice, a format cannot print a number or the id cannot be a file name.
void check_table(const Table& table);

/// What the page shows: the cell's own text or, without one, numbers by the column's format, "NaN"
/// for a NaN, "–" for no value.
std::string cell_text(const Cell& cell, const Column& column);

/// Heading line of "key [unit]", then one line a row; numbers with all their digits, "nan" for a
/// NaN, an empty field for no value; texts as csv_field() writes them.
std::string table_csv(const Table& table);

/// Array with one object per row, {"key": value, …}; null for a NaN or no value.
std::string table_json(const Table& table);

}  // namespace modcal::report
