#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "experiments/kinds/sweep_study.hpp"
#include "experiments/records/csv_reader.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/statistics.hpp"

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

namespace {

struct PublishedRow {
  double correlation[2];
  double parameter[2];
};

using PublishedTable = std::map<double, PublishedRow>;  // by noise in percent

PublishedTable read_published(const std::filesystem::path& path) {
  const Recording file = read_csv(
      path, {.columns = {"noise_percent", "R1", "epsilon1", "R2", "epsilon2"}, .sample_rate = 1.0});
  PublishedTable rows;
  for (std::size_t i = 0; i < file.frames(); ++i) {
    const auto value = [&](std::size_t column) { return file.channels[column].samples[i]; };
    rows[value(0)] = {{value(1), value(3)}, {value(2), value(4)}};
  }
  return rows;
}

// One row of the table: all draws of one noise level on one side.
struct Group {
  double noise_percent = 0.0;
  int side = 0;
  std::vector<double> correlation;
  std::vector<double> rms_error;
  std::vector<double> parameter;
  std::size_t stand_ins = 0;
  std::size_t failures = 0;
};

std::vector<Group> group_outcomes(const std::vector<SweepCell>& cells,
                                  const std::vector<TaskOutcome>& outcomes) {
  std::map<std::pair<int, double>, Group> groups;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    // Percent values are rounded to 1e-9 so that 0.03 and 3 % are one row.
    const double percent = std::round(cells[i].row_value * 1e11) / 1e9;
    const auto group_of = [&](int side) -> Group& {
      Group& group = groups[{side, percent}];
      group.noise_percent = percent;
      group.side = side;
      return group;
    };
    if (!outcomes[i].failure.empty()) {
      for (const End end : kEnds) ++group_of(side_number(end)).failures;
    }
    for (const TaskScores& side : outcomes[i].sides) {
      Group& group = group_of(side_number(side.end));
      group.parameter.push_back(side.parameter);
      if (side.status != ChoiceStatus::kChosen && side.status != ChoiceStatus::kGiven &&
          side.status != ChoiceStatus::kNoParameter) {
        ++group.stand_ins;
      }
      for (const WindowScore& score : side.scores) {
        group.correlation.push_back(score.correlation);
        group.rms_error.push_back(score.relative_rms_error);
      }
    }
  }
  std::vector<Group> result;
  for (auto& [key, group] : groups) result.push_back(std::move(group));
  return result;
}

struct Judgement {
  std::size_t cells = 0, inside_band = 0, parameter_cells = 0;
  double sum_difference = 0.0;
  double mean_difference() const { return sum_difference / static_cast<double>(cells); }
};

struct SummedRow {
  Group group;
  double median, q10, q90, rms_median, parameter_median;
  std::optional<double> published_correlation, published_parameter;
};

SummedRow sum_up(const Group& group, const PublishedTable& published) {
  SummedRow row{group,
                quantile(group.correlation, 0.5),
                quantile(group.correlation, 0.1),
                quantile(group.correlation, 0.9),
                quantile(group.rms_error, 0.5),
                quantile(group.parameter, 0.5),
                {},
                {}};
  for (const auto& [percent, values] : published) {
    if (std::abs(percent - group.noise_percent) > 1e-6) continue;
    const auto side = static_cast<std::size_t>(group.side - 1);
    row.published_correlation = values.correlation[side];
    row.published_parameter = values.parameter[side];
  }
  return row;
}

Judgement judge(const std::vector<SummedRow>& rows, const ComparisonOptions& options) {
  Judgement judgement;
  for (const SummedRow& row : rows) {
    if (!row.published_correlation || row.group.noise_percent < 100.0 * options.lowest_row)
      continue;
    ++judgement.cells;
    judgement.sum_difference += std::abs(row.median - *row.published_correlation);
    if (row.q10 <= *row.published_correlation && *row.published_correlation <= row.q90) {
      ++judgement.inside_band;
    }
    const double ratio = row.parameter_median / *row.published_parameter;
    if (ratio <= options.parameter_factor && ratio * options.parameter_factor >= 1.0) {
      ++judgement.parameter_cells;
    }
  }
  return judgement;
}

report::Cell optional_cell(const std::optional<double>& value) {
  return value ? report::Cell(*value) : report::Cell();
}

report::Table sweep_table(const std::string& name, const std::vector<SummedRow>& rows,
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
           {.key = "n"},
           {.key = "epsilon_median", .name = "epsilon, median", .unit = "N/N", .format = "{:.3g}"},
           {.key = "paper_R", .name = "R, paper", .format = "{:.2f}"},
           {.key = "paper_epsilon", .name = "epsilon, paper", .unit = "N/N", .format = "{:.3g}"},
           {.key = "stand_ins", .name = "no interior minimum"},
           {.key = "failures"}},
      .command = command};
  for (const SummedRow& row : rows) {
    table.rows.push_back({row.group.noise_percent, row.group.side, row.median, row.q10, row.q90,
                          row.rms_median, row.group.correlation.size(), row.parameter_median,
                          optional_cell(row.published_correlation),
                          optional_cell(row.published_parameter), row.group.stand_ins,
                          row.group.failures});
  }
  return table;
}

