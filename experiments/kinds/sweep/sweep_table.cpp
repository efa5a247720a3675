// Tables and acceptance of a sweep.
#include <fmt/ranges.h>

#include "experiments/kinds/sweep/sweep.hpp"

namespace modcal {
namespace {

void write_row(report::RowWriter& row, const SweepRow& item) {
  row({.key = "noise_percent", .name = "noise", .unit = "%"}, item.noise_percent);
  row.cell({.key = "side"}, side_cell(item.side));
  row({.key = "R_median", .name = "R, median", .format = "{:.2f}"}, item.correlation.median());
  row({.key = "R_q10", .name = "R, 10 %", .format = "{:.2f}"}, item.correlation.q10());
  row({.key = "R_q90", .name = "R, 90 %", .format = "{:.2f}"}, item.correlation.q90());
  row({.key = "relative_rms_error_median",
       .name = "relative rms error, median",
       .format = "{:.2f}"},
      item.rms_error.median());
  const auto mean = [&row](std::string_view key, std::string_view name, const Sample& sample) {
    row({.key = key, .name = name, .format = "{:.3f}"}, known(sample.known_mean()));
  };
  mean("R_mean", "R, mean", item.correlation);
  mean("relative_rms_error_mean", "relative rms error, mean", item.rms_error);
  mean("R_anti_aliased_mean", "R anti-aliased, mean", item.anti_aliased);
  mean("R_whole_mean", "R long window, mean", item.whole);
  mean("whole_relative_rms_error_mean", "relative rms error long window, mean",
       item.whole_rms_error);
  mean("R_whole_anti_aliased_mean", "R long window anti-aliased, mean", item.whole_anti_aliased);
  row({.key = "n"}, item.correlation.values.size());
  row({.key = "epsilon_median", .name = "epsilon, median", .unit = "N/N", .format = "{:.3g}"},
      item.parameter.median());
  row({.key = "paper_R", .name = "R, paper", .format = "{:.2f}"}, item.published_correlation);
  row({.key = "paper_epsilon", .name = "epsilon, paper", .unit = "N/N", .format = "{:.3g}"},
      item.published_parameter);
  mean("misfit_mean", "misfit J, mean", item.misfit);
  row({.key = "stand_ins", .name = "no interior minimum"}, item.stand_ins);
  row({.key = "warned", .name = "draws with a warning"}, item.warned);
  row({.key = "failures"}, item.failures);
}

// A row of tasks.csv: a side and a window of a task, or the failure of a task.
struct ScoreRow {
  const SweepTask* task = nullptr;  ///< null: a list in which nothing is finished
  const TaskScores* side = nullptr;
  const WindowScore* score = nullptr;
};

void write_score(report::RowWriter& row, const ScoreRow& item,
                 const std::vector<std::string>& axes) {
  static const SweepTask kNoTask;
  const SweepTask& task = item.task != nullptr ? *item.task : kNoTask;
  row({.key = "task"}, task.task);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    row({.key = axes[i]}, i < task.axis_values.size() ? task.axis_values[i] : std::string());
  }
  // Nothing of a failed task but its reason is known.
  static const TaskScores kNoSide;
  static const WindowScore kNoScore{.start = std::numeric_limits<double>::quiet_NaN()};
  const bool is_there = item.side != nullptr;
  const TaskScores& side = is_there ? *item.side : kNoSide;
  const WindowScore& score = is_there ? *item.score : kNoScore;
  const auto scored = [&](std::string_view key, report::Cell cell) {
    row.cell({.key = key}, is_there ? std::move(cell) : report::Cell());
  };
  scored("side", side_cell(side.side));
  scored("epsilon", side.parameter);
  scored("choice", std::string(name_of(side.status)));
  scored("window_start", score.start);
  scored("R", score.correlation);
  scored("relative_rms_error", score.relative_rms_error);
  row({.key = "R_anti_aliased"}, known(score.anti_aliased));
  row({.key = "coverage"}, known(score.coverage));
  row({.key = "R_whole"}, known(side.whole.correlation));
  row({.key = "whole_relative_rms_error"}, known(side.whole.relative_rms_error));
  row({.key = "R_whole_anti_aliased"}, known(side.whole.anti_aliased));
  row({.key = "misfit"}, known(side.misfit));
  scored("warnings", fmt::format("{}", fmt::join(side.warnings, "; ")));
  row.cell({.key = "failure"}, is_there ? report::Cell() : task.outcome.failure);
}

report::Table task_table(const std::vector<std::string>& axes,
                         const std::vector<SweepTask>& tasks) {
  std::vector<ScoreRow> rows;
  for (const SweepTask& task : tasks) {
    if (!task.outcome.failure.empty()) rows.push_back({&task});
    for (const TaskScores& side : task.outcome.sides) {
      for (const WindowScore& score : side.scores) rows.push_back({&task, &side, &score});
    }
  }
  return report::table_of(
      {.id = "tasks", .title = "Tasks"}, rows,
      [&axes](report::RowWriter& row, const ScoreRow& item) { write_score(row, item, axes); });
}

std::string printed_table(const std::vector<SweepRow>& rows) {
  const bool any_whole = std::ranges::any_of(
      rows, [](const SweepRow& row) { return !std::isnan(row.whole.known_mean()); });
  std::size_t width = 12;
  for (const SweepRow& row : rows) width = std::max(width, row.side.size());
  std::string text = fmt::format(
      "noise %  {:<{}}  R median [10 %, 90 %]   n   paper R   epsilon   paper epsilon   R mean",
      "side", width);
  text += any_whole ? "   R long\n" : "\n";
  const auto optional_text = [](const std::optional<double>& value, int digits) {
    return value ? fmt::format("{:.{}f}", *value, digits) : std::string("-");
  };
  for (const SweepRow& row : rows) {
    const Sample& found = row.correlation;
    text += fmt::format(
        "{:7.3g}  {:<{}}  {:5.2f}  [{:5.2f}, {:5.2f}]  {:3d}   {:>7}   {:7.3g}   {:>13}   {:6.3f}",
        row.noise_percent, row.side, width, found.median(), found.q10(), found.q90(),
        found.values.size(), optional_text(row.published_correlation, 2), row.parameter.median(),
        optional_text(row.published_parameter, 3), found.known_mean());
    text += any_whole ? fmt::format("   {:6.3f}\n", row.whole.known_mean()) : "\n";
  }
  return text;
}

// A line about what had to be reached.
void add_verdict(const std::string& text, bool passed, StudyResult& result) {
  result.summary += text + (passed ? "" : "  MISSED") + "\n";
  result.blocks.emplace_back(
      report::Text{text, passed ? report::Text::Kind::kNote : report::Text::Kind::kFailure});
  if (!passed) result.missed.push_back(text);
}

void judge_comparison(const std::vector<SweepRow>& rows, const ComparisonOptions& options,
                      StudyResult& result) {
  std::size_t cells = 0, inside_band = 0, parameter_cells = 0;
  double sum_difference = 0.0;
  for (const SweepRow& row : rows) {
    if (!row.published_correlation || row.noise_percent < 100.0 * options.lowest_row) continue;
    const double published = *row.published_correlation;
    ++cells;
    sum_difference += std::abs(row.correlation.median() - published);
    if (row.correlation.q10() <= published && published <= row.correlation.q90()) ++inside_band;
    const double ratio = row.parameter.median() / *row.published_parameter;
    if (ratio <= options.parameter_factor && ratio * options.parameter_factor >= 1.0) {
      ++parameter_cells;
    }
  }
  const auto line = [&result](const std::string& what, double reached, bool passed,
                              const std::string& limit) {
    add_verdict(fmt::format("{}: {:.3g} ({})", what, reached, limit), passed, result);
  };
  const auto at_least = [&](const std::string& what, std::size_t reached, std::int64_t limit) {
    line(fmt::format("{} of {} cells", what, cells), static_cast<double>(reached),
         reached >= static_cast<std::size_t>(limit), fmt::format("accepted from {}", limit));
  };
  const double mean_difference = sum_difference / static_cast<double>(cells);
  const bool any = !std::isfinite(options.mean_difference);
  line("mean |R_median - paper R|", mean_difference,
       any || mean_difference <= options.mean_difference,
       any ? "not judged" : fmt::format("accepted up to {:g}", options.mean_difference));
  at_least("paper R inside the 10-90 % band", inside_band, options.inside_band);
  at_least(fmt::format("epsilon within a factor {:g}", options.parameter_factor), parameter_cells,
           options.parameter_cells);
}

void judge_targets(const std::vector<SweepTarget>& targets, const std::vector<SweepRow>& rows,
                   StudyResult& result) {
  for (const SweepTarget& target : targets) {
    double reached = std::numeric_limits<double>::quiet_NaN(), whole = reached;
    for (const SweepRow& row : rows) {
      if (row.side != target.side || std::abs(row.noise_percent - 100.0 * target.noise) > 1e-6) {
        continue;
      }
      reached = row.correlation.known_mean();
      whole = row.whole.known_mean();
    }
    add_verdict(
        fmt::format(
            "{} at {:g} % noise: {:.4f} (accepted from {:g}), long window {:.4f} (from {:g})",
            target.side, 100.0 * target.noise, reached, target.correlation, whole, target.whole),
        reached >= target.correlation && (target.whole == 0.0 || whole >= target.whole), result);
  }
}

// What a row holds of axes that are neither noise, method nor seed; empty: there are none.
std::string pooled_axes(const std::vector<std::string>& axes) {
  std::vector<std::string> pooled;
  std::ranges::copy_if(axes, std::back_inserter(pooled), [](const std::string& axis) {
    return !axis.starts_with("inversion.") && !axis.ends_with("noise_level") && !is_seed_axis(axis);
  });
  if (pooled.empty()) return {};
  return fmt::format(
      "A row holds all values of {} together; kind: invert with this sweep has a row of each.",
      fmt::join(pooled, ", "));
}

}  // namespace

