#include "experiments/kinds/identify/identify.hpp"

#include "experiments/kinds/lint.hpp"
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

// What an identification found, and its figures.

using report::Series;
using report::SeriesStyle;

// Against the truth, or of a record against the law through all of its frequencies.
report::Figure errors_figure(const IdentifyOutcome& outcome) {
  const bool is_recorded = outcome.truth == nullptr;
  const auto expected = [&](std::size_t number) {
    if (is_recorded) return outcome.law->frequency(number);
    const ModalBasis& basis = outcome.truth->basis;
    return number > basis.size() ? 0.0 : basis.frequency(number - 1);
  };
  Series errors{.label = is_recorded ? "identified minus law" : "identified minus true",
                .style = SeriesStyle::kPoints};
  for (const auto& [number, mode] : outcome.found.modes) {
    const double truth = expected(number);
    if (truth == 0.0) continue;
    const double error = mode.pole.frequency / truth - 1.0;
    const double deviation = mode.deviation.frequency / truth;
    errors.add(static_cast<double>(number), error, error - deviation, error + deviation);
  }
  return {.id = "frequency_errors",
          .title = is_recorded ? "Frequencies beside the law of a stiff string"
                               : "Errors of the identified frequencies",
          .caption = "Bars: one standard deviation to either side.",
          .panels = {{.x = {.label = "mode"},
                      .y = {.label = is_recorded ? "relative distance of the frequency"
                                                 : "relative error of the frequency"},
                      .series = {std::move(errors)},
                      .markers = {{.direction = report::Marker::Direction::kHorizontal}}}}};
}

std::string sentence_of(const IdentifyOutcome& outcome) {
  std::string text = fmt::format("{} modes identified", outcome.found.modes.size());
  if (!outcome.found.missing.empty()) {
    text += fmt::format(", {} missing below the highest", outcome.found.missing.size());
  }
  if (outcome.law) {
    text += fmt::format(
        "; f0 = {:.6g} Hz, B = {}", outcome.law->fundamental,
        inharmonicity_text(outcome.law->inharmonicity, outcome.law->inharmonicity_deviation));
  }
  text += "\n";
  const std::vector<double>& lines = outcome.found.lines;
  if (!lines.empty()) {
    text += fmt::format("hum of the mains at {:.3f} Hz: {} lines are fitted beside the modes\n",
                        lines.front(), lines.size());
  }
  return text;
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
  visitor("identification", "how the modes are found", identification);
  visitor("seed", "key of the noise", {.range = Range::non_negative()}, seed);
}

