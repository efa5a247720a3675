#include <fmt/ranges.h>

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

// What a benchmark says in plain language.

constexpr std::size_t kMostNames = 4;

std::string listed(std::vector<std::string> names) {
  const std::size_t all = names.size();
  if (all <= kMostNames + 1) return fmt::format("{}", fmt::join(names, "; "));
  names.resize(kMostNames);
  return fmt::format("{}; {} more", fmt::join(names, "; "), all - kMostNames);
}

std::string recommended(const BenchmarkGrid& grid, const BenchmarkCell& cell) {
  const std::string bound = std::isfinite(cell.bound_ratio)
                                ? fmt::format(", RMSE {:.3g} times the bound", cell.bound_ratio)
                                : std::string();
  return fmt::format("{} (median error {:.2g}{}, {} of {} right, {:.0f} evaluations)",
                     grid.methods[cell.method], cell.error.median, bound, cell.successes, cell.n,
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
    text += fmt::format("; not to be told apart from it: {}", listed(std::move(others)));
  }
  return text;
}

// "noise 1 %, 2 %, 5 %": what all begin with is said once.
std::string conditions_text(const std::vector<std::string>& conditions) {
  const std::string& first = conditions.front();
  const std::string prefix = first.substr(0, first.find(' ') + 1);
  std::string text = first;
  for (std::size_t i = 1; i < conditions.size(); ++i) {
    const bool same = !prefix.empty() && conditions[i].starts_with(prefix) &&
                      first.find(',') == std::string::npos;
    text += ", " + (same ? conditions[i].substr(prefix.size()) : conditions[i]);
  }
  return text;
}

// Cells of some methods whose draws are mostly wrong, told together.
struct Failures {
  std::size_t n = 0, wrong = 0;
  std::vector<std::string> conditions;
  std::map<std::string, std::size_t> reasons;

  void add(const BenchmarkGrid& grid, const BenchmarkCell& cell) {
    n += cell.n;
    wrong += cell.n - cell.successes;
    reasons[cell.reason] += cell.reason_count;
    const std::string& condition = grid.conditions[cell.condition];
    if (place_in(conditions, condition) == conditions.size()) conditions.push_back(condition);
  }
  std::string sentence(const BenchmarkGrid& grid, const std::string& who) const {
    const auto [reason, count] =
        *std::max_element(reasons.begin(), reasons.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; });
    const std::string where = conditions.size() == grid.conditions.size() && conditions.size() > 1
                                  ? "all conditions"
                                  : conditions_text(conditions);
    return fmt::format("{} fails on {} of {} draws at {}; {} {}.", who, wrong, n, where,
                       count == wrong ? "it" : fmt::format("on {} it", count), reason);
  }
};

bool is_failing(const BenchmarkCell& cell) { return cell.success.high < 0.5; }

bool fails_everywhere(const std::vector<BenchmarkCell>& cells, std::size_t method) {
  return std::all_of(cells.begin(), cells.end(), [method](const BenchmarkCell& cell) {
    return cell.method != method || is_failing(cell);
  });
}

Failures failures_of(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells,
                     const std::vector<std::size_t>& methods) {
  Failures failures;
  for (const BenchmarkCell& cell : cells) {
    const bool ours = std::find(methods.begin(), methods.end(), cell.method) != methods.end();
    if (ours && is_failing(cell)) failures.add(grid, cell);
  }
  return failures;
}

// Cells of one condition, best first; equals in the order of the methods.
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

std::vector<std::string> conclusion(const BenchmarkGrid& grid,
                                    const std::vector<BenchmarkCell>& cells) {
  std::vector<std::string> sentences;
  for (std::size_t condition = 0; condition < grid.conditions.size(); ++condition) {
    const auto order = ranked_cells(cells, condition);
    if (order.empty()) continue;
    sentences.push_back(
        fmt::format("At {}: {}.", grid.conditions[condition], best_of(grid, order)));
  }
  for (const std::string& objective : distinct(grid.objectives)) {
    std::vector<std::size_t> methods;
    for (std::size_t method = 0; method < grid.methods.size(); ++method) {
      if (grid.objectives[method] == objective) methods.push_back(method);
    }
    // An objective that no optimizer gets right is one finding, not one an optimizer.
    const bool together =
        methods.size() > 1 && std::all_of(methods.begin(), methods.end(), [&](std::size_t method) {
          return fails_everywhere(cells, method);
        });
    if (together) {
      const Failures failures = failures_of(grid, cells, methods);
      if (failures.n > 0) {
        sentences.push_back(failures.sentence(grid, objective + " with every optimizer"));
      }
      continue;
    }
    for (const std::size_t method : methods) {
      const Failures failures = failures_of(grid, cells, {method});
      if (failures.n > 0) sentences.push_back(failures.sentence(grid, grid.methods[method]));
    }
  }
  return sentences;
}

}  // namespace modcal
