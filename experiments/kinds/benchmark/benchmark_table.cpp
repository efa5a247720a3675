#include "experiments/kinds/benchmark/benchmark.hpp"

namespace modcal {
namespace {

// The cell of a method under a condition; null: nothing of it is finished.
const BenchmarkCell* find_cell(const std::vector<BenchmarkCell>& cells, std::size_t method,
                               std::size_t condition) {
  for (const BenchmarkCell& cell : cells) {
    if (cell.method == method && cell.condition == condition) return &cell;
  }
  return nullptr;
}

using report::Cell;
using report::Highlight;

// Methods in the first columns, conditions in the others.
template <typename CellOf>
report::Table map_of(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells,
                     const char* format, report::Table table, const CellOf& cell_of) {
  table.columns = {{.key = "objective"}, {.key = "optimizer"}};
  for (std::size_t c = 0; c < grid.conditions.size(); ++c) {
    table.columns.push_back(
        {.key = fmt::format("condition_{}", c), .name = grid.conditions[c], .format = format});
  }
  for (std::size_t method = 0; method < grid.methods.size(); ++method) {
    std::vector<Cell> row = {grid.objectives[method], grid.searches[method]};
    for (std::size_t condition = 0; condition < grid.conditions.size(); ++condition) {
      const BenchmarkCell* cell = find_cell(cells, method, condition);
      row.push_back(cell == nullptr ? Cell() : cell_of(*cell));
      if (cell != nullptr) row.back().task = cell->task;
    }
    table.rows.push_back(std::move(row));
    table.row_tags.push_back(method_tags(grid, method));
  }
  return table;
}

void write_cell(report::RowWriter& row, const BenchmarkGrid& grid, const BenchmarkCell& cell) {
  row({.key = "condition"}, grid.conditions[cell.condition]);
  row({.key = "method"}, grid.methods[cell.method]);
  row({.key = "rank"}, cell.rank);
  row({.key = "n"}, cell.n);
  row.cell({.key = "success", .name = "right", .format = "{:.2f}"},
           {cell.success.share, cell.successes == 0 ? Highlight::kFail : Highlight::kNone});
  row({.key = "success_low", .name = "right, 95 % from", .format = "{:.2f}"}, cell.success.low);
  row({.key = "success_high", .name = "to", .format = "{:.2f}"}, cell.success.high);
  row({.key = "failures", .name = "without estimate"}, cell.failures);
  Cell error(cell.error.median);
  error.task = cell.task;
  row.cell({.key = "error", .name = "frequency error, median", .format = "{:.2e}"}, error);
  row({.key = "error_q10", .name = "10 %", .format = "{:.2e}"}, cell.error.q10);
  row({.key = "error_q90", .name = "90 %", .format = "{:.2e}"}, cell.error.q90);
  row({.key = "rmse", .name = "RMSE", .format = "{:.2e}"}, cell.rmse);
  row({.key = "bound", .name = "Cramér–Rao bound", .format = "{:.2e}"}, known(cell.bound));
  row({.key = "bound_ratio", .name = "RMSE / bound", .format = "{:.3g}"}, known(cell.bound_ratio));
  row({.key = "contact_error", .unit = "m", .format = "{:.2e}"}, cell.contact_error);
  row({.key = "correlation", .name = "force correlation", .format = "{:.3f}"}, cell.correlation);
  row({.key = "evaluations", .format = "{:.0f}"}, cell.evaluations);
  row({.key = "seconds", .unit = "s", .format = "{:.3g}"}, cell.seconds);
  row({.key = "reason", .name = "most frequent reason without success"}, cell.reason);
}

}  // namespace

report::Table benchmark_table(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells) {
  report::Table table{
      .id = "benchmark",
      .title = "Methods by condition",
      .caption = "Methods share a rank where a paired bootstrap cannot tell them apart."};
  std::vector<BenchmarkCell> ranked;
  for (std::size_t condition = 0; condition < grid.conditions.size(); ++condition) {
    for (const BenchmarkCell* cell : ranked_cells(cells, condition)) {
      ranked.push_back(*cell);
      table.row_tags.push_back(method_tags(grid, cell->method));
      if (grid.conditions.size() > 1) {
        table.row_tags.back().push_back(condition_tag(grid, condition));
      }
    }
  }
  return report::table_of(
      std::move(table), ranked,
      [&grid](report::RowWriter& row, const BenchmarkCell& cell) { write_cell(row, grid, cell); });
}

report::Table success_map(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells) {
  return map_of(grid, cells, "{:.2f}",
                {.id = "success",
                 .title = "Share of draws that are right",
                 .caption = "✓: more than half are right with 95 % confidence, ✗: fewer are."},
                [](const BenchmarkCell& cell) {
                  const Highlight mark = cell.success.low > 0.5    ? Highlight::kPass
                                         : cell.success.high < 0.5 ? Highlight::kFail
                                                                   : Highlight::kNone;
                  Cell shown(cell.success.share, mark);
                  shown.heat = cell.success.share;
                  return shown;
                });
}

report::Table bound_map(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells) {
  const bool bounded = std::any_of(cells.begin(), cells.end(), [](const BenchmarkCell& cell) {
    return std::isfinite(cell.bound_ratio);
  });
  if (!bounded) return {};
  return map_of(
      grid, cells, "{:.3g}",
      {.id = "bound_ratio",
       .title = "Frequency RMSE over the Cramér–Rao bound",
       .caption =
           "Over all excited modes and draws with an estimate. 1 is the best that the data allow "
           "with the force unknown; an objective that is told less than both reactions cannot "
           "reach it. Without noise there is no bound."},
      [](const BenchmarkCell& cell) {
        if (!std::isfinite(cell.bound_ratio)) return Cell();
        Cell shown(cell.bound_ratio);
        // Dark at the bound, white at a thousand times.
        shown.heat = std::clamp(1.0 - std::log10(cell.bound_ratio) / 3.0, 0.0, 1.0);
        return shown;
      });
}

}  // namespace modcal
