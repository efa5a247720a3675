#include "experiments/kinds/benchmark_experiment.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "experiments/kinds/benchmark_report.hpp"
#include "experiments/kinds/calibrate_experiment.hpp"
#include "experiments/kinds/scene_plan.hpp"
#include "experiments/study/fingerprint.hpp"

namespace modcal {
namespace {

constexpr std::string_view kMethodPrefix = "calibration.";

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
                                  {.key = "contact_error", .unit = "m"},
                                  {.key = "correlation"},
                                  {.key = "reason"}},
                      .command = command};
  for (const BenchmarkTask& task : grid.tasks) {
    const BenchmarkOutcome& outcome = task.outcome;
    table.rows.push_back({task.task, grid.conditions[task.condition], task.replicate,
                          grid.methods[task.method], outcome.success,
                          std::string(name_of(outcome.stop)), outcome.evaluations,
                          outcome.initial_value, outcome.value, outcome.truth_value,
                          outcome.frequency_error, outcome.frequency_rms_error,
                          outcome.contact_error, outcome.correlation, reason_of(outcome)});
  }
  return table;
}

}  // namespace

void BenchmarkOptions::visit(OptionVisitor& visitor) {
  base.visit(visitor);
  visitor.section({.key = "success", .meaning = "when a calibration counts as right"}, success);
  // Last: every cell is read with the keys above known.
  visitor.sweep(
      {.key = "sweep", .meaning = "axes: option paths and their values", .required = true}, cells);
}

std::string BenchmarkExperiment::method_of(std::size_t task) const {
  const std::vector<std::string>& paths = options_.cells.paths();
  const std::vector<std::string>& values = options_.cells.values(task);
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (is_method_axis(paths[i])) parts.push_back(short_label(values[i]));
  }
  const CalibrationOptions& calibration = options_.cells[task].calibration;
  if (parts.empty()) {
    return fmt::format("{}, {}", calibration.optimizer.selected(),
                       calibration.objective.selected());
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string BenchmarkExperiment::condition_of(std::size_t task) const {
  const std::vector<std::string>& paths = options_.cells.paths();
  const std::vector<std::string>& values = options_.cells.values(task);
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (is_method_axis(paths[i]) || is_seed_axis(paths[i]) || values[i].empty()) continue;
    const std::string key = paths[i].substr(paths[i].find_last_of('.') + 1);
    parts.push_back(fmt::format("{} {}", key, short_label(values[i])));
  }
  return parts.empty() ? "the one condition" : fmt::format("{}", fmt::join(parts, ", "));
}

std::string BenchmarkExperiment::replicate_of(std::size_t task) const {
  const std::vector<std::string>& paths = options_.cells.paths();
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (is_seed_axis(paths[i])) parts.push_back(options_.cells.values(task)[i]);
  }
  return parts.empty() ? std::to_string(options_.cells[task].inversion.seed)
                       : fmt::format("{}", fmt::join(parts, ", "));
}

std::vector<Finding> BenchmarkExperiment::lint() const {
  std::vector<Finding> findings;
  std::set<std::pair<std::string, std::string>> known;
  for (const CalibrateOptions& cell : options_.cells.all()) {
    for (Finding& finding : CalibrateExperiment(cell).lint()) {
      if (known.insert({finding.path, finding.text}).second) findings.push_back(std::move(finding));
    }
    if (cell.inversion.observation.has_record &&
        known.insert({"record", "a record has no truth"}).second) {
      findings.push_back({"record",
                          "a benchmark scores on the truth, which a record does not "
                          "have: state a scene"});
    }
  }
  for (Finding& finding : lint_fairness()) findings.push_back(std::move(finding));
  return findings;
}

