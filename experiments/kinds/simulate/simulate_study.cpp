#include "experiments/kinds/simulate/simulate_study.hpp"

#include <algorithm>

#include "experiments/study/figures.hpp"
#include "libsim/base/random.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

void SimulateOptions::visit(OptionVisitor& visitor) {
  visitor.section({.key = "scene", .meaning = "string, bow, friction", .required = true},
                  truth.scene);
  visitor.plugin({.key = "simulator", .meaning = "how the scene is simulated"}, truth.simulator);
  visitor.section({.key = "measurement", .meaning = "sampling and noise of the reactions"},
                  measurement);
  visitor.texts({.key = "outputs",
                 .meaning = "signals that are computed: motion and force at the contact, reactions",
                 .choices = {"y", "v", "f_c", "R1", "R2"}},
                outputs);
  visitor.texts({.key = "files",
                 .meaning = "record files to write: signals.csv, signals.wav",
                 .choices = {"csv", "wav"}},
                files);
  visitor.number({.key = "wav_full_scale",
                  .meaning = "what the full scale 1.0 of the sound file stands for, in the SI unit "
                             "of each signal",
                  .range = Range::positive()},
                 wav_full_scale);
  visitor.integer({.key = "seed", .meaning = "key of the noise", .range = Range::non_negative()},
                  seed);
  ListOf<FigureOptions> list(figures);
  visitor.list({.key = "figures", .meaning = "what is drawn"}, list);
}

OutputRequest request_of(const std::vector<std::string>& outputs) {
  const auto wanted = [&outputs](std::string_view name) {
    return std::find(outputs.begin(), outputs.end(), name) != outputs.end();
  };
  return {.displacement = wanted("y"),
          .velocity = wanted("v"),
          .force = wanted("f_c"),
          .left_reaction = wanted("R1"),
          .right_reaction = wanted("R2")};
}

namespace {

// Reactions go through the sensor; motion and force at the contact are the truth.
Simulation measured(Simulation simulation, const Measurement& measurement, const StreamKey& key) {
  const StreamKey noise = key.with("measurement noise");
  for (Signal* reaction : {&simulation.left_reaction, &simulation.right_reaction}) {
    if (reaction->samples.empty()) continue;
    *reaction = measure(*reaction, measurement, noise.with(reaction->quantity));
  }
  return simulation;
}

std::vector<Signal> signals_of(const Simulation& simulation) {
  std::vector<Signal> signals;
  for (const Signal* signal : {&simulation.displacement, &simulation.velocity, &simulation.force,
                               &simulation.left_reaction, &simulation.right_reaction}) {
    if (!signal->samples.empty()) signals.push_back(*signal);
  }
  return signals;
}

report::Table run_table(const Simulation& simulation, const std::string& command) {
  return {.id = "simulation",
          .title = "Simulation",
          .columns = {{.key = "time_step", .name = "time step taken", .unit = "s"},
                      {.key = "steps", .name = "steps"},
                      {.key = "refined_steps", .name = "taken back for shorter ones"},
                      {.key = "attachments", .name = "attachments"},
                      {.key = "releases", .name = "releases"},
                      {.key = "modes_moved", .name = "modes moved"}},
          .rows = {{simulation.time_step, simulation.steps, simulation.refined_steps,
                    simulation.attachments, simulation.releases, simulation.modes_moved}},
          .command = command};
}

report::Table level_table(const std::vector<Signal>& signals, const std::string& command) {
  report::Table table{.id = "levels",
                      .title = "Levels",
                      .columns = {{.key = "signal"},
                                  {.key = "unit"},
                                  {.key = "mean"},
                                  {.key = "std"},
                                  {.key = "lowest"},
                                  {.key = "highest"}},
                      .command = command};
  for (const Signal& signal : signals) {
    const auto [low, high] = std::minmax_element(signal.samples.begin(), signal.samples.end());
    table.rows.push_back({signal.quantity, signal.unit, mean(signal.samples),
                          standard_deviation(signal.samples), *low, *high});
  }
  return table;
}

}  // namespace

StudyResult simulate_study(const SimulateOptions& options, const StudyContext& context) {
  const OutputRequest request = request_of(options.outputs);
  const auto truth =
      context.work.truths.get(options.truth, options.measurement.sample_rate, request);
  const StreamKey key(static_cast<std::uint64_t>(options.seed));
  const Simulation simulation = measured(truth->simulation, options.measurement, key);
  const std::vector<Signal> signals = signals_of(simulation);

  StudyResult result;
  for (const FigureOptions& figure : options.figures) {
    report::Figure drawn = simulation_figure(figure, simulation);
    drawn.command = context.command;
    result.blocks.emplace_back(std::move(drawn));
  }
  result.blocks.emplace_back(run_table(simulation, context.command));
  result.blocks.emplace_back(level_table(signals, context.command));
  for (const std::string& format : options.files) {
    result.signal_files.push_back({"signals." + format, signals, options.wav_full_scale});
  }
  const std::string refined =
      simulation.refined_steps == 0
          ? ""
          : fmt::format(" ({} taken back for shorter ones)", simulation.refined_steps);
  result.summary =
      fmt::format("{} steps of {:.6g} s{}, {} attachments, {} signals of {} samples\n",
                  simulation.steps, simulation.time_step, refined, simulation.attachments,
                  signals.size(), signals.empty() ? 0 : signals[0].size());
  return result;
}

}  // namespace modcal
