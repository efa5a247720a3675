#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>

#include "experiments/kinds/sweep/sweep_figures.hpp"
#include "experiments/kinds/sweep/sweep_rows.hpp"

namespace modcal {

void SweepTableOptions::visit(OptionVisitor& visitor) {
  visitor.text({.key = "name", .meaning = "name of the table's files"}, name);
}

void ComparisonOptions::visit(OptionVisitor& visitor) {
  visitor.text({.key = "table",
                .meaning = "published figures: CSV with noise_percent, R1, epsilon1, R2, epsilon2",
                .required = true},
               table);
  visitor.number({.key = "lowest_row",
                  .meaning = "rows below this noise level are shown but not judged",
                  .unit = "1",
                  .range = Range::non_negative()},
                 lowest_row);
  visitor.number({.key = "mean_difference",
                  .meaning = "largest accepted mean |R_median - published R|; any: not judged",
                  .range = Range::non_negative(),
                  .word = "any"},
                 mean_difference);
  visitor.integer({.key = "inside_band",
                   .meaning = "least number of cells whose published R lies in the 10-90 % band",
                   .range = Range::non_negative()},
                  inside_band);
  visitor.number({.key = "parameter_factor",
                  .meaning = "factor within which the parameter agrees with the published one",
                  .range = Range::at_least(1.0)},
                 parameter_factor);
  visitor.integer({.key = "parameter_cells",
                   .meaning = "least number of cells whose parameter agrees",
                   .range = Range::non_negative()},
                  parameter_cells);
}

void SweepTarget::visit(OptionVisitor& visitor) {
  visitor.text({.key = "side",
                .meaning = "row of the table: 1, 2, or the estimator's name for its estimate",
                .required = true},
               side);
  visitor.number({.key = "noise",
                  .meaning = "row of the table: noise level",
                  .range = Range::non_negative(),
                  .required = true},
                 noise);
  visitor.number({.key = "correlation",
                  .meaning = "least mean correlation over windows and draws",
                  .range = Range::closed(-1.0, 1.0)},
                 correlation);
  visitor.number({.key = "whole",
                  .meaning = "least mean correlation over the long window",
                  .range = Range::closed(-1.0, 1.0)},
                 whole);
}

namespace {

report::Cell number_or_none(double value) {
  return std::isnan(value) ? report::Cell() : report::Cell(value);
}

report::Cell optional_cell(const std::optional<double>& value) {
  return value ? report::Cell(*value) : report::Cell();
}

report::Table sweep_table(const std::string& name, const std::vector<SweepRow>& rows,
                          const std::string& command) {
  report::Table table{
      .id = name,
      .title = "Correlation and water level against noise",
      .columns =
          {{.key = "noise_percent", .name = "noise", .unit = "%"},
           {.key = "side"},
           {.key = "R_median", .name = "R, median", .format = "{:.2f}"},
           {.key = "R_q10", .name = "R, 10 %", .format = "{:.2f}"},
           {.key = "R_q90", .name = "R, 90 %", .format = "{:.2f}"},
           {.key = "relative_rms_error_median",
            .name = "relative rms error, median",
            .format = "{:.2f}"},
           {.key = "R_mean", .name = "R, mean", .format = "{:.3f}"},
           {.key = "relative_rms_error_mean",
            .name = "relative rms error, mean",
            .format = "{:.3f}"},
           {.key = "R_anti_aliased_mean", .name = "R anti-aliased, mean", .format = "{:.3f}"},
           {.key = "R_whole_mean", .name = "R long window, mean", .format = "{:.3f}"},
           {.key = "whole_relative_rms_error_mean",
            .name = "relative rms error long window, mean",
            .format = "{:.3f}"},
           {.key = "R_whole_anti_aliased_mean",
            .name = "R long window anti-aliased, mean",
            .format = "{:.3f}"},
           {.key = "n"},
           {.key = "epsilon_median", .name = "epsilon, median", .unit = "N/N", .format = "{:.3g}"},
           {.key = "paper_R", .name = "R, paper", .format = "{:.2f}"},
           {.key = "paper_epsilon", .name = "epsilon, paper", .unit = "N/N", .format = "{:.3g}"},
           {.key = "misfit_mean", .name = "misfit J, mean", .format = "{:.3f}"},
           {.key = "stand_ins", .name = "no interior minimum"},
           {.key = "warned", .name = "draws with a warning"},
           {.key = "failures"}},
      .command = command};
  for (const SweepRow& row : rows) {
    table.rows.push_back({row.noise_percent,
                          side_cell(row.side),
                          row.median,
                          row.q10,
                          row.q90,
                          row.rms_median,
                          number_or_none(mean_of(row.correlation)),
                          number_or_none(mean_of(row.rms_error)),
                          number_or_none(mean_of(row.anti_aliased)),
                          number_or_none(mean_of(row.whole)),
                          number_or_none(mean_of(row.whole_rms_error)),
                          number_or_none(mean_of(row.whole_anti_aliased)),
                          row.correlation.size(),
                          row.parameter_median,
                          optional_cell(row.published_correlation),
                          optional_cell(row.published_parameter),
                          number_or_none(mean_of(row.misfit)),
                          row.stand_ins,
                          row.warned,
                          row.failures});
  }
  return table;
}

report::Table task_table(const std::vector<std::string>& axes, const std::vector<SweepCell>& cells,
                         const std::vector<std::optional<TaskOutcome>>& outcomes,
                         const std::string& command) {
  report::Table table{
      .id = "tasks", .title = "Tasks", .columns = {{.key = "task"}}, .command = command};
  for (const std::string& axis : axes) table.columns.push_back({.key = axis});
  for (const char* key : {"side", "epsilon", "choice", "window_start", "R", "relative_rms_error",
                          "R_anti_aliased", "R_whole", "whole_relative_rms_error",
                          "R_whole_anti_aliased", "misfit", "warnings", "failure"}) {
    table.columns.push_back({.key = key});
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!outcomes[i]) continue;
    std::vector<report::Cell> head = {i};
    head.insert(head.end(), cells[i].axis_values.begin(), cells[i].axis_values.end());
    if (!outcomes[i]->failure.empty()) {
      std::vector<report::Cell> row = head;
      row.resize(table.columns.size());
      row.back() = outcomes[i]->failure;
      table.rows.push_back(std::move(row));
    }
    for (const TaskScores& side : outcomes[i]->sides) {
      for (const WindowScore& score : side.scores) {
        std::vector<report::Cell> row = head;
        row.insert(
            row.end(),
            {side_cell(side.side), side.parameter, std::string(name_of(side.status)), score.start,
             score.correlation, score.relative_rms_error, number_or_none(score.anti_aliased),
             number_or_none(side.whole.correlation), number_or_none(side.whole.relative_rms_error),
             number_or_none(side.whole.anti_aliased), number_or_none(side.misfit),
             fmt::format("{}", fmt::join(side.warnings, "; ")), report::Cell()});
        table.rows.push_back(std::move(row));
      }
    }
  }
  return table;
}

std::string printed_table(const std::vector<SweepRow>& rows) {
  std::string text =
      "noise %  side          R median [10 %, 90 %]   n   paper R   epsilon   paper epsilon   R "
      "mean"
      "   R long\n";
  const auto optional_text = [](const std::optional<double>& value, int digits) {
    return value ? fmt::format("{:.{}f}", *value, digits) : std::string("-");
  };
  for (const SweepRow& row : rows) {
    text += fmt::format(
        "{:7.3g}  {:<12}  {:5.2f}  [{:5.2f}, {:5.2f}]  {:3d}   {:>7}   {:7.3g}   {:>13}   {:6.3f}  "
        " "
        "{:6.3f}\n",
        row.noise_percent, row.side, row.median, row.q10, row.q90, row.correlation.size(),
        optional_text(row.published_correlation, 2), row.parameter_median,
        optional_text(row.published_parameter, 3), mean_of(row.correlation), mean_of(row.whole));
  }
  return text;
}

void add_judgement(const Judgement& judgement, const ComparisonOptions& options,
                   StudyResult& result) {
  const auto line = [&](std::string_view what, double reached, bool passed, std::string limit) {
    const std::string text = fmt::format("{}: {:.3g} ({})", what, reached, limit);
    result.summary += text + (passed ? "" : "  MISSED") + "\n";
    result.blocks.emplace_back(
        report::Text{text, passed ? report::Text::Kind::kNote : report::Text::Kind::kFailure});
    if (!passed) result.missed.push_back(text);
  };
  const std::string of_cells = fmt::format(" of {} cells", judgement.cells);
  const bool any = std::isnan(options.mean_difference) || std::isinf(options.mean_difference);
  line("mean |R_median - paper R|", judgement.mean_difference(),
       any || judgement.mean_difference() <= options.mean_difference,
       any ? "not judged" : fmt::format("accepted up to {:g}", options.mean_difference));
  line("paper R inside the 10-90 % band" + of_cells, static_cast<double>(judgement.inside_band),
       judgement.inside_band >= static_cast<std::size_t>(options.inside_band),
       fmt::format("accepted from {}", options.inside_band));
  line(fmt::format("epsilon within a factor {:g}", options.parameter_factor) + of_cells,
       static_cast<double>(judgement.parameter_cells),
       judgement.parameter_cells >= static_cast<std::size_t>(options.parameter_cells),
       fmt::format("accepted from {}", options.parameter_cells));
}

void judge_targets(const std::vector<SweepTarget>& targets, const std::vector<SweepRow>& rows,
                   StudyResult& result) {
  for (const SweepTarget& target : targets) {
    double reached = std::numeric_limits<double>::quiet_NaN(), whole = reached;
    for (const SweepRow& row : rows) {
      if (row.side != target.side || std::abs(row.noise_percent - 100.0 * target.noise) > 1e-6) {
        continue;
      }
      reached = mean_of(row.correlation);
      whole = mean_of(row.whole);
    }
    const bool passed =
        reached >= target.correlation && (target.whole == 0.0 || whole >= target.whole);
    const std::string text = fmt::format(
        "{} at {:g} % noise: {:.4f} (accepted from {:g}), long window {:.4f} (from {:g})",
        target.side, 100.0 * target.noise, reached, target.correlation, whole, target.whole);
    result.summary += text + (passed ? "" : "  MISSED") + "\n";
    result.blocks.emplace_back(
        report::Text{text, passed ? report::Text::Kind::kNote : report::Text::Kind::kFailure});
    if (!passed) result.missed.push_back(text);
  }
}

void count_tasks(const std::vector<std::optional<TaskOutcome>>& outcomes, StudyResult& result) {
  for (const std::optional<TaskOutcome>& outcome : outcomes) {
    if (!outcome) {
      ++result.pending_tasks;
    } else if (!outcome->failure.empty()) {
      ++result.failed_tasks;
    }
  }
  const std::size_t finished = outcomes.size() - result.pending_tasks;
  const bool nothing = finished > 0 && result.failed_tasks == finished;
  result.status = nothing                   ? report::Status::kFailed
                  : result.failed_tasks > 0 ? report::Status::kSomeFailed
                                            : report::Status::kOk;
}

}  // namespace

