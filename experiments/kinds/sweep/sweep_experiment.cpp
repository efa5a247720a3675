#include "experiments/kinds/sweep/sweep_experiment.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "experiments/kinds/invert/invert_study.hpp"
#include "experiments/kinds/lint.hpp"
#include "experiments/study/fingerprint.hpp"

namespace modcal {
namespace {

// What there is to see of one inversion.
std::vector<FigureOptions> replay_figures() {
  FigureOptions waveforms{.id = "waveforms", .title = "Identified motion and force"};
  FigureOptions spectra{.id = "spectra", .title = "Spectra", .content = "spectra"};
  spectra.quantities = {"f_c"};
  FigureOptions curves{
      .id = "parameter_curves", .title = "Parameter choice", .content = "parameter_curves"};
  return {waveforms, spectra, curves};
}

void append_axes(const SweepPlan& plan, std::vector<std::string>& lines) {
  for (const SweepAxis& axis : plan.product) {
    lines.push_back(fmt::format("axis {}: {} values", axis.path, axis.values.size()));
  }
  for (const std::vector<SweepAxis>& group : plan.zip) {
    std::vector<std::string> paths;
    for (const SweepAxis& axis : group) paths.push_back(axis.path);
    lines.push_back(fmt::format("axes {} together: {} values", fmt::join(paths, ", "),
                                group.front().values.size()));
  }
}

}  // namespace

void SweepExperimentOptions::visit(OptionVisitor& visitor) {
  base.visit(visitor);
  visitor.section({.key = "table", .meaning = "how the results are summed up"}, sweep.table);
  visitor.optional_group(
      {.key = "compare_with", .meaning = "published figures to hold beside ours"},
      sweep.has_comparison, [this](OptionVisitor& inner) { sweep.comparison.visit(inner); });
  ListOf<SweepTarget> targets(sweep.targets);
  visitor.list({.key = "targets", .meaning = "figures that rows of the table have to reach"},
               targets);
  // Last: every cell is read with the keys above known.
  visitor.sweep(
      {.key = "sweep", .meaning = "axes: option paths and their values", .required = true}, cells);
}

SweepCell SweepExperiment::cell(std::size_t task) const {
  const InvertOptions& options = options_.cells[task];
  return {options, axis_values(task), options.observation.measurement.noise_level};
}

std::vector<Finding> SweepExperiment::lint() const {
  std::vector<Finding> findings;
  if (!report::is_file_stem(options_.sweep.table.name)) {
    add_finding(findings, "table.name",
                "the name of the table cannot be a file name: use letters, "
                "digits, - and _");
  }
  if (!options_.base.figures.empty()) {
    add_finding(findings, "figures",
                "a sweep draws its own figure: use kind invert for single ones");
  }
  std::set<std::pair<std::string, std::string>> known;
  for (const InvertOptions& cell : options_.cells.all()) {
    for (Finding& finding : lint_inversion(cell)) {
      if (known.insert({finding.path, finding.text}).second) findings.push_back(std::move(finding));
    }
  }
  return findings;
}

std::vector<std::string> SweepExperiment::plan() const {
  std::vector<std::string> lines;
  append_axes(options_.cells.plan(), lines);
  lines.push_back(fmt::format("tasks: {}", options_.cells.size()));
  if (const auto planned = planned_simulations()) {
    lines.push_back(plan_line(*planned));
    lines.push_back(fmt::format("skipped: {} simulations whose scene another task has",
                                options_.cells.size() - planned->count));
  }
  return lines;
}

std::optional<PlannedSimulations> SweepExperiment::planned_simulations() const {
  std::set<std::string> scenes;
  for (const InvertOptions& cell : options_.cells.all()) {
    scenes.insert(truth_key(cell.observation.truth, cell.observation.measurement.sample_rate,
                            {.force = true}));
  }
  return planned_truths(options_.base.observation, {.force = true}, scenes.size());
}

std::string SweepExperiment::fingerprint(std::size_t task,
                                         const std::filesystem::path& folder) const {
  InvertOptions options = options_.cells[task];
  std::string text =
      "sweep " + modcal::fingerprint([&](OptionVisitor& visitor) { options.visit(visitor); });
  if (options.observation.has_record) {
    text += record_fingerprint(folder / options.observation.record.file);
  }
  return text;
}

std::string SweepExperiment::run_task(std::size_t task, const StudyContext& context) const {
  return outcome_text(run_cell(cell(task), context));
}

std::string SweepExperiment::failure_in(const std::string& outcome) const {
  return read_outcome(outcome).failure;
}

std::optional<double> SweepExperiment::loss_in(const std::string& outcome) const {
  double sum = 0.0;
  std::size_t count = 0;
  for (const TaskScores& side : read_outcome(outcome).sides) {
    for (const WindowScore& score : side.scores) {
      sum += score.relative_rms_error;
      ++count;
    }
  }
  if (count == 0 || !std::isfinite(sum)) return std::nullopt;
  return sum / static_cast<double>(count);
}

StudyResult SweepExperiment::sum_up(const TaskOutcomes& outcomes,
                                    const StudyContext& context) const {
  std::vector<SweepCell> cells;
  std::vector<std::optional<TaskOutcome>> read(outcomes.size());
  for (std::size_t task = 0; task < outcomes.size(); ++task) {
    cells.push_back(cell(task));
    if (outcomes[task]) read[task] = read_outcome(outcomes[task]->outcome);
  }
  return sum_up_sweep(options_.sweep, axes(), cells, read, context);
}

StudyResult SweepExperiment::replay(std::size_t task, const StudyContext& context) const {
  InvertOptions options = options_.cells[task];
  options.write_signals = true;
  options.figures = replay_figures();
  return options.run(context);
}

}  // namespace modcal