void sum_up_sweep(const SweepOptions& options, const std::vector<std::string>& axes,
                  const std::vector<SweepTask>& tasks, const StudyContext& context,
                  StudyResult& result) {
  PublishedTable published;
  if (options.has_comparison) {
    published = read_published(context.folder / options.comparison.table);
  }
  const std::vector<SweepRow> rows = sweep_rows(tasks, published);
  const std::string pooled = pooled_axes(axes);
  result.summary = printed_table(rows) + pooled + (pooled.empty() ? "" : "\n");
  Sample medians;
  for (const SweepRow& row : rows) medians.add(row.correlation.median());
  result.answer = fmt::format("Median R over the rows: {:.2f}", medians.median());
  result.blocks.emplace_back(correlation_figure(options.name, rows));
  // Figures of a part are no figures of the whole.
  if (result.pending_tasks == 0) {
    if (options.has_comparison) judge_comparison(rows, options.comparison, result);
    judge_targets(options.targets, rows, result);
  }
  result.blocks.emplace_back(report::table_of(
      {.id = options.name, .title = "Correlation and water level against noise", .caption = pooled},
      rows, write_row));
  result.end_first_screen();
  result.files.emplace_back("tasks.csv", report::table_csv(task_table(axes, tasks)));
}

}  // namespace modcal
