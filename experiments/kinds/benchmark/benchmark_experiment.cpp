#include <fmt/ranges.h>

#include <set>

#include "experiments/kinds/benchmark/benchmark.hpp"

namespace modcal {
namespace {

constexpr std::string_view kMethodPrefix = "calibration.";
constexpr std::string_view kObjectiveAxis = "calibration.objective";

// Index of a label in the order of first use.
std::size_t index_of(const std::string& label, std::vector<std::string>& labels) {
  const std::size_t place = place_in(labels, label);
  if (place == labels.size()) labels.push_back(label);
  return place;
}

report::Table task_table(const BenchmarkGrid& grid) {
  return report::table_of({.id = "tasks", .title = "Tasks"}, grid.tasks,
                          [&grid](report::RowWriter& row, const BenchmarkTask& task) {
                            BenchmarkOutcome outcome = task.outcome;
                            row({.key = "task"}, task.task);
                            row({.key = "condition"}, grid.conditions[task.condition]);
                            row({.key = "replicate"}, task.replicate);
                            row({.key = "method"}, grid.methods[task.method]);
                            outcome.visit_scores(row);
                            row({.key = "reason"}, reason_of(outcome));
                          });
}

}  // namespace

BenchmarkLabels BenchmarkExperiment::labels_of(std::size_t task) const {
  const std::vector<std::string>& paths = options_.cells.paths();
  const std::vector<std::string> values = options_.cells.values(task);
  const CalibrationOptions& calibration = options_.base.calibration;
  BenchmarkLabels labels{.objective = std::string(calibration.objective.selected())};
  std::vector<std::string> search, condition, seeds;
  bool has_conditions = false;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const std::string label = short_label(values[i]);
    if (paths[i] == kObjectiveAxis) {
      if (!values[i].empty()) labels.objective = label;
    } else if (paths[i].starts_with(kMethodPrefix) && !values[i].empty()) {
      search.push_back(label);
    }
    if (is_seed_axis(paths[i])) {
      seeds.push_back(values[i]);
    } else if (!paths[i].starts_with(kMethodPrefix)) {
      has_conditions = true;
      if (values[i].empty()) continue;
      const std::string last = paths[i].substr(paths[i].find_last_of('.') + 1);
      condition.push_back(fmt::format("{} {}", last == "noise_level" ? "noise" : last, label));
    }
  }
  const auto joined = [](const std::vector<std::string>& parts, std::string none) {
    return parts.empty() ? std::move(none) : fmt::format("{}", fmt::join(parts, ", "));
  };
  labels.search = joined(search, std::string(calibration.optimizer.selected()));
  labels.condition = joined(condition, has_conditions ? "as stated" : "the one condition");
  labels.replicate = joined(seeds, std::to_string(options_.base.inversion.seed));
  return labels;
}

// What stands against an optimizer that can be made is that it cannot minimize the objective: a row
// with its reason, not a mistake.
bool BenchmarkExperiment::is_excused(const CalibrateOptions& cell, const Finding& finding) const {
  if (finding.path != kOptimizerPath) return false;
  std::vector<Finding> own;
  lint_making(own, finding.path, [&] { cell.calibration.optimizer.make(); });
  return own.empty();
}

void BenchmarkExperiment::visit_scoring(OptionVisitor& visitor) const {
  SuccessOptions(options_.list).visit(visitor);
}

std::vector<Finding> BenchmarkExperiment::lint() const {
  std::vector<Finding> findings = AxisExperiment::lint();
  const auto& cells = options_.cells.all();
  if (std::ranges::any_of(cells, &CalibrateOptions::has_structure)) {
    add_finding(findings, "structure", "{}", for_structures());
    return findings;
  }
  if (std::any_of(cells.begin(), cells.end(), [](const CalibrateOptions& cell) {
        return cell.inversion.observation.has_record;
      })) {
    add_finding(findings, "record",
                "a benchmark scores on the truth, which a record does not "
                "have: state a scene");
  }
  std::vector<BenchmarkLabels> tasks;
  for (std::size_t task = 0; task < task_count(); ++task) tasks.push_back(labels_of(task));
  append(findings, lint_fairness(tasks, [this](std::size_t task) { return options_.cells[task]; }));
  return findings;
}