std::vector<Finding> IdentifyOptions::lint() const {
  if (has_scene && !has_record) return lint_simulated();
  std::vector<Finding> findings;
  if (has_scene) {
    add_finding(findings, "record", "both a scene and a record are stated: keep one");
  } else if (!has_record) {
    add_finding(findings, "",
                "nothing to identify: state a scene (simulated) or a record (a file)");
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
  if (truth.scene.start.selected() == "rest") {
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
  if (options.has_record) {
    IdentifyOutcome outcome{
        .record = load_pluck(options.record, context.folder, options.fundamental, context.stop)};
    context.throw_if_interrupted();
    outcome.found =
        identify_pluck(outcome.record->decay, options.fundamental, options.identification);
    outcome.law = law_of(outcome.found);
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

void IdentifyOutcome::visit(ResultVisitor& visitor) const {
  const std::size_t known_modes = truth ? truth->basis.size() : 0;
  visitor.rows(
      {.key = "modes",
       .table = "modes",
       .name = "Identified modes",
       .meaning =
           found.full_rank
               ? "Deviations are the Cramér–Rao bound of the fit. A second pole of a third of the "
                 "amplitude that the record does not show may move the frequency by the next "
                 "column."
               : "Deviations are the spread over the orders of the realization: no error bars."},
      found.modes, [&](ResultVisitor& row, const PluckedMode& plucked) {
        const auto& [number, mode] = plucked;
        const auto of_truth = [&, n = number](auto value) {
          return n <= known_modes ? std::optional<double>(value(n - 1)) : std::nullopt;
        };
        row({.key = "n", .name = "mode"}, number);
        row({.key = "f_hz", .name = "frequency", .unit = "Hz", .format = "{:.7g}"},
            mode.pole.frequency);
        row({.key = "f_sd_hz", .name = "its deviation", .unit = "Hz", .format = "{:.2g}"},
            mode.deviation.frequency);
        row({.key = "f_unseen_hz",
             .name = "moved by an unseen pole",
             .unit = "Hz",
             .format = "{:.2g}"},
            unseen_shift(found, plucked));
        row({.key = "f_true_hz", .name = "true frequency", .unit = "Hz", .format = "{:.7g}"},
            of_truth([&](std::size_t n) { return truth->basis.frequency(n); }));
        row({.key = "zeta", .name = "damping ratio"}, mode.pole.damping_ratio);
        row({.key = "zeta_sd", .name = "its deviation", .format = "{:.2g}"},
            mode.deviation.damping_ratio);
        row({.key = "zeta_true", .name = "true damping ratio"},
            of_truth([&](std::size_t n) { return truth->basis.zeta[n]; }));
      });
  visitor({.key = "missing"}, found.missing);
  std::vector<double> others;
  for (const DecayMode& mode : found.others) others.push_back(mode.pole.frequency);
  visitor({.key = "without_number_hz"}, others);
  std::vector<std::size_t> doubled;
  for (const PluckedMode& second : found.seconds) doubled.push_back(second.number);
  visitor({.key = "with_second_pole"}, doubled);
  if (record) visitor({.key = "begin_s"}, record->begin);
  if (record) visitor({.key = "end_s"}, record->end);
  visitor({.key = "deviations_are_error_bars"}, found.full_rank);
  visitor({.key = "mains_lines_hz"}, found.lines);
  visitor({.key = "noise_in_band_n"}, found.noise);
  visitor({.key = "converged"}, found.converged);
  visitor({.key = "stiff_string_law", .optional = true}, law);
}

report::Figure stabilization_figure(const IdentifyOutcome& outcome) {
  Series moving{.label = "moves with the order",
                .style = SeriesStyle::kPoints,
                .color = report::ColorRole::kMuted};
  Series stable{.label = "stable", .style = SeriesStyle::kPoints};
  for (const StabilizationPoint& point : outcome.found.diagram) {
    (point.stable_orders > 1 ? stable : moving)
        .add(point.pole.frequency, static_cast<double>(point.order));
  }
  return {.id = "stabilization",
          .title = "Stabilization diagram",
          .caption = "Poles of the realizations; a mode stays where it is when the order grows.",
          .panels = {{.x = {.label = "frequency", .unit = "Hz"},
                      .y = {.label = "order"},
                      .series = {std::move(moving), std::move(stable)}}}};
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
  result.summary = sentence_of(outcome);
  result.answer_by_summary();
  if (outcome.found.modes.empty() || !outcome.found.converged) {
    result.status = report::Status::kFailed;
    result.answer = outcome.found.modes.empty()
                        ? why_nothing(outcome)
                        : "the fit did not converge: its modes and error bars are not final; take "
                          "method: era, or lower identification.highest_frequency";
    result.summary += result.answer + "\n";
  }
  if (!outcome.record) return result;
  for (const std::string& warning : outcome.record->warnings) result.warn(warning);
  if (result.status != report::Status::kOk) return result;
  std::vector<std::string> warnings;
  const std::string why =
      doubt_decay(outcome.found, outcome.record->decay, fundamental, outcome.law, warnings);
  for (const std::string& warning : warnings) result.warn(warning);
  if (why.empty()) return result;
  result.status = report::Status::kFailed;
  result.answer = why;
  result.warn(why);
  return result;
}

}  // namespace modcal
