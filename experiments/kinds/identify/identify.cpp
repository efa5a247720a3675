#include "experiments/kinds/identify/identify.hpp"

#include "experiments/kinds/lint.hpp"
#include "experiments/kinds/structure/structure_kinds.hpp"
#include "experiments/report/result.hpp"

namespace modcal {
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

}  // namespace

void IdentifyOptions::visit(OptionVisitor& visitor) {
  visitor("scene", "string and how it is plucked, simulated", has_scene, truth.scene);
  visitor("simulator", "how the scene is simulated", truth.simulator);
  visitor("measurement", "sampling and noise of the reactions", measurement);
  visitor("record", "recorded reactions of a plucked string, in place of a scene", has_record,
          record);
  visitor("fundamental", "f0 of the recorded string, to about 1 %",
          {.unit = "Hz", .range = Range::positive(), .word = "none"}, fundamental);
  visitor("structure", "any structure that rings freely, in place of a string", has_structure,
          structure);
  visitor("identification", "how the modes are found", identification);
  visitor("seed", "key of the noise", {.range = Range::non_negative()}, seed);
}

void DecayingStructure::visit(OptionVisitor& visitor) {
  visitor("record", "responses of the structure's sensors", {.required = true}, record);
}

std::vector<Finding> IdentifyOptions::lint() const {
  std::vector<Finding> findings;
  const StabilizationOptions& orders = identification.stabilization;
  const std::int64_t count = (orders.highest_order - orders.lowest_order) / 2 + 1;
  if (orders.highest_order < orders.lowest_order || count < orders.required) {
    add_finding(findings, "identification.stabilization",
                "a mode is to be stable over {} orders in a row (required), and from {} to {} by "
                "twos there are {}: raise highest_order, or require fewer",
                orders.required, orders.lowest_order, orders.highest_order,
                std::max<std::int64_t>(0, count));
  } else if (!has_structure && identification.lowest_frequency > 0.0) {
    add_finding(findings, "identification.lowest_frequency",
                "a string's modes are numbered from the fundamental on: leave it out");
  } else if (has_scene + has_record + has_structure > 1) {
    add_finding(findings, has_record ? "record" : "structure",
                "only one of scene, record and structure can be identified: keep one");
  } else if (has_scene) {
    return lint_simulated();
  } else if (has_record || has_structure) {
    return lint_recorded();
  } else {
    add_finding(findings, "",
                "nothing to identify: state a scene (simulated), the record of a string or a "
                "structure with its record (files)");
  }
  return findings;
}

std::vector<Finding> IdentifyOptions::lint_recorded() const {
  std::vector<Finding> findings;
  const double lowest = identification.lowest_frequency;
  if (!(identification.highest_frequency > lowest)) {
    add_finding(findings, "identification.highest_frequency",
                "{:g} Hz is not above identification.lowest_frequency, {:g} Hz",
                identification.highest_frequency, lowest);
  } else if (has_structure && !std::isnan(fundamental)) {
    add_finding(
        findings, "fundamental",
        "modes of a structure are numbered in order: leave it out, or state the record of a "
        "string (record)");
  } else if (has_structure && structure.record.has_force) {
    add_finding(
        findings, "structure.record.force",
        "a free decay has no force: leave it out, or state kind: fit_modes, which finds the "
        "modes of a strike");
  } else if (has_structure && !std::isnan(structure.record.window)) {
    add_finding(findings, "structure.record.exponential_window",
                "a window that is taken out makes noise grow along the decay, which the deviations "
                "do not hold: leave it out, and take 1/(2 pi f tau) from the damping ratios");
  } else if (has_structure) {
    append(findings,
           lint_responses("structure.record.responses", structure.record.responses.size()));
  } else if (std::isnan(fundamental)) {
    add_finding(findings, "record",
                "modes are numbered by the string's f0: state fundamental: ... Hz, to about 1 %");
  } else if (!(identification.highest_frequency > fundamental)) {
    add_finding(findings, "identification.highest_frequency",
                "no mode lies below {:g} Hz: the fundamental is {:g} Hz",
                identification.highest_frequency, fundamental);
  }
  return findings;
}

