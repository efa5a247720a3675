// What a record has that the model has not: in lines of text, and described once for tables and
// JSON.

#include <fmt/ranges.h>

#include <cmath>

#include "experiments/kinds/calibrate/calibrate.hpp"
#include "libcalib/identifiability/joint_report.hpp"

namespace modcal {
namespace {

// "second polarization (detuned by +0.08 %)".
std::string whole_name(const ScoreTest& test) {
  return test.detail.empty() ? test.cause : fmt::format("{} ({})", test.cause, test.detail);
}

std::string chance(const ScoreTest& test) {
  constexpr double kLeast = -700.0;  // ln of what a number still holds
  return test.log_p < kLeast ? "below 1e-300" : fmt::format("{:.1g}", std::exp(test.log_p));
}

// What was found of sensors and damping that is not what was stated: more than four deviations,
// one of 16 000 by chance.
std::string departures(const CalibrationResult& result) {
  constexpr double kFar = 4.0;
  std::string text;
  std::size_t ratios = 0, far_ratios = 0;
  for (const CalibratedParameter& one : result.parameters) {
    const auto name = parse_parameter(one.name);
    const double off = std::abs(one.final - one.initial) / one.deviation;
    if (name && name->kind == ParameterKind::kDampingRatio) {
      ++ratios;
      if (off > kFar) ++far_ratios;
    }
    if (!name || name->kind != ParameterKind::kSensor || !(off > kFar)) continue;
    text += fmt::format(
        "the sensors differ in {}: {:.6g}{}{}, {:.3g} deviations from what was stated\n", one.name,
        one.final, one.unit == "1" ? "" : " ", one.unit == "1" ? "" : one.unit, off);
  }
  if (far_ratios > 0) {
    text += fmt::format(
        "the damping is not as stated: {} of {} damping ratios by more than four deviations\n",
        far_ratios, ratios);
  }
  return text;
}

std::string role(const ScoreTest& test) {
  if (!test.named()) return "not seen";
  return test.refuses() ? "contradicts the fit" : "seen, held by the deviations";
}

// A cause that a fit before this one named: of this fit it says nothing more.
void visit_freed(ResultVisitor& row, const ScoreTest& test) {
  row({.key = "cause"}, test.cause);
  row({.key = "detail", .name = "of those tried the likeliest"}, test.detail);
  row({.key = "statistic", .name = "S", .format = "{:.4g}"}, test.statistic);
  row({.key = "degrees", .name = "of"}, test.degrees);
  row({.key = "chance", .shown = ResultVisitor::kInTables}, chance(test));
  row({.key = "log_p", .shown = ResultVisitor::kInJson}, test.log_p);
  row({.key = "amplitude", .format = "{:.2e}"}, test.amplitude);
}

void visit_cause(ResultVisitor& row, const ScoreTest& test) {
  visit_freed(row, test);
  row({.key = "shift", .name = "would move, in its sd", .format = "{:.2f}"}, test.shift);
  row({.key = "unknown", .name = "most"}, test.unknown);
  row({.key = "shift_per_root", .name = "shift/√S", .format = "{:.2f}"}, test.shift_per_root);
  row({.key = "named", .shown = ResultVisitor::kInJson}, test.named());
  row({.key = "refuses", .shown = ResultVisitor::kInJson}, test.refuses());
  row({.key = "verdict", .shown = ResultVisitor::kInTables}, role(test));
}

void visit_noise(ResultVisitor& row, const NoiseSpectrum::Knot& knot) {
  row({.key = "frequency_hz", .name = "frequency", .unit = "Hz", .format = "{:.4g}"},
      knot.frequency);
  row({.key = "left_power", .name = "power at x = 0", .format = "{:.3g}"}, knot.noise.left);
  row({.key = "right_power", .name = "power at x = L", .format = "{:.3g}"}, knot.noise.right);
  row({.key = "coherence", .format = "{:.2f}"},
      knot.noise.mixed / std::sqrt(knot.noise.left * knot.noise.right));
}

std::string freed_line(const ScoreTest& freed) {
  if (freed.cause == kBridge) {
    return fmt::format("{} was found and taken out of the record; f_n and zeta_n are on it\n",
                       whole_name(freed));
  }
  return fmt::format("{} of {:.3g} (sd {:.2g}) was found and is free in the fit\n",
                     whole_name(freed), freed.amplitude,
                     std::abs(freed.amplitude) / std::sqrt(freed.statistic));
}

}  // namespace

std::string cause_lines(const CalibrationResult& result) {
  const ContinuationResult& found = *result.continuation;
  std::string text = found.tests.empty() ? "" : departures(result);
  for (const ScoreTest& freed : found.freed) {
    text += freed_line(freed);
  }
  for (const ScoreTest& test : found.tests) {
    if (!test.named()) continue;
    text +=
        fmt::format("what the fit leaves has the shape of: {}: S {:.4g} of {}, by chance {}: {}\n",
                    whole_name(test), test.statistic, test.degrees, chance(test), role(test));
  }
  if (!found.tests.empty() && !first_cause(found.tests)) {
    std::vector<std::string_view> looked_for;
    for (const ScoreTest& test : found.tests) looked_for.push_back(test.cause);
    text += fmt::format("no sign of: {}\n", fmt::join(looked_for, ", "));
  }
  return text;
}

std::string cause_contradiction(const ContinuationResult& found) {
  const ScoreTest* cause = first_cause(found.tests);
  const bool refuses = cause && cause->refuses();
  if (found.fits && !refuses) return "";
  if (!found.frequencies_free) return "free all frequencies (frequencies: all) to learn why";
  if (found.tests.empty()) return "";
  if (!cause) {
    return "none of the causes that are looked for explains it: the report shows at which "
           "frequencies it is; end the band below them (objective: {type: joint_likelihood, "
           "highest_frequency: ...}), or take a part of the record that is played steadily";
  }
  return fmt::format("what the fit leaves has the shape of: {} (by chance {}){}: {}",
                     whole_name(*cause), chance(*cause),
                     refuses ? ", which the error bars do not hold" : "", cause->remedy());
}

void visit_causes(ResultVisitor& visitor, const ContinuationResult& found) {
  if (!found.noise_spectrum.white()) {
    visitor.rows(
        {.key = "noise_spectrum",
         .table = "noise",
         .name = "Noise of both reactions",
         .meaning = "Power over that of the white noise stated above, and the coherence, by "
                    "what the fit leaves; linear in ln f between the frequencies."},
        found.noise_spectrum.knots, visit_noise);
  }
  if (found.tests.empty()) return;
  visitor.rows({.key = "causes",
                .table = "causes",
                .name = "What would explain the misfit",
                .meaning = "Score tests of what the fit leaves. S is chi2 of so many degrees where "
                           "the cause is not in the record; a cause whose shift/√S is large moves "
                           "the answers before a test can see it."},
               found.tests, visit_cause);
  visitor.rows({.key = "residual", .shown = ResultVisitor::kInJson}, found.local.bands,
               [](ResultVisitor& row, const MisfitBand& band) {
                 row({.key = "frequency_hz"}, band.frequency);
                 row({.key = "chi2"}, band.chi2);
                 row({.key = "bins"}, band.bins);
               });
  visitor.rows({.key = "freed_causes", .shown = ResultVisitor::kInJson}, found.freed, visit_freed);
}

report::Figure misfit_figure(const ContinuationResult& found) {
  constexpr double kTwoSided = 1.96;  // deviations of 95 %
  report::Figure figure{.id = "misfit",
                        .title = "What the fit leaves",
                        .caption =
                            "Mean power of the residual in bands, 1 where it is noise as "
                            "stated or read; dotted lines: the modes."};
  if (found.local.bands.empty()) return figure;
  report::Panel panel;
  panel.x = {.label = "frequency", .unit = "Hz"};
  panel.y = {.label = "residual power over noise"};
  report::Series noise{.label = "noise alone, 95 %",
                       .style = report::SeriesStyle::kLine,
                       .color = report::ColorRole::kMuted};
  report::Series left{.label = "residual", .style = report::SeriesStyle::kLineWithPoints};
  for (const MisfitBand& band : found.local.bands) {
    const double spread = kTwoSided * band.deviation();
    noise.add(band.frequency, 1.0, 1.0 - spread, 1.0 + spread);
    left.add(band.frequency, band.chi2);
  }
  panel.series = {std::move(noise), std::move(left)};
  for (const MisfitBand& mode : found.local.modes) {
    panel.markers.push_back({.value = mode.frequency, .color = report::ColorRole::kMuted});
  }
  figure.panels.push_back(std::move(panel));
  return figure;
}

namespace {

// A sensor that differs far more than sensors do is one whose calibration is wrong.
std::string_view remedy_of_prior(std::string_view farthest) {
  for (std::size_t i = 0; i < Sensor::kCount; ++i) {
    if (!farthest.starts_with(sensor_type(i).name)) continue;
    return ": check the gains of both sensors (record.left.calibration, "
           "record.right.calibration), or state what is known of them "
           "(calibration.parameters.priors)";
  }
  return "";
}

// A channel later than what is looked for. Its delay is on the bound then, and what is stated in
// the record is taken out beforehand.
std::string late_channel(const CalibrationResult& result) {
  for (const CalibratedParameter& one : result.parameters) {
    if (one.name != sensor_type(Sensor::kDelay).name || !one.at_bound) continue;
    return fmt::format(
        "the channel at {} is later by {:.3g} us or more, on the bound of what is looked for: "
        "state record.{}.delay: {:.3g} us more than now and run again",
        one.final > 0.0 ? "x = L" : "x = 0", 1e6 * std::abs(one.final),
        one.final > 0.0 ? "right" : "left", 1e6 * std::abs(one.final));
  }
  return {};
}

// Waves that grow from sample to sample are those of a decay read from its end: the fit takes all
// damping that it may from most of the modes.
bool runs_backwards(const CalibrationResult& result) {
  std::size_t ratios = 0, lowest = 0;
  for (const CalibratedParameter& one : result.parameters) {
    const auto name = parse_parameter(one.name);
    if (!name || (name->kind != ParameterKind::kDampingRatio &&
                  name->kind != ParameterKind::kDampingFactor)) {
      continue;
    }
    ++ratios;
    if (one.at_bound && one.final < one.initial) ++lowest;
  }
  return 2 * lowest > ratios;
}

}  // namespace

std::string contradiction(const CalibrationResult& result) {
  const ContinuationResult& found = *result.continuation;
  std::vector<std::string> reasons;
  if (!found.fits) {
    reasons.push_back(
        fmt::format("the fit is wrong: reduced chi2 {:.4f}, where {:.4f} would scatter from 1",
                    found.chi2, found.chi2_deviation));
  }
  if (!found.fits && runs_backwards(result)) {
    reasons.emplace_back(
        "most damping ratios end at their lowest, as where the string gains energy: the rows stand "
        "in reverse (turn them around), or the damping stated is many times too large "
        "(string.damping)");
    return fmt::format("{}", fmt::join(reasons, "; "));
  }
  const std::string late = found.fits ? std::string() : late_channel(result);
  if (!late.empty()) {
    reasons.push_back(late);
    return fmt::format("{}", fmt::join(reasons, "; "));
  }
  if (found.priors.contradicted()) {
    reasons.push_back(fmt::format(
        "the data contradict the priors stated, that of {} most ({:.3g} deviations){}",
        found.priors.farthest, found.priors.deviations, remedy_of_prior(found.priors.farthest)));
  }
  if (found.contradicts_itself()) {
    reasons.push_back(fmt::format(
        "the modes found and the law found with them contradict each other ({:.3g} deviations), as "
        "where the search ends in a false minimum: state f0, B and bow.position nearer to where "
        "they are, or calibrate a longer part of the record",
        found.farthest_follower()));
  }
  if (const auto apart = tuned_apart(found.single)) {
    reasons.push_back(fmt::format(
        "stroke {} is tuned {:+.2g} % from the first, {:.3g} deviations of the two fits: the "
        "string "
        "changed between them; calibrate each by itself",
        apart->stroke + 1, 100.0 * apart->relative, std::abs(apart->relative) / apart->deviation));
  }
  const std::string cause = cause_contradiction(found);
  if (!cause.empty()) reasons.push_back(cause);
  return fmt::format("{}", fmt::join(reasons, "; "));
}

std::string held_back(const CalibrationResult& result) {
  for (const CalibratedParameter& one : result.parameters) {
    const auto name = parse_parameter(one.name);
    const double far = std::abs(one.final - one.initial) / one.deviation;
    if (!name || !one.at_bound || !(far > 3.0)) continue;
    if (name->kind != ParameterKind::kContact && name->kind != ParameterKind::kFundamental)
      continue;
    return fmt::format(
        "{} ended on the bound of its range, {:.6g} {}, {:.3g} deviations from its start: the "
        "string lies beyond; state it nearer to where it is, or a wider {}",
        one.name, one.final, one.unit, far, type_of(*name).range_option.key);
  }
  return {};
}

}  // namespace modcal
