#include "experiments/kinds/simulate/simulate_study.hpp"

#include "experiments/kinds/lint.hpp"
#include "experiments/kinds/simulate/motion_text.hpp"
#include "experiments/report/result.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

void SimulateOptions::visit(OptionVisitor& visitor) {
  visitor("scene", "string, bow, friction", {.required = true}, truth.scene);
  visitor("simulator", "how the scene is simulated", truth.simulator);
  visitor("measurement", "sampling and noise of the reactions", measurement);
  visitor("outputs", "signals that are computed: motion and force at the contact, reactions",
          {.choices = {"y", "v", "f_c", "R1", "R2"}}, outputs);
  visitor("files", "record files to write: signals.csv, signals.wav", {.choices = {"csv", "wav"}},
          files);
  visitor("wav_full_scale",
          "what the full scale 1.0 of the sound file stands for, in the SI unit "
          "of each signal",
          {.range = Range::positive()}, wav_full_scale);
  visitor("seed", "key of the noise", {.range = Range::non_negative()}, seed);
  visitor("figures", "what is drawn", figures);
}

std::vector<Finding> SimulateOptions::lint() const {
  std::vector<Finding> findings = lint_scene(truth.scene, truth.simulator, measurement);
  if (std::ranges::count(files, "wav") > 0) lint_sound("files", measurement.sample_rate, findings);
  if (outputs.empty()) {
    add_finding(findings, "outputs", "nothing is computed: name an output, or leave the key out");
  }
  append(findings, lint_figures(figures, {"waveforms"}, truth.scene.duration));
  for (const FigureOptions& figure : figures) {
    for (const std::string& quantity : figure.quantities) {
      if (std::find(outputs.begin(), outputs.end(), quantity) != outputs.end()) continue;
      add_finding(findings, "outputs",
                  "figure {} draws {}, which is not among the outputs: "
                  "add it there, or draw another one",
                  figure.id, quantity);
    }
  }
  return findings;
}

std::vector<PlanLine> SimulateOptions::plan() const { return {plan_line(*planned_simulations())}; }

std::optional<PlannedSimulations> SimulateOptions::planned_simulations() const {
  return PlannedSimulations{.truth = truth,
                            .sample_rate = measurement.sample_rate,
                            .outputs = request_of(outputs),
                            .numbers_per_sample = 3.0 * static_cast<double>(outputs.size()) + 2.0};
}

namespace {

constexpr double kPeriodsShown = 6.0;

// Reactions go through the sensor; motion and force at the contact are the truth.
std::vector<Signal> measured(const Simulation& simulation, const SimulateOptions& options) {
  const StreamKey noise =
      StreamKey(static_cast<std::uint64_t>(options.seed)).with("measurement noise");
  std::vector<Signal> signals;
  for (const Quantity& quantity : kQuantities) {
    const Signal& signal = simulation.*quantity.simulated;
    if (std::ranges::count(options.outputs, quantity.name) == 0) continue;
    const bool reaction = quantity.identified == nullptr;
    signals.push_back(reaction ? measure(signal, options.measurement, noise.with(signal.quantity))
                               : signal);
  }
  return signals;
}

report::Table run_table(const Simulation& simulation) {
  report::Table table{.id = "simulation", .title = "Simulation"};
  report::add_row(table, [&simulation](ResultVisitor& row) {
    row({.key = "time_step", .name = "time step taken", .unit = "s"}, simulation.time_step);
    row({.key = "steps"}, simulation.steps);
    row({.key = "refined_steps", .name = "taken back for shorter ones"}, simulation.refined_steps);
    row({.key = "attachments"}, simulation.attachments);
    row({.key = "releases"}, simulation.releases);
    row({.key = "modes_moved", .name = "modes moved"}, simulation.modes_moved);
  });
  return table;
}

report::Table level_table(const std::vector<Signal>& signals) {
  return report::table_of(
      {.id = "levels", .title = "Levels"}, signals, [](ResultVisitor& row, const Signal& signal) {
        const auto [low, high] = std::minmax_element(signal.samples.begin(), signal.samples.end());
        row({.key = "signal"}, signal.quantity);
        row({.key = "unit"}, signal.unit);
        row({.key = "mean"}, mean(signal.samples));
        row({.key = "std"}, standard_deviation(signal.samples));
        row({.key = "lowest"}, *low);
        row({.key = "highest"}, *high);
      });
}

}  // namespace

StudyResult SimulateOptions::run(const StudyContext& context) const {
  OutputRequest request = request_of(outputs);
  request.velocity = true;  // tells the motion
  const auto truth_found =
      context.work.truths.get(truth, measurement.sample_rate, request, context.progress);
  Simulation simulation = truth_found->simulation;
  const std::vector<Signal> signals = measured(simulation, *this);
  for (const Signal& signal : signals) {
    simulation.*quantity_of(signal.quantity).simulated = signal;
  }

  StudyResult result;
  std::vector<FigureOptions> drawn = figures;
  if (drawn.empty()) {
    drawn.push_back({.id = "motion", .title = "The last periods", .quantities = outputs});
    const double shown = kPeriodsShown / truth.scene.string.fundamental;
    drawn.back().windows = {{.start = std::max(0.0, truth.scene.duration - shown)}};
  }
  for (const FigureOptions& figure : drawn) {
    result.blocks.emplace_back(simulation_figure(figure, simulation));
  }
  if (!signals.empty()) result.add({level_table(signals)});
  result.add({run_table(simulation)});
  for (const std::string& format : files) {
    result.signal_files.push_back({"signals." + format, signals, wav_full_scale});
  }
  const std::string refined =
      simulation.refined_steps == 0
          ? ""
          : fmt::format(" ({} taken back for shorter ones)", simulation.refined_steps);
  result.summary = fmt::format(
      "{}\n{} steps of {:.6g} s{}, {} attachments, {} signals of {} samples\n",
      motion_text(truth.scene, simulation), simulation.steps, simulation.time_step, refined,
      simulation.attachments, signals.size(), signals.empty() ? 0 : signals[0].size());
  result.answer_by_summary();
  return result;
}

}  // namespace modcal
