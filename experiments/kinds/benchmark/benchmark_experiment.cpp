#include "experiments/kinds/benchmark/benchmark_experiment.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "experiments/kinds/benchmark/benchmark_lint.hpp"
#include "experiments/kinds/benchmark/benchmark_report.hpp"
#include "experiments/kinds/calibrate/calibrate_experiment.hpp"
#include "experiments/kinds/lint.hpp"
#include "experiments/study/fingerprint.hpp"

namespace modcal {
namespace {

constexpr std::string_view kMethodPrefix = "calibration.";
constexpr std::string_view kObjectiveAxis = "calibration.objective";

bool is_method_axis(const std::string& path) { return path.starts_with(kMethodPrefix); }
bool is_seed_axis(const std::string& path) { return path == "seed" || path.ends_with(".seed"); }

// Index of a label in the order of first use.
std::size_t index_of(const std::string& label, std::vector<std::string>& labels) {
  const auto known = std::find(labels.begin(), labels.end(), label);
  if (known != labels.end()) return static_cast<std::size_t>(known - labels.begin());
  labels.push_back(label);
  return labels.size() - 1;
}

std::vector<FigureOptions> replay_figures() {
  return {{.id = "objectives", .title = "Objective", .content = "objectives"},
          {.id = "errors", .title = "Frequency errors", .content = "frequency_errors"},
          {.id = "force", .title = "Identified force", .quantities = {"f_c"}}};
}

report::Table task_table(const BenchmarkGrid& grid, const std::string& command) {
  report::Table table{.id = "tasks",
                      .title = "Tasks",
                      .columns = {{.key = "task"},
                                  {.key = "condition"},
                                  {.key = "replicate"},
                                  {.key = "method"},
                                  {.key = "right"},
                                  {.key = "stop"},
                                  {.key = "evaluations"},
                                  {.key = "objective_initial"},
                                  {.key = "objective"},
                                  {.key = "objective_at_truth"},
                                  {.key = "frequency_error"},
                                  {.key = "frequency_rms_error"},
                                  {.key = "frequency_bound"},
                                  {.key = "bound_ratio"},
                                  {.key = "contact_error", .unit = "m"},
                                  {.key = "correlation"},
                                  {.key = "reason"}},
                      .command = command};
  for (const BenchmarkTask& task : grid.tasks) {
    const BenchmarkOutcome& outcome = task.outcome;
    table.rows.push_back(
        {task.task, grid.conditions[task.condition], task.replicate, grid.methods[task.method],
         outcome.success, std::string(name_of(outcome.stop)), outcome.evaluations,
         outcome.initial_value, outcome.value, outcome.truth_value, outcome.frequency_error,
         outcome.frequency_rms_error, outcome.frequency_bound, outcome.bound_ratio(),
         outcome.contact_error, outcome.correlation, reason_of(outcome)});
  }
  return table;
}

// What stands against an optimizer that can be made is that it cannot minimize the objective: a row
// with its reason, not a mistake.
bool is_refused_pair(const CalibrateOptions& cell, const Finding& finding) {
  if (finding.path != "calibration.optimizer") return false;
  std::vector<Finding> own;
  lint_making(own, finding.path, [&] { cell.calibration.optimizer.make(); });
  return own.empty();
}

}  // namespace

void BenchmarkOptions::visit(OptionVisitor& visitor) {
  base.visit(visitor);
  visitor.section({.key = "success", .meaning = "when a calibration counts as right"}, success);
  // Last: every cell is read with the keys above known.
  visitor.sweep(
      {.key = "sweep", .meaning = "axes: option paths and their values", .required = true}, cells);
}

std::string BenchmarkExperiment::search_of(std::size_t task) const {
  const std::vector<std::string>& paths = options_.cells.paths();
  const std::vector<std::string> values = options_.cells.values(task);
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (is_method_axis(paths[i]) && paths[i] != kObjectiveAxis) {
      parts.push_back(short_label(values[i]));
    }
  }
  if (parts.empty()) return std::string(options_.base.calibration.optimizer.selected());
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string BenchmarkExperiment::method_of(std::size_t task) const {
  return search_of(task) + ", " + objective_of(task);
}

std::string BenchmarkExperiment::objective_of(std::size_t task) const {
  const std::vector<std::string>& paths = options_.cells.paths();
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const std::string& value = options_.cells.value(task, i);
    if (paths[i] == kObjectiveAxis && !value.empty()) return short_label(value);
  }
  return std::string(options_.base.calibration.objective.selected());
}

