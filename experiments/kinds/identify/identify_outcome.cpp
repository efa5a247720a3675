// What an identification found, in words, tables and figures.
#include "experiments/kinds/identify/identify.hpp"
#include "experiments/report/result.hpp"
#include "libinverse/modes/tuning.hpp"

namespace modcal {

using report::Series;
using report::SeriesStyle;

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

std::string sentence_of(const IdentifyOutcome& outcome, double highest_frequency) {
  std::string text = fmt::format("{} modes identified", outcome.found.modes.size());
  if (outcome.record) {
    text += fmt::format(
        " up to {:g} Hz (identification.highest_frequency) in the decay from {:.4g} to {:.4g} s",
        highest_frequency, outcome.record->begin, outcome.record->end);
  }
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

void IdentifyOutcome::visit(ResultVisitor& visitor) const {
  const std::size_t known_modes = truth ? truth->basis.size() : 0;
  visitor.rows(
      {.key = "modes",
       .table = "modes",
       .name = "Identified modes",
       .meaning =
           found.full_rank
               ? "Deviations are the Cramér–Rao bound of the fit. A second pole of a third of the "
                 "amplitude that the record does not show may move frequency and damping ratio by "
                 "the columns beside theirs."
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
        row({.key = "zeta_unseen", .name = "moved by an unseen pole", .format = "{:.2g}"},
            unseen_shift(found, plucked) / mode.pole.frequency);
        row({.key = "zeta_true", .name = "true damping ratio"},
            of_truth([&](std::size_t n) { return truth->basis.zeta[n]; }));
      });
  visit_shapes(visitor);
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
  // In newtons of a string's reactions, in the SI unit of each sensor of a structure.
  const bool is_structure = record && !record->names.empty();
  visitor({.key = is_structure ? "noise_in_band" : "noise_in_band_n"}, found.noise);
  visitor({.key = "converged"}, found.converged);
  visitor({.key = "stiff_string_law", .optional = true}, law);
}

// How every sensor of a structure takes part in a mode.
void IdentifyOutcome::visit_shapes(ResultVisitor& visitor) const {
  if (!record || record->names.empty()) return;
  std::vector<std::pair<std::size_t, std::size_t>> places;  // of a mode and a sensor
  for (std::size_t n = 0; n < found.modes.size(); ++n) {
    for (std::size_t k = 0; k < record->names.size(); ++k) places.emplace_back(n, k);
  }
  visitor.rows(
      {.key = "shapes",
       .table = "shapes",
       .name = "Amplitudes",
       .meaning = "Of every mode in every sensor where the decay begins, in the sensor's SI unit: "
                  "the ratios between the sensors are the mode's shape there."},
      places, [&](ResultVisitor& row, const std::pair<std::size_t, std::size_t>& place) {
        const auto& [number, mode] = found.modes[place.first];
        const std::complex<double> amplitude = mode.amplitude[place.second];
        row({.key = "n", .name = "mode"}, number);
        row({.key = "channel"}, record->names[place.second]);
        row({.key = "amplitude"}, std::abs(amplitude));
        row({.key = "phase_rad", .name = "phase", .unit = "rad"}, std::arg(amplitude));
      });
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

namespace {

// Modes that are heard and have no number.
std::string others_text(const std::vector<DecayMode>& others) {
  std::vector<std::string> texts;
  for (const DecayMode& mode : others) {
    texts.push_back(
        fmt::format("{:.6g} Hz (zeta {:.2g})", mode.pole.frequency, mode.pole.damping_ratio));
  }
  return fmt::format(
      "the record has modes that are none of the string's numbers: {}. They are of a body, of "
      "another "
      "string, or of a plane in which this one is tuned apart; they are fitted with the others and "
      "not listed",
      fmt::join(texts, ", "));
}

std::string seconds_text(const std::vector<PluckedMode>& seconds) {
  std::vector<std::string> texts;
  for (const auto& [number, mode] : seconds) {
    texts.push_back(fmt::format("{} ({:.6g} Hz, zeta {:.2g})", number, mode.pole.frequency,
                                mode.pole.damping_ratio));
  }
  return fmt::format(
      "modes have a second pole, as where the string moves in two planes: {}. The larger of the "
      "two is listed; the deviations of the other modes hold that they may have one, too. Pluck "
      "towards the sensor",
      fmt::join(texts, ", "));
}

// The largest amplitude of each channel: sensors of several kinds have units of their own.
std::vector<double> scales_of(const std::vector<PluckedMode>& modes) {
  std::vector<double> scales;
  for (const PluckedMode& plucked : modes) {
    scales.resize(plucked.mode.amplitude.size(), 0.0);
    for (std::size_t c = 0; c < scales.size(); ++c) {
      scales[c] = std::max(scales[c], std::abs(plucked.mode.amplitude[c]));
    }
  }
  return scales;
}

// How alike two modes move the sensors, 1 where one shape is a multiple of the other (modal
// assurance criterion; Allemang and Brown, 1982).
double likeness(const DecayMode& a, const DecayMode& b, const std::vector<double>& scales) {
  std::complex<double> product;
  double one = 0.0, other = 0.0;
  for (std::size_t c = 0; c < scales.size(); ++c) {
    if (scales[c] == 0.0) continue;
    const std::complex<double> first = a.amplitude[c] / scales[c];
    const std::complex<double> second = b.amplitude[c] / scales[c];
    product += std::conj(first) * second;
    one += std::norm(first);
    other += std::norm(second);
  }
  return std::norm(product) / (one * other);
}

// Two modes of a structure at one place differ in shape. A mode that changes with its amplitude is
// fitted by several poles of one shape, beside each other and damped by multiples.
std::vector<std::string> alike_in(const std::vector<PluckedMode>& modes) {
  std::vector<std::string> alike;
  const std::vector<double> scales = scales_of(modes);
  for (std::size_t i = 1; i < modes.size(); ++i) {
    const DecayMode &below = modes[i - 1].mode, &above = modes[i].mode;
    const double reach = 3.0 * (below.pole.damping_ratio + above.pole.damping_ratio);
    const bool is_near = above.pole.frequency - below.pole.frequency < reach * below.pole.frequency;
    if (!is_near || below.amplitude.size() < 2) continue;
    if (likeness(below, above, scales) < (below.amplitude.size() > 2 ? kOneShape : kOneShapeOfTwo))
      continue;
    alike.push_back(
        fmt::format("{:.6g} and {:.6g} Hz", below.pole.frequency, above.pole.frequency));
  }
  return alike;
}

std::vector<std::string> undamped_in(const std::vector<PluckedMode>& modes) {
  std::vector<std::string> undamped;
  for (const auto& [number, mode] : modes) {
    if (mode.pole.damping_ratio > 3.0 * mode.deviation.damping_ratio) continue;
    undamped.push_back(fmt::format("{:.5g} Hz", mode.pole.frequency));
  }
  return undamped;
}

void doubt_modes(const std::vector<PluckedMode>& modes, std::vector<std::string>& warnings) {
  if (const auto alike = alike_in(modes); !alike.empty()) {
    warnings.push_back(fmt::format(
        "modes at one place have one shape: {}. One of which frequency or damping changes with the "
        "amplitude looks like this; take a later part of the decay (structure.record.start), or "
        "excite it less",
        fmt::join(alike, ", ")));
  }
  if (const auto undamped = undamped_in(modes); !undamped.empty()) {
    warnings.push_back(
        fmt::format("no decay is told of the modes at {}: their damping ratios lie within three "
                    "deviations of 0, and they may be noise, or something steady",
                    fmt::join(undamped, ", ")));
  }
}

}  // namespace

std::string doubt_decay(const PluckIdentification& found, const PluckedRecord& record,
                        double fundamental, const std::optional<StiffStringFit>& law,
                        std::vector<std::string>& warnings) {
  if (!found.others.empty()) warnings.push_back(others_text(found.others));
  if (!found.seconds.empty()) warnings.push_back(seconds_text(found.seconds));
  if (std::isnan(fundamental)) doubt_modes(found.modes, warnings);
  const std::vector<double> shares = shares_left(found, record.decay);
  for (std::size_t k = 0; k < shares.size() && !record.names.empty(); ++k) {
    if (shares[k] < 0.5) continue;
    warnings.push_back(fmt::format("the modes leave {:.0f} % of {}, which tells little of them",
                                   100.0 * shares[k], record.names[k]));
  }
  return rejection_of(found, record, fundamental, law);
}

}  // namespace modcal