std::vector<PlanLine> BenchmarkExperiment::plan() const {
  std::set<std::string> methods, conditions;
  for (std::size_t task = 0; task < task_count(); ++task) {
    const BenchmarkLabels labels = labels_of(task);
    methods.insert(labels.method());
    conditions.insert(labels.condition);
  }
  std::vector<PlanLine> lines;
  using List = nlohmann::ordered_json;
  for (const std::string& method : methods) {
    lines.push_back({"method: " + method, {{"methods", List::array({method})}}});
  }
  for (const std::string& condition : conditions) {
    lines.push_back({"condition: " + condition, {{"conditions", List::array({condition})}}});
  }
  lines.push_back({fmt::format("tasks: {} = {} methods, {} conditions", task_count(),
                               methods.size(), conditions.size()),
                   {{"tasks", task_count()}}});
  if (const auto planned = planned_simulations()) lines.push_back(plan_line(*planned));
  return lines;
}

std::string BenchmarkExperiment::run_task(std::size_t task, const StudyContext& context) const {
  return report::json_line(attempted(
      [&] { return run_benchmark_cell(options_.cells[task], options_.list, *bounds_, context); }));
}

std::optional<double> BenchmarkExperiment::loss_in(const std::string& outcome) const {
  return known(read_outcome<BenchmarkOutcome>(outcome).frequency_error);
}

BenchmarkGrid BenchmarkExperiment::grid(const TaskOutcomes& outcomes, StudyResult& result) const {
  BenchmarkGrid grid;
  for (std::size_t task = 0; task < outcomes.size(); ++task) {
    const BenchmarkLabels labels = labels_of(task);
    if (index_of(labels.method(), grid.methods) == grid.objectives.size()) {
      grid.objectives.push_back(labels.objective);
      grid.searches.push_back(labels.search);
    }
    if (index_of(labels.condition, grid.conditions) == grid.noise_levels.size()) {
      grid.noise_levels.push_back(
          options_.cells[task].inversion.observation.measurement.noise_level);
    }
  }
  std::set<std::pair<std::size_t, std::size_t>> traced;
  for_each_outcome<BenchmarkOutcome>(
      outcomes, result, [&](std::size_t task, BenchmarkOutcome outcome, double seconds) {
        const BenchmarkLabels labels = labels_of(task);
        const std::size_t method = place_in(grid.methods, labels.method());
        const std::size_t condition = place_in(grid.conditions, labels.condition);
        // The figure of traces draws one a method and condition.
        if (!outcome.trace.empty() && !traced.insert({method, condition}).second) {
          outcome.trace = {};
        }
        grid.tasks.push_back(
            {task, method, condition, labels.replicate, seconds, std::move(outcome)});
      });
  return grid;
}

StudyResult BenchmarkExperiment::sum_up(const TaskOutcomes& outcomes,
                                        const StudyContext& /*context*/) const {
  StudyResult result;
  const BenchmarkGrid grid = this->grid(outcomes, result);
  const std::vector<BenchmarkCell> cells = benchmark_cells(grid);
  const std::vector<std::string> use = recommendations(grid, cells);
  const std::vector<std::string> fail = failing_methods(grid, cells);
  for (const std::string& sentence : use) result.summary += sentence + "\n";
  for (const std::string& sentence : fail) result.summary += sentence + "\n";
  if (!use.empty()) result.answer = use.front();
  result.blocks.emplace_back(report::Text{
      fmt::format("{}", fmt::join(use.begin() + (use.empty() ? 0 : 1), use.end(), "\n\n"))});
  result.blocks.emplace_back(success_map(grid, cells));
  result.end_first_screen();
  result.blocks.emplace_back(report::Text{fmt::format("{}", fmt::join(fail, "\n\n"))});
  report::Table bounds = bound_map(grid, cells);
  if (!bounds.rows.empty()) result.blocks.emplace_back(std::move(bounds));
  for (report::Figure figure :
       {error_figure(grid, cells), data_profile(grid), performance_profile(grid),
        work_precision_figure(grid, cells), waterfall_figure(grid), trace_figure(grid)}) {
    if (figure.panels.empty()) continue;
    result.blocks.emplace_back(std::move(figure));
  }
  result.blocks.emplace_back(benchmark_table(grid, cells));
  result.files.emplace_back("tasks.csv", report::table_csv(task_table(grid)));
  return result;
}

void BenchmarkExperiment::draw_all(CalibrateOptions& cell) const {
  cell.inversion.write_signals = true;
  cell.inversion.figures = {
      {.id = "objectives", .title = "Objective", .content = "objectives"},
      {.id = "errors", .title = "Frequency errors", .content = "frequency_errors"},
      {.id = "force", .title = "Identified force", .quantities = {"f_c"}}};
}

}  // namespace modcal