std::string BenchmarkExperiment::condition_of(std::size_t task) const {
  const std::vector<std::string>& paths = options_.cells.paths();
  const std::vector<std::string> values = options_.cells.values(task);
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (is_method_axis(paths[i]) || is_seed_axis(paths[i]) || values[i].empty()) continue;
    const std::string last = paths[i].substr(paths[i].find_last_of('.') + 1);
    const std::string key = last == "noise_level" ? "noise" : last;
    parts.push_back(fmt::format("{} {}", key, short_label(values[i])));
  }
  return parts.empty() ? "the one condition" : fmt::format("{}", fmt::join(parts, ", "));
}

std::string BenchmarkExperiment::replicate_of(std::size_t task) const {
  const std::vector<std::string>& paths = options_.cells.paths();
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (is_seed_axis(paths[i])) parts.push_back(options_.cells.value(task, i));
  }
  return parts.empty() ? std::to_string(options_.cells[task].inversion.seed)
                       : fmt::format("{}", fmt::join(parts, ", "));
}

std::vector<Finding> BenchmarkExperiment::lint() const {
  std::vector<Finding> findings;
  std::set<std::pair<std::string, std::string>> known;
  for (const CalibrateOptions& cell : options_.cells.all()) {
    for (Finding& finding : CalibrateExperiment(cell).lint()) {
      if (is_refused_pair(cell, finding)) continue;
      if (known.insert({finding.path, finding.text}).second) findings.push_back(std::move(finding));
    }
    if (cell.inversion.observation.has_record &&
        known.insert({"record", "a record has no truth"}).second) {
      add_finding(findings, "record",
                  "a benchmark scores on the truth, which a record does not "
                  "have: state a scene");
    }
  }
  std::vector<FairnessTask> tasks;
  for (std::size_t task = 0; task < task_count(); ++task) {
    tasks.push_back({task, method_of(task), condition_of(task), replicate_of(task)});
  }
  append(findings, lint_fairness(tasks, [this](std::size_t task) { return options_.cells[task]; }));
  return findings;
}

std::vector<std::string> BenchmarkExperiment::plan() const {
  std::set<std::string> methods, conditions;
  for (std::size_t task = 0; task < task_count(); ++task) {
    methods.insert(method_of(task));
    conditions.insert(condition_of(task));
  }
  std::vector<std::string> lines;
  for (const std::string& method : methods) lines.push_back("method: " + method);
  for (const std::string& condition : conditions) lines.push_back("condition: " + condition);
  lines.push_back(fmt::format("tasks: {} = {} methods, {} conditions", task_count(), methods.size(),
                              conditions.size()));
  if (const auto planned = planned_simulations()) lines.push_back(plan_line(*planned));
  return lines;
}

std::optional<PlannedSimulations> BenchmarkExperiment::planned_simulations() const {
  std::set<std::string> scenes;
  for (const CalibrateOptions& cell : options_.cells.all()) {
    const ObservationOptions& observation = cell.inversion.observation;
    scenes.insert(
        truth_key(observation.truth, observation.measurement.sample_rate, {.force = true}));
  }
  return planned_truths(options_.base.inversion.observation, {.force = true}, scenes.size());
}

std::string BenchmarkExperiment::fingerprint(std::size_t task,
                                             const std::filesystem::path& /*folder*/) const {
  CalibrateOptions options = options_.cells[task];
  SuccessOptions success = options_.success;
  return "benchmark " + modcal::fingerprint([&](OptionVisitor& visitor) {
           options.visit(visitor);
           success.visit(visitor);
         });
}

