#include "experiments/kinds/simulate/simulate_study.hpp"

#include "experiments/kinds/lint.hpp"
#include "experiments/kinds/simulate/motion_text.hpp"
#include "experiments/kinds/structure/structure_files.hpp"
#include "experiments/report/result.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

void SimulateOptions::visit(OptionVisitor& visitor) {
  visitor("scene", "a bowed string: string, bow, friction", has_scene, truth.scene);
  visitor("structure", "any structure under a bow, in the place of a scene", has_structure,
          structure);
  visitor("simulator", "how the scene is simulated", truth.simulator);
  visitor("measurement", "sampling and noise of the reactions", measurement);
  visitor("outputs",
          "signals that are computed: motion and force at the contact, reactions; of a structure "
          "all that its sensors read besides, and no reactions",
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
  std::vector<Finding> findings;
  if (has_scene == has_structure) {
    add_finding(findings, has_scene ? "structure" : "",
                "one of both is simulated: state scene: (a bowed string) or structure: (a bow on "
                "what a table of modes describes)");
    return findings;
  }
  findings = has_scene ? lint_scene(truth.scene, truth.simulator, measurement)
                       : structure.lint(truth.simulator, measurement);
  append(findings, lint_signals());
  return findings;
}

std::vector<Finding> SimulateOptions::lint_signals() const {
  std::vector<Finding> findings;
  if (std::ranges::count(files, "wav") > 0) lint_sound("files", measurement.sample_rate, findings);
  if (outputs.empty() && has_scene) {
    add_finding(findings, "outputs", "nothing is computed: name an output, or leave the key out");
  }
  append(findings, lint_figures(figures, FigureContent::kWaveforms,
                                has_scene ? truth.scene.duration : structure.duration));
  for (const FigureOptions& figure : figures) {
    for (const std::string& quantity : figure.quantities) {
      const bool reaction = quantity_of(quantity).identified == nullptr;
      if (has_structure && reaction) {
        add_finding(findings, "figures",
                    "figure {} draws {}, the reaction at the end of a string, which a structure "
                    "does not have: draw y, v or f_c",
                    figure.id, quantity);
      } else if (std::find(outputs.begin(), outputs.end(), quantity) == outputs.end()) {
        add_finding(findings, "outputs",
                    "figure {} draws {}, which is not among the outputs: "
                    "add it there, or draw another one",
                    figure.id, quantity);
      }
    }
  }
  return findings;
}

std::vector<Finding> SimulateOptions::lint_records(const std::filesystem::path& folder) const {
  if (!has_structure) return {};
  return structure.lint_table(folder, truth.simulator, measurement);
}

std::vector<FileRead> SimulateOptions::files_read() const {
  if (!has_structure) return {};
  return {structure.file_read(measurement.sample_rate)};
}

std::vector<PlanLine> SimulateOptions::plan() const {
  if (const auto planned = planned_simulations()) return {plan_line(*planned)};
  return {{fmt::format("simulate {:g} s of a bow on the structure of {}, {} samples at {:g} Hz",
                       structure.duration, structure.table,
                       sample_count(structure.duration, measurement.sample_rate),
                       measurement.sample_rate),
           {{"table", structure.table}, {"duration", structure.duration}}}};
}

std::optional<PlannedSimulations> SimulateOptions::planned_simulations() const {
  if (!has_scene) return std::nullopt;
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

void add_signals(const std::vector<Signal>& signals, const Simulation& simulation,
                 const SimulateOptions& options, StudyResult& result) {
  if (!signals.empty()) result.add({level_table(signals)});
  result.add({run_table(simulation)});
  for (const std::string& format : options.files) {
    result.signal_files.push_back({"signals." + format, signals, options.wav_full_scale});
  }
  const std::string refined =
      simulation.refined_steps == 0
          ? ""
          : fmt::format(" ({} taken back for shorter ones)", simulation.refined_steps);
  result.summary +=
      fmt::format("\n{} steps of {:.6g} s{}, {} attachments, {} signals of {} samples\n",
                  simulation.steps, simulation.time_step, refined, simulation.attachments,
                  signals.size(), signals.empty() ? 0 : signals[0].size());
  result.answer_by_summary();
}

StudyResult SimulateOptions::run(const StudyContext& context) const {
  if (has_structure) return run_structure(context);
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
  result.summary = motion_text(truth.scene, simulation);
  add_signals(signals, simulation, *this, result);
  return result;
}

}  // namespace modcal
