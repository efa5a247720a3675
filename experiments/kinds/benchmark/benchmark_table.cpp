#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/kinds/benchmark/benchmark_drawing.hpp"

namespace modcal {
namespace {

using report::Cell;
using report::Highlight;

Cell number_or_none(double value) { return std::isfinite(value) ? Cell(value) : Cell(); }

// Methods in the first columns, conditions in the others.
report::Table map_of(const BenchmarkGrid& grid, std::string id, std::string title,
                     std::string caption, const char* format, const std::string& command) {
  report::Table table{.id = std::move(id),
                      .title = std::move(title),
                      .caption = std::move(caption),
                      .columns = {{.key = "objective"}, {.key = "optimizer"}},
                      .command = command};
  for (std::size_t c = 0; c < grid.conditions.size(); ++c) {
    table.columns.push_back(
        {.key = fmt::format("condition_{}", c), .name = grid.conditions[c], .format = format});
  }
  return table;
}

template <typename CellOf>
void fill_map(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells,
              const CellOf& cell_of, report::Table& table) {
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
}

}  // namespace

const BenchmarkCell* find_cell(const std::vector<BenchmarkCell>& cells, std::size_t method,
                               std::size_t condition) {
  for (const BenchmarkCell& cell : cells) {
    if (cell.method == method && cell.condition == condition) return &cell;
  }
  return nullptr;
}

std::vector<const BenchmarkCell*> ranked_cells(const std::vector<BenchmarkCell>& cells,
                                               std::size_t condition) {
  std::vector<const BenchmarkCell*> result;
  for (const BenchmarkCell& cell : cells) {
    if (cell.condition == condition) result.push_back(&cell);
  }
  std::stable_sort(result.begin(), result.end(), [](const auto* a, const auto* b) {
    if (a->rank != b->rank) return a->rank < b->rank;
    return a->successes * b->n > b->successes * a->n;
  });
  return result;
}

report::Table benchmark_table(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells,
                              const std::string& command) {
  report::Table table{
      .id = "benchmark",
      .title = "Methods by condition",
      .caption = "Methods share a rank where a paired bootstrap cannot tell them apart.",
      .columns = {{.key = "condition"},
                  {.key = "method"},
                  {.key = "rank"},
                  {.key = "n"},
                  {.key = "success", .name = "right", .format = "{:.2f}"},
                  {.key = "success_low", .name = "right, 95 % from", .format = "{:.2f}"},
                  {.key = "success_high", .name = "to", .format = "{:.2f}"},
                  {.key = "failures", .name = "without estimate"},
                  {.key = "error", .name = "frequency error, median", .format = "{:.2e}"},
                  {.key = "error_q10", .name = "10 %", .format = "{:.2e}"},
                  {.key = "error_q90", .name = "90 %", .format = "{:.2e}"},
                  {.key = "rmse", .name = "RMSE", .format = "{:.2e}"},
                  {.key = "bound", .name = "Cramér–Rao bound", .format = "{:.2e}"},
                  {.key = "bound_ratio", .name = "RMSE / bound", .format = "{:.3g}"},
                  {.key = "contact_error", .unit = "m", .format = "{:.2e}"},
                  {.key = "correlation", .name = "force correlation", .format = "{:.3f}"},
                  {.key = "evaluations", .format = "{:.0f}"},
                  {.key = "seconds", .unit = "s", .format = "{:.3g}"},
                  {.key = "reason", .name = "most frequent reason without success"}},
      .command = command};
  for (std::size_t condition = 0; condition < grid.conditions.size(); ++condition) {
    for (const BenchmarkCell* cell : ranked_cells(cells, condition)) {
      const Highlight mark = cell->successes == 0 ? Highlight::kFail : Highlight::kNone;
      Cell error(cell->error);
      error.task = cell->task;
      table.row_tags.push_back(method_tags(grid, cell->method));
      if (grid.conditions.size() > 1) {
        table.row_tags.back().push_back(condition_tag(grid, condition));
      }
      table.rows.push_back({grid.conditions[condition], grid.methods[cell->method], cell->rank,
                            cell->n, Cell(cell->success.share, mark), cell->success.low,
                            cell->success.high, cell->failures, error, cell->error_q10,
                            cell->error_q90, cell->rmse, number_or_none(cell->bound),
                            number_or_none(cell->bound_ratio), cell->contact_error,
                            cell->correlation, cell->evaluations, cell->seconds, cell->reason});
    }
  }
  return table;
}

report::Table success_map(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells,
                          const std::string& command) {
  report::Table table =
      map_of(grid, "success", "Share of draws that are right",
             "✓: more than half are right with 95 % confidence, ✗: fewer are.", "{:.2f}", command);
  fill_map(
      grid, cells,
      [](const BenchmarkCell& cell) {
        const Highlight mark = cell.success.low > 0.5    ? Highlight::kPass
                               : cell.success.high < 0.5 ? Highlight::kFail
                                                         : Highlight::kNone;
        Cell shown(cell.success.share, mark);
        shown.heat = cell.success.share;
        return shown;
      },
      table);
  return table;
}

report::Table bound_map(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells,
                        const std::string& command) {
  const bool bounded = std::any_of(cells.begin(), cells.end(), [](const BenchmarkCell& cell) {
    return std::isfinite(cell.bound_ratio);
  });
  report::Table table = map_of(
      grid, "bound_ratio", "Frequency RMSE over the Cramér–Rao bound",
      "Over all excited modes and draws with an estimate. 1 is the best that the data allow with "
      "the force unknown; an objective that is told less than both reactions cannot reach it. "
      "Without noise there is no bound.",
      "{:.3g}", command);
  if (!bounded) return table;
  fill_map(
      grid, cells,
      [](const BenchmarkCell& cell) {
        if (!std::isfinite(cell.bound_ratio)) return Cell();
        Cell shown(cell.bound_ratio);
        // Dark at the bound, white at a thousand times.
        shown.heat = std::clamp(1.0 - std::log10(cell.bound_ratio) / 3.0, 0.0, 1.0);
        return shown;
      },
      table);
  return table;
}

}  // namespace modcal