std::vector<Finding> IdentifyOptions::lint_simulated() const {
  std::vector<Finding> findings = lint_scene(truth.scene, truth.simulator, measurement);
  if (truth.scene.start.make()->at_rest()) {
    add_finding(
        findings, "scene.initial",
        "a string at rest has no free decay: pluck it (scene.initial: {{type: pluck, ...}})");
  }
  const double rate = measurement.sample_rate;
  if (!(identification.highest_frequency < 0.5 * rate)) {
    add_finding(findings, "identification.highest_frequency",
                "{:g} Hz is not below half the sample rate, {:g} Hz: lower it, or raise "
                "measurement.sample_rate",
                identification.highest_frequency, 0.5 * rate);
  } else if (!(identification.highest_frequency > truth.scene.string.fundamental)) {
    add_finding(findings, "identification.highest_frequency",
                "no mode lies below {:g} Hz: the fundamental is {:g} Hz",
                identification.highest_frequency, truth.scene.string.fundamental);
  } else if (findings.empty()) {
    lint_making(findings, "scene.duration", [&] {
      require_decay_length(sample_count(truth.scene.duration, rate), rate, identification);
    });
  }
  if (truth.scene.bow.normal_force != 0.0) {
    findings.push_back(
        {"scene.bow.normal_force",
         fmt::format("a bow that presses with {:g} N holds the string, whose decay is "
                     "then not free: state normal_force: 0 N",
                     truth.scene.bow.normal_force),
         false});
  }
  return findings;
}

std::vector<PlanLine> IdentifyOptions::plan() const {
  const auto& orders = identification.stabilization;
  return {{fmt::format("identify modes up to {:g} Hz by {}, orders {} to {}",
                       identification.highest_frequency, identification.method, orders.lowest_order,
                       orders.highest_order),
           {{"identification",
             {{"highest_frequency", identification.highest_frequency},
              {"method", identification.method},
              {"lowest_order", orders.lowest_order},
              {"highest_order", orders.highest_order}}}}}};
}

std::optional<PlannedSimulations> IdentifyOptions::planned_simulations() const {
  if (!has_scene) return std::nullopt;
  // The fit has columns for every mode; of the samples, the band's share is left.
  const double left =
      std::min(1.0, 2.6 * identification.highest_frequency / measurement.sample_rate);
  const double columns = 13.0 * static_cast<double>(truth.scene.string.modes);
  return PlannedSimulations{.truth = truth,
                            .sample_rate = measurement.sample_rate,
                            .outputs = {.left_reaction = true, .right_reaction = true},
                            .numbers_per_sample = 12.0 + left * columns};
}

IdentifyOutcome identify_outcome(const IdentifyOptions& options, const StudyContext& context) {
  if (options.has_record || options.has_structure) {
    IdentifyOutcome outcome{.record = load_decay(options, context.folder, context.stop)};
    context.throw_if_interrupted();
    outcome.found =
        identify_pluck(outcome.record->decay, options.fundamental, options.identification);
    if (options.has_record) outcome.law = law_of(outcome.found);
    return outcome;
  }
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

StudyResult IdentifyOptions::run(const StudyContext& context) const {
  const IdentifyOutcome outcome = identify_outcome(*this, context);
  StudyResult result;
  if (!outcome.found.modes.empty() && (outcome.truth || outcome.law)) {
    result.blocks.emplace_back(errors_figure(outcome));
  }
  result.add(report::tables_of(outcome));
  result.blocks.emplace_back(stabilization_figure(outcome));
  result.files.emplace_back("identification.json", report::json_file(report::json_of(outcome)));
  result.summary = sentence_of(outcome, identification.highest_frequency);
  result.answer_by_summary();
  if (outcome.found.modes.empty() || !outcome.found.converged) {
    result.status = report::Status::kFailed;
    result.answer = outcome.found.modes.empty()
                        ? why_nothing(outcome)
                        : "the fit did not converge: its modes and error bars are not final; "
                          "state record.start and record.stop of one free decay, as where a "
                          "second blow follows, or lower identification.highest_frequency";
    result.summary += result.answer + "\n";
  }
  if (!outcome.record) return result;
  for (const std::string& warning : outcome.record->warnings) result.warn(warning);
  if (!outcome.found.full_rank && !outcome.found.modes.empty()) {
    result.warn(
        "the modes have no error bars, but the spread over the orders of the realization, and "
        "nothing asks whether they explain the record: method: maximum_likelihood does both, where "
        "the record tells its poles apart");
  }
  if (result.status != report::Status::kOk) return result;
  std::vector<std::string> warnings;
  const std::string why =
      doubt_decay(outcome.found, *outcome.record, fundamental, outcome.law, warnings);
  for (const std::string& warning : warnings) result.warn(warning);
  if (why.empty()) return result;
  result.status = report::Status::kFailed;
  result.answer = why;
  result.warn(why);
  return result;
}

}  // namespace modcal
