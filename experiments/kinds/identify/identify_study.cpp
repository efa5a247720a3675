#include "experiments/kinds/identify/identify_study.hpp"

#include <cmath>

#include "experiments/kinds/lint.hpp"
#include "libinverse/modes/pluck_identification.hpp"
#include "libsim/base/random.hpp"

namespace modcal {

void IdentifyOptions::visit(OptionVisitor& visitor) {
  visitor.section({.key = "scene", .meaning = "string and how it is plucked", .required = true},
                  truth.scene);
  visitor.plugin({.key = "simulator", .meaning = "how the scene is simulated"}, truth.simulator);
  visitor.section({.key = "measurement", .meaning = "sampling and noise of the reactions"},
                  measurement);
  visitor.section({.key = "identification", .meaning = "how the modes are found"}, identification);
  visitor.integer({.key = "seed", .meaning = "key of the noise", .range = Range::non_negative()},
                  seed);
}

std::vector<Finding> IdentifyOptions::lint() const {
  std::vector<Finding> findings = lint_scene(truth.scene, truth.simulator, measurement);
  if (truth.scene.start.selected() == "rest") {
    add_finding(findings, "scene.initial", "a string at rest has no free decay: pluck it");
  }
  const double rate = measurement.sample_rate;
  if (!(identification.highest_frequency < 0.5 * rate)) {
    add_finding(findings, "identification.highest_frequency",
                "{:g} Hz lie above half the sample rate {:g} Hz", identification.highest_frequency,
                rate);
  } else if (findings.empty()) {
    lint_making(findings, "scene.duration", [&] {
      require_decay_length(sample_count(truth.scene.duration, rate), rate, identification);
    });
  }
  return findings;
}

std::vector<std::string> IdentifyOptions::plan() const {
  return {fmt::format("identify modes up to {:g} Hz by {}, orders {} to {}",
                      identification.highest_frequency, identification.method,
                      identification.stabilization.lowest_order,
                      identification.stabilization.highest_order)};
}

std::optional<PlannedSimulations> IdentifyOptions::planned_simulations() const {
  return PlannedSimulations{.scene = truth.scene,
                            .simulator = truth.simulator,
                            .sample_rate = measurement.sample_rate,
                            .outputs = {.left_reaction = true, .right_reaction = true}};
}

namespace {

DecayRecord measured_decay(const Simulation& simulation, const IdentifyOptions& options) {
  const StreamKey noise =
      StreamKey(static_cast<std::uint64_t>(options.seed)).with("measurement noise");
  DecayRecord record{.sample_rate = options.measurement.sample_rate};
  for (const Signal* reaction : {&simulation.left_reaction, &simulation.right_reaction}) {
    record.channels.push_back(
        measure(*reaction, options.measurement, noise.with(reaction->quantity)).samples);
  }
  return record;
}

std::optional<StiffStringFit> law_of(const PluckIdentification& found) {
  if (found.modes.size() < 2) return std::nullopt;
  std::vector<double> frequencies(found.modes.back().number, 0.0);
  std::vector<double> weights(frequencies.size(), 0.0);
  for (const auto& [number, mode] : found.modes) {
    const double deviation = mode.deviation.frequency;
    frequencies[number - 1] = mode.pole.frequency;
    weights[number - 1] = found.full_rank ? 1.0 / (deviation * deviation) : 1.0;
  }
  return fit_stiff_string(frequencies, weights);
}

}  // namespace

IdentifyOutcome identify_outcome(const IdentifyOptions& options, const StudyContext& context) {
  const auto truth = context.work.truths.get(options.truth, options.measurement.sample_rate,
                                             {.left_reaction = true, .right_reaction = true});
  context.throw_if_interrupted();
  IdentifyOutcome outcome{
      .found = identify_pluck(measured_decay(truth->simulation, options),
                              options.truth.scene.string.fundamental, options.identification),
      .truth = truth};
  outcome.law = law_of(outcome.found);
  return outcome;
}

}  // namespace modcal
