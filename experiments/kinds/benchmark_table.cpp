#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "experiments/kinds/benchmark_report.hpp"

namespace modcal {
namespace {

using report::Cell;
using report::Highlight;

const BenchmarkCell* find_cell(const std::vector<BenchmarkCell>& cells, std::size_t method,
                               std::size_t condition) {
  for (const BenchmarkCell& cell : cells) {
    if (cell.method == method && cell.condition == condition) return &cell;
  }
  return nullptr;
}

// Cells of one condition, best first; equals in the order of the methods.
std::vector<const BenchmarkCell*> ranked(const std::vector<BenchmarkCell>& cells,
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

std::string recommended(const BenchmarkGrid& grid, const BenchmarkCell& cell) {
  return fmt::format("{} (median error {:.2g}, {} of {} right, {:.0f} evaluations)",
                     grid.methods[cell.method], cell.error, cell.successes, cell.n,
                     cell.evaluations);
}

// The methods that nothing is better than, and the cheapest of them.
std::string best_of(const BenchmarkGrid& grid, const std::vector<const BenchmarkCell*>& order) {
  std::vector<const BenchmarkCell*> best;
  for (const BenchmarkCell* cell : order) {
    if (cell->rank == 1 && cell->successes > 0) best.push_back(cell);
  }
  if (best.empty()) {
    const auto* clearest = *std::max_element(
        order.begin(), order.end(),
        [](const auto* a, const auto* b) { return a->reason_count < b->reason_count; });
    return fmt::format("no method is right; on {} of {} draws {} {}", clearest->reason_count,
                       clearest->n, grid.methods[clearest->method], clearest->reason);
  }
  const auto cheapest = std::min_element(
      best.begin(), best.end(),
      [](const auto* a, const auto* b) { return a->evaluations < b->evaluations; });
  std::string text = "use " + recommended(grid, **cheapest);
  std::vector<std::string> others;
  for (const BenchmarkCell* cell : best) {
    if (cell != *cheapest) others.push_back(grid.methods[cell->method]);
  }
  if (!others.empty()) {
    text += fmt::format("; not to be told apart from it: {}", fmt::join(others, "; "));
  }
  return text;
}

}  // namespace

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
                  {.key = "contact_error", .unit = "m", .format = "{:.2e}"},
                  {.key = "correlation", .name = "force correlation", .format = "{:.3f}"},
                  {.key = "evaluations", .format = "{:.0f}"},
                  {.key = "seconds", .unit = "s", .format = "{:.3g}"},
                  {.key = "reason", .name = "most frequent reason without success"}},
      .command = command};
  for (std::size_t condition = 0; condition < grid.conditions.size(); ++condition) {
    for (const BenchmarkCell* cell : ranked(cells, condition)) {
      const Highlight mark = cell->successes == 0 ? Highlight::kFail : Highlight::kNone;
      table.rows.push_back({grid.conditions[condition], grid.methods[cell->method], cell->rank,
                            cell->n, Cell(cell->success.share, mark), cell->success.low,
                            cell->success.high, cell->failures, cell->error, cell->error_q10,
                            cell->error_q90, cell->contact_error, cell->correlation,
                            cell->evaluations, cell->seconds, cell->reason});
    }
  }
  return table;
}

report::Table success_map(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells,
                          const std::string& command) {
  report::Table table{.id = "success",
                      .title = "Share of draws that are right",
                      .columns = {{.key = "method"}},
                      .command = command};
  for (std::size_t c = 0; c < grid.conditions.size(); ++c) {
    table.columns.push_back(
        {.key = fmt::format("condition_{}", c), .name = grid.conditions[c], .format = "{:.2f}"});
  }
  for (std::size_t method = 0; method < grid.methods.size(); ++method) {
    std::vector<Cell> row = {grid.methods[method]};
    for (std::size_t condition = 0; condition < grid.conditions.size(); ++condition) {
      const BenchmarkCell* cell = find_cell(cells, method, condition);
      if (cell == nullptr) {
        row.emplace_back();
        continue;
      }
      const Highlight mark = cell->success.low > 0.5    ? Highlight::kPass
                             : cell->success.high < 0.5 ? Highlight::kFail
                                                        : Highlight::kNone;
      row.emplace_back(cell->success.share, mark);
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<std::string> conclusion(const BenchmarkGrid& grid,
                                    const std::vector<BenchmarkCell>& cells) {
  std::vector<std::string> sentences;
  for (std::size_t condition = 0; condition < grid.conditions.size(); ++condition) {
    const auto order = ranked(cells, condition);
    if (order.empty()) continue;
    sentences.push_back(
        fmt::format("At {}: {}.", grid.conditions[condition], best_of(grid, order)));
    for (const BenchmarkCell* cell : order) {
      if (cell->success.high >= 0.5) continue;
      sentences.push_back(fmt::format("At {}: {} fails on {} of {} draws; {} {}.",
                                      grid.conditions[condition], grid.methods[cell->method],
                                      cell->n - cell->successes, cell->n,
                                      cell->reason_count == cell->n - cell->successes
                                          ? "it"
                                          : fmt::format("on {} it", cell->reason_count),
                                      cell->reason));
    }
  }
  return sentences;
}

}  // namespace modcal