std::string BenchmarkExperiment::run_task(std::size_t task, const StudyContext& context) const {
  return outcome_text(
      run_benchmark_cell(options_.cells[task], options_.success, *bounds_, context));
}

std::string BenchmarkExperiment::failure_in(const std::string& outcome) const {
  return read_benchmark_outcome(outcome).failure;
}

std::optional<double> BenchmarkExperiment::loss_in(const std::string& outcome) const {
  const BenchmarkOutcome read = read_benchmark_outcome(outcome);
  if (!read.failure.empty() || !std::isfinite(read.frequency_error)) return std::nullopt;
  return read.frequency_error;
}

BenchmarkGrid BenchmarkExperiment::grid(const TaskOutcomes& outcomes) const {
  BenchmarkGrid grid;
  std::set<std::pair<std::size_t, std::size_t>> traced;
  for (std::size_t task = 0; task < outcomes.size(); ++task) {
    const std::size_t method = index_of(method_of(task), grid.methods);
    const std::size_t condition = index_of(condition_of(task), grid.conditions);
    if (method == grid.objectives.size()) {
      grid.objectives.push_back(objective_of(task));
      grid.searches.push_back(search_of(task));
    }
    if (condition == grid.noise_levels.size()) {
      grid.noise_levels.push_back(
          options_.cells[task].inversion.observation.measurement.noise_level);
    }
    const std::optional<FinishedTask> finished = outcomes[task];
    if (!finished) continue;
    grid.tasks.push_back({task, method, condition, replicate_of(task), finished->seconds,
                          read_benchmark_outcome(finished->outcome)});
    // The figure of traces draws one a method and condition.
    BenchmarkOutcome& outcome = grid.tasks.back().outcome;
    if (!outcome.trace.empty() && !traced.insert({method, condition}).second) {
      outcome.trace = {};
    }
  }
  return grid;
}

StudyResult BenchmarkExperiment::sum_up(const TaskOutcomes& outcomes,
                                        const StudyContext& context) const {
  const BenchmarkGrid grid = this->grid(outcomes);
  const std::vector<BenchmarkCell> cells = benchmark_cells(grid);
  StudyResult result;
  result.pending_tasks = outcomes.size() - grid.tasks.size();
  for (const BenchmarkTask& task : grid.tasks) {
    if (!task.outcome.failure.empty()) ++result.failed_tasks;
  }
  if (result.failed_tasks > 0) result.status = report::Status::kSomeFailed;
  if (!grid.tasks.empty() && result.failed_tasks == grid.tasks.size()) {
    result.status = report::Status::kFailed;
  }
  std::string paragraphs;
  for (const std::string& sentence : conclusion(grid, cells)) {
    result.summary += sentence + "\n";
    paragraphs += (paragraphs.empty() ? "" : "\n\n") + sentence;
  }
  result.blocks.emplace_back(report::Text{paragraphs});
  result.blocks.emplace_back(success_map(grid, cells, context.command));
  report::Table bounds = bound_map(grid, cells, context.command);
  if (!bounds.rows.empty()) result.blocks.emplace_back(std::move(bounds));
  for (report::Figure figure :
       {error_figure(grid, cells), data_profile(grid), performance_profile(grid),
        work_precision_figure(grid, cells), waterfall_figure(grid), trace_figure(grid)}) {
    if (figure.panels.empty()) continue;
    figure.command = context.command;
    result.blocks.emplace_back(std::move(figure));
  }
  result.blocks.emplace_back(benchmark_table(grid, cells, context.command));
  result.files.emplace_back("tasks.csv", report::table_csv(task_table(grid, context.command)));
  return result;
}

StudyResult BenchmarkExperiment::replay(std::size_t task, const StudyContext& context) const {
  CalibrateOptions options = options_.cells[task];
  options.inversion.write_signals = true;
  options.inversion.figures = replay_figures();
  return calibrate_study(options, context);
}

}  // namespace modcal
