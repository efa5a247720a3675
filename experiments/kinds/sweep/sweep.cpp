#include "experiments/kinds/sweep/sweep.hpp"

#include "libsim/records/record_file.hpp"

namespace modcal {
namespace {

// A score is a list of six in the store.
void visit_score(ResultVisitor& visitor, std::string_view key, WindowScore& score) {
  std::array values = {score.start,        score.stop,
                       score.correlation,  score.relative_rms_error,
                       score.anti_aliased, score.coverage};
  visitor({.key = key}, values);
  score = {values[0], values[1], values[2], values[3], values[4], values[5]};
}

// Draws of a sweep summed up row by row.

bool is_stand_in(ChoiceStatus status) {
  return status != ChoiceStatus::kChosen && status != ChoiceStatus::kGiven &&
         status != ChoiceStatus::kNoParameter;
}

// Settings of the estimate are told apart; of the scene they are draws of it.
bool is_method_axis(const std::string& axis) {
  return axis.starts_with("inversion.") && !axis.starts_with("inversion.estimator") &&
         !is_seed_axis(axis);
}

bool is_numbered(const std::string& side) { return side == "1" || side == "2"; }

// Sides that a failed task would have had.
std::vector<std::string> sides_of(const std::string& estimator) {
  std::vector<std::string> sides = Choice<Estimator>(estimator).make()->sides();
  if (sides.empty()) sides = {estimator};
  return sides;
}

std::string method_of(const std::vector<std::string>& axes,
                      const std::vector<std::string>& values) {
  std::string method;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (!is_method_axis(axes[i])) continue;
    method += fmt::format(", {}", values[i].empty() ? "as stated" : values[i]);
  }
  return method;
}

void add_draw(const TaskScores& draw, SweepRow& row) {
  row.parameter.add(draw.parameter);
  if (is_stand_in(draw.status)) ++row.stand_ins;
  for (const WindowScore& score : draw.scores) {
    row.correlation.add(score.correlation);
    row.rms_error.add(score.relative_rms_error);
    row.anti_aliased.add(score.anti_aliased);
  }
  row.misfit.add(draw.misfit);
  if (!draw.warnings.empty()) ++row.warned;
  row.whole.add(draw.whole.correlation);
  row.whole_rms_error.add(draw.whole.relative_rms_error);
  row.whole_anti_aliased.add(draw.whole.anti_aliased);
}

void add_published(const PublishedTable& published, SweepRow& row) {
  for (const auto& [percent, values] : published) {
    if (std::abs(percent - row.noise_percent) > 1e-6 || !is_numbered(row.side)) continue;
    const auto side = static_cast<std::size_t>(row.side[0] - '1');
    row.published_correlation = values.correlation[side];
    row.published_parameter = values.parameter[side];
  }
}

}  // namespace

void TaskScores::visit(ResultVisitor& visitor) {
  visitor({.key = "side"}, side);
  visitor({.key = "parameter"}, parameter);
  visitor.word({.key = "status"}, status, ChoiceStatus::kNotReached);
  visitor.rows({.key = "scores"}, scores,
               [](ResultVisitor& item, WindowScore& score) { visit_score(item, {}, score); });
  visit_score(visitor, "whole", whole);
  visitor({.key = "misfit"}, misfit);
  visitor({.key = "warnings"}, warnings);
}

void TaskOutcome::visit(ResultVisitor& visitor) {
  visitor({.key = "failure", .optional = true}, failure);
  if (failure.empty()) visitor({.key = "sides"}, sides);
}

TaskOutcome run_cell(const InvertOptions& options, const StudyContext& context) {
  const StreamKey key = options.key();
  const Observation observation = observe(options.observation, {.force = true}, context.work.truths,
                                          key, context.folder, options.score.oversampling);
  const AssumedModel model = with_errors(observation.basis, observation.contact,
                                         options.model_error, key.with("model error"));
  TaskOutcome outcome;
  for (const SideIdentification& side :
       identify(observation, model, options.inversion, {.force = true}, &options.score,
                &context.work.inversions)) {
    const ChosenParameter& choice = side.estimate.result.choice;
    outcome.sides.push_back({side.estimate.side, choice.parameter(), choice.status, side.scores,
                             side.whole, side.estimate.misfit, side.estimate.warnings});
  }
  return outcome;
}

void ComparisonOptions::visit(OptionVisitor& visitor) {
  visitor("table", "published figures: CSV with noise_percent, R1, epsilon1, R2, epsilon2",
          {.required = true}, table);
  visitor("lowest_row", "rows below this noise level are shown but not judged",
          {.range = Range::non_negative()}, lowest_row);
  visitor("mean_difference", "largest accepted mean |R_median - published R|; any: not judged",
          {.range = Range::non_negative(), .word = "any"}, mean_difference);
  visitor("inside_band", "least number of cells whose published R lies in the 10-90 % band",
          {.range = Range::non_negative()}, inside_band);
  visitor("parameter_factor", "factor within which the parameter agrees with the published one",
          {.range = Range::at_least(1.0)}, parameter_factor);
  visitor("parameter_cells", "least number of cells whose parameter agrees",
          {.range = Range::non_negative()}, parameter_cells);
}