report::Figure sweep_figure(const std::string& name, const std::vector<SummedRow>& rows,
                            const std::string& command) {
  using report::ColorRole;
  report::Figure figure{.id = name + "_figure",
                        .title = "Correlation of identified and true force against noise",
                        .caption =
                            "Median with the band from 10 % to 90 % of the draws; points: "
                            "published figures.",
                        .columns = 2,
                        .command = command};
  for (const int side : {1, 2}) {
    report::Series ours{.label = "median, 10-90 %", .style = report::SeriesStyle::kLineWithPoints};
    ours.color = side == 1 ? ColorRole::kFirst : ColorRole::kSecond;
    report::Series paper{
        .label = "paper", .style = report::SeriesStyle::kPoints, .color = ColorRole::kReference};
    for (const SummedRow& row : rows) {
      if (row.group.side != side) continue;
      ours.x.push_back(row.group.noise_percent);
      ours.y.push_back(row.median);
      ours.y_low.push_back(row.q10);
      ours.y_high.push_back(row.q90);
      if (!row.published_correlation) continue;
      paper.x.push_back(row.group.noise_percent);
      paper.y.push_back(*row.published_correlation);
    }
    report::Panel panel{.title = fmt::format("from R{}", side),
                        .x = {.label = "noise", .unit = "%"},
                        .y = {.label = "correlation R"},
                        .series = {std::move(ours)}};
    if (!paper.x.empty()) panel.series.push_back(std::move(paper));
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

report::Table task_table(const std::vector<std::string>& axes, const std::vector<SweepCell>& cells,
                         const std::vector<TaskOutcome>& outcomes, const std::string& command) {
  report::Table table{.id = "tasks", .title = "Tasks", .command = command};
  for (const std::string& axis : axes) table.columns.push_back({.key = axis});
  for (const char* key :
       {"side", "epsilon", "choice", "window_start", "R", "relative_rms_error", "failure"}) {
    table.columns.push_back({.key = key});
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::vector<report::Cell> head(cells[i].axis_values.begin(), cells[i].axis_values.end());
    if (!outcomes[i].failure.empty()) {
      std::vector<report::Cell> row = head;
      row.resize(table.columns.size());
      row.back() = outcomes[i].failure;
      table.rows.push_back(std::move(row));
    }
    for (const TaskScores& side : outcomes[i].sides) {
      for (const WindowScore& score : side.scores) {
        std::vector<report::Cell> row = head;
        row.insert(row.end(),
                   {side_number(side.end), side.parameter, std::string(name_of(side.status)),
                    score.start, score.correlation, score.relative_rms_error, report::Cell()});
        table.rows.push_back(std::move(row));
      }
    }
  }
  return table;
}

std::string printed_table(const std::vector<SummedRow>& rows) {
  std::string text =
      "noise %  side   R median [10 %, 90 %]   n   paper R   epsilon   paper epsilon\n";
  const auto optional_text = [](const std::optional<double>& value, int digits) {
    return value ? fmt::format("{:.{}f}", *value, digits) : std::string("-");
  };
  for (const SummedRow& row : rows) {
    text += fmt::format(
        "{:7.3g}  {:4d}   {:5.2f}  [{:5.2f}, {:5.2f}]  {:3d}   {:>7}   {:7.3f}   {:>13}\n",
        row.group.noise_percent, row.group.side, row.median, row.q10, row.q90,
        row.group.correlation.size(), optional_text(row.published_correlation, 2),
        row.parameter_median, optional_text(row.published_parameter, 3));
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

}  // namespace

StudyResult sum_up_sweep(const SweepOptions& options, const std::vector<std::string>& axes,
                         const std::vector<SweepCell>& cells,
                         const std::vector<TaskOutcome>& outcomes, const StudyContext& context) {
  PublishedTable published;
  if (options.has_comparison) {
    published = read_published(context.folder / options.comparison.table);
  }
  std::vector<SummedRow> rows;
  for (const Group& group : group_outcomes(cells, outcomes))
    rows.push_back(sum_up(group, published));

  StudyResult result;
  for (const TaskOutcome& outcome : outcomes) {
    if (!outcome.failure.empty()) ++result.failed_tasks;
  }
  result.status = result.failed_tasks == 0                ? report::Status::kOk
                  : result.failed_tasks < outcomes.size() ? report::Status::kSomeFailed
                                                          : report::Status::kFailed;
  result.summary = printed_table(rows);
  result.blocks.emplace_back(sweep_table(options.table.name, rows, context.command));
  if (options.has_comparison)
    add_judgement(judge(rows, options.comparison), options.comparison, result);
  result.blocks.emplace_back(sweep_figure(options.table.name, rows, context.command));
  result.files.emplace_back("tasks.csv",
                            report::table_csv(task_table(axes, cells, outcomes, context.command)));
  if (result.failed_tasks > 0) {
    result.summary +=
        fmt::format("{} of {} tasks failed; see tasks.csv\n", result.failed_tasks, outcomes.size());
  }
  return result;
}

}  // namespace modcal