std::vector<Finding> BenchmarkExperiment::lint_fairness() const {
  std::map<std::string, std::set<std::string>> problems;
  std::map<std::string, std::set<std::string>> budgets, ranges;
  std::map<std::string, std::set<std::string>> draws;
  for (std::size_t task = 0; task < task_count(); ++task) {
    const std::string method = method_of(task);
    problems[method].insert(condition_of(task) + " / " + replicate_of(task));
    CalibrationOptions calibration = options_.cells[task].calibration;
    budgets[modcal::fingerprint([&](OptionVisitor& visitor) { calibration.budget.visit(visitor); })]
        .insert(method);
    ranges[modcal::fingerprint([&](OptionVisitor& visitor) {
      calibration.parameters.ranges.visit(visitor);
    })].insert(method);
    draws[condition_of(task)].insert(replicate_of(task));
  }
  std::vector<Finding> findings;
  const auto warn = [&findings](std::string path, std::string text) {
    findings.push_back({std::move(path), std::move(text), false});
  };
  for (const auto& [method, theirs] : problems) {
    if (theirs == problems.begin()->second) continue;
    warn("sweep", fmt::format("{} meets {} problems, {} meets {}: methods are compared on the "
                              "problems they share",
                              method, theirs.size(), problems.begin()->first,
                              problems.begin()->second.size()));
  }
  if (budgets.size() > 1) {
    warn("calibration.budget", "the methods have different budgets: what costs more wins");
  }
  if (ranges.size() > 1) {
    warn("calibration.parameters",
         "the methods search different ranges: the narrower one is a head start");
  }
  const std::size_t fewest =
      std::min_element(draws.begin(), draws.end(), [](const auto& a, const auto& b) {
        return a.second.size() < b.second.size();
      })->second.size();
  if (problems.size() > 1 && fewest < 10) {
    warn("sweep", fmt::format("{} draws a condition tell methods apart only where they differ "
                              "grossly: take 10 seeds or more",
                              fewest));
  }
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
  for (std::size_t task = 0; task < task_count(); ++task) {
    const ObservationOptions& observation = options_.cells[task].inversion.observation;
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
  return outcome_text(run_benchmark_cell(options_.cells[task], options_.success, context));
}

std::string BenchmarkExperiment::failure_in(const std::string& outcome) const {
  return read_benchmark_outcome(outcome).failure;
}

std::optional<double> BenchmarkExperiment::loss_in(const std::string& outcome) const {
  const BenchmarkOutcome read = read_benchmark_outcome(outcome);
  if (!read.failure.empty() || !std::isfinite(read.frequency_error)) return std::nullopt;
  return read.frequency_error;
}

BenchmarkGrid BenchmarkExperiment::grid(
    const std::vector<std::optional<FinishedTask>>& outcomes) const {
  BenchmarkGrid grid;
  for (std::size_t task = 0; task < outcomes.size(); ++task) {
    const std::size_t method = index_of(method_of(task), grid.methods);
    const std::size_t condition = index_of(condition_of(task), grid.conditions);
    const double noise = options_.cells[task].inversion.observation.measurement.noise_level;
    if (condition == grid.noise_levels.size()) grid.noise_levels.push_back(noise);
    if (!outcomes[task]) continue;
    grid.tasks.push_back({task, method, condition, replicate_of(task), noise,
                          outcomes[task]->seconds,
                          read_benchmark_outcome(outcomes[task]->outcome)});
  }
  return grid;
}

StudyResult BenchmarkExperiment::sum_up(const std::vector<std::optional<FinishedTask>>& outcomes,
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
  for (const std::string& sentence : conclusion(grid, cells)) {
    result.summary += sentence + "\n";
    result.blocks.emplace_back(report::Text{sentence});
  }
  result.blocks.emplace_back(success_map(grid, cells, context.command));
  for (report::Figure figure :
       {error_figure(grid, cells), data_profile(grid), performance_profile(grid),
        work_precision_figure(grid, cells), waterfall_figure(grid), trace_figure(grid)}) {
    if (figure.panels.front().series.empty()) continue;
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
