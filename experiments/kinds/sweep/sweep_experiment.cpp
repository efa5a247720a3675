#include "experiments/kinds/sweep/sweep_experiment.hpp"

#include "experiments/runs/stored_outcomes.hpp"

namespace modcal {

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
                         std::string(cell.inversion.estimator.selected()), std::move(outcome)});
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
