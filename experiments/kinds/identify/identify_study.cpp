#include "experiments/kinds/identify/identify_study.hpp"

#include <cmath>

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

std::string sentence_of(const IdentifyOutcome& outcome) {
  std::string text = fmt::format("{} modes identified", outcome.found.modes.size());
  if (!outcome.found.missing.empty()) {
    text += fmt::format(", {} missing below the highest", outcome.found.missing.size());
  }
  if (outcome.law) {
    text += fmt::format("; f0 = {:.6g} Hz, B = {:.4g}", outcome.law->fundamental,
                        outcome.law->inharmonicity);
  }
  return text + "\n";
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

StudyResult identify_study(const IdentifyOptions& options, const StudyContext& context) {
  const IdentifyOutcome outcome = identify_outcome(options, context);
  StudyResult result;
  result.blocks.emplace_back(identified_modes_table(outcome, context.command));
  result.blocks.emplace_back(stabilization_figure(outcome, context.command));
  if (!outcome.found.modes.empty()) {
    result.blocks.emplace_back(identified_errors_figure(outcome, context.command));
  }
  result.files.emplace_back("identification.json", identification_json(outcome));
  result.summary = sentence_of(outcome);
  if (outcome.found.modes.empty() || !outcome.found.converged) {
    result.status = report::Status::kFailed;
    result.summary += outcome.found.modes.empty()
                          ? "no pole is stable over the orders: nothing was identified\n"
                          : "the fit did not converge: its modes and error bars are not final\n";
  }
  return result;
}

}  // namespace modcal