StudyResult sum_up_sweep(const SweepOptions& options, const std::vector<std::string>& axes,
                         const std::vector<SweepCell>& cells,
                         const std::vector<std::optional<TaskOutcome>>& outcomes,
                         const StudyContext& context) {
  PublishedTable published;
  if (options.has_comparison) {
    published = read_published(context.folder / options.comparison.table);
  }
  const std::vector<SweepRow> rows = sweep_rows(cells, outcomes, published);

  StudyResult result;
  count_tasks(outcomes, result);
  result.summary = printed_table(rows);
  result.blocks.emplace_back(sweep_table(options.table.name, rows, context.command));
  // Figures of a part are no figures of the whole.
  if (options.has_comparison && result.pending_tasks == 0) {
    add_judgement(judge(rows, options.comparison), options.comparison, result);
  }
  if (result.pending_tasks == 0) judge_targets(options.targets, rows, result);
  result.blocks.emplace_back(correlation_figure(options.table.name, rows, context.command));
  result.files.emplace_back("tasks.csv",
                            report::table_csv(task_table(axes, cells, outcomes, context.command)));
  if (result.failed_tasks > 0) {
    result.summary +=
        fmt::format("{} of {} tasks failed; see tasks.csv\n", result.failed_tasks, outcomes.size());
  }
  return result;
}

}  // namespace modcal