void SweepTarget::visit(OptionVisitor& visitor) {
  visitor("side", "row of the table: 1, 2, or the estimator's name for its estimate",
          {.required = true}, side);
  visitor("noise", "row of the table: noise level",
          {.range = Range::non_negative(), .required = true}, noise);
  visitor("correlation", "least mean correlation over windows and draws",
          {.range = Range::closed(-1.0, 1.0)}, correlation);
  visitor("whole", "least mean correlation over the long window",
          {.range = Range::closed(-1.0, 1.0)}, whole);
}

void SweepOptions::visit(OptionVisitor& visitor) {
  visitor.group(
      {.key = "table", .meaning = "how the results are summed up"},
      [this](OptionVisitor& members) { members("name", "name of the table's files", name); });
  visitor("compare_with", "published figures to hold beside ours", has_comparison, comparison);
  visitor("targets", "figures that rows of the table have to reach", targets);
}

PublishedTable read_published(const std::filesystem::path& path) {
  const Recording file = read_csv(
      path,
      {.channels = {"noise_percent", "R1", "epsilon1", "R2", "epsilon2"}, .sample_rate = 1.0});
  PublishedTable rows;
  for (std::size_t i = 0; i < file.frames(); ++i) {
    const auto value = [&](std::size_t column) { return file.channels[column].samples[i]; };
    rows[value(0)] = {{value(1), value(3)}, {value(2), value(4)}};
  }
  return rows;
}

std::vector<SweepRow> sweep_rows(const std::vector<SweepTask>& tasks,
                                 const PublishedTable& published) {
  std::map<std::pair<std::string, double>, SweepRow> rows;
  for (const SweepTask& task : tasks) {
    // Percent values are rounded to 1e-9 so that 0.03 and 3 % are one row.
    const double percent = std::round(task.noise_level * 1e11) / 1e9;
    const auto row_of = [&](const std::string& of_record) -> SweepRow& {
      const std::string side = of_record + task.method;
      SweepRow& row = rows[{side, percent}];
      row.noise_percent = percent;
      row.side = side;
      return row;
    };
    if (!task.outcome.failure.empty()) {
      for (const std::string& side : sides_of(task.estimator)) ++row_of(side).failures;
    }
    for (const TaskScores& draw : task.outcome.sides) add_draw(draw, row_of(draw.side));
  }
  std::vector<SweepRow> result;
  for (auto& [key, row] : rows) {
    add_published(published, row);
    result.push_back(std::move(row));
  }
  return result;
}

std::vector<Finding> SweepExperiment::lint() const {
  std::vector<Finding> findings;
  if (!report::is_file_stem(options_.list.name)) {
    add_finding(findings, "table.name",
                "the name of the table cannot be a file name: use letters, "
                "digits, - and _");
  }
  if (!options_.base.figures.empty()) {
    add_finding(findings, "figures",
                "a sweep draws its own figure: use kind invert for single ones");
  }
  append(findings, AxisExperiment::lint());
  return findings;
}

std::vector<Finding> SweepExperiment::lint_records(const std::filesystem::path& folder) const {
  std::vector<Finding> findings = AxisExperiment::lint_records(folder);
  if (options_.list.has_comparison) {
    lint_making(findings, "compare_with.table",
                [&] { read_published(folder / options_.list.comparison.table); });
  }
  return findings;
}

std::string SweepExperiment::run_task(std::size_t task, const StudyContext& context) const {
  return report::json_line(attempted([&] { return run_cell(options_.cells[task], context); }));
}

std::optional<double> SweepExperiment::loss_in(const std::string& outcome) const {
  Sample errors;
  for (const TaskScores& side : read_outcome<TaskOutcome>(outcome).sides) {
    for (const WindowScore& score : side.scores) errors.add(score.relative_rms_error);
  }
  return known(mean(errors.values));
}

StudyResult SweepExperiment::sum_up(const TaskOutcomes& outcomes,
                                    const StudyContext& context) const {
  StudyResult result;
  std::vector<SweepTask> tasks;
  for_each_outcome<TaskOutcome>(
      outcomes, result, [&](std::size_t task, TaskOutcome outcome, double /*seconds*/) {
        const InvertOptions cell = options_.cells[task];
        tasks.push_back({task, axis_values(task), cell.observation.measurement.noise_level,
                         std::string(cell.inversion.estimator.selected()),
                         method_of(axes(), axis_values(task)), std::move(outcome)});
      });
  sum_up_sweep(options_.list, axes(), tasks, context, result);
  return result;
}

// What there is to see of one inversion.
void SweepExperiment::draw_all(InvertOptions& cell) const {
  FigureOptions waveforms{.id = "waveforms", .title = "Identified motion and force"};
  FigureOptions spectra{.id = "spectra", .title = "Spectra", .content = "spectra"};
  spectra.quantities = {"f_c"};
  FigureOptions curves{
      .id = "parameter_curves", .title = "Parameter choice", .content = "parameter_curves"};
  cell.write_signals = true;
  cell.figures = {waveforms, spectra, curves};
}

}  // namespace modcal
