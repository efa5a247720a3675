#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "experiments/kinds/calibrate/calibrate.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

constexpr std::size_t kPairsShown = 6;

std::string condition_text(const NamedCovariance& covariance) {
  const std::vector<double> values = covariance.singular_values();
  if (values.empty()) return "";
  return fmt::format("singular values in standard deviations {:.3g} to {:.3g}, condition {:.3g}\n",
                     values.front(), values.back(), covariance.condition());
}

std::string verdict_lines(const ContinuationResult& found) {
  std::string text =
      fmt::format("{}\nsd: f0 {:.3g} Hz, B {:.3g}, x_c {:.3g} m, damping factor {:.3g}\n",
                  chi2_text(found), found.found_law.deviation[0], found.found_law.deviation[1],
                  found.contact_deviation, found.damping_deviation);
  if (!found.lines.empty()) {
    text += fmt::format("hum of the mains at {:.3f} Hz: {} lines are free in either reaction\n",
                        found.lines.front(), found.lines.size());
  }
  if (found.tells_of_law()) text += prior_lines(found.law.priors, "law");
  if (found.frequencies_free) text += prior_lines(found.priors, "every frequency");
  for (std::size_t n = 0; found.frequencies_free && n < found.modes.size(); ++n) {
    const ModeVerdict& mode = found.modes[n];
    if (mode.source == ModeSource::kIdentified && mode.tie == LawTie::kFollows) continue;
    text +=
        fmt::format("mode {}: {}, relative sd {:.2g}\n", n + 1, verdict_text(mode), mode.deviation);
  }
  return text;
}

// Of B, the one parameter without unit that may be zero, rounding leaves 1e-20.
std::string value_text(const std::string& unit, double value) {
  return fmt::format("{:.8g}", unit == "1" ? without_rounding(value) : value);
}

std::string stroke_lines(const CalibrationOutcome& outcome) {
  std::string text;
  if (!outcome.result.continuation) return text;
  const std::vector<double>& deviations = outcome.result.continuation->contact_deviations;
  std::size_t stroke = 0;
  for (const CalibratedParameter& parameter : outcome.result.parameters) {
    if (deviations.size() < 2 || !parameter.name.starts_with("x_c")) continue;
    text += fmt::format("stroke {}: x_c {:.6g} m, sd {:.3g} m\n", stroke + 1, parameter.final,
                        deviations[stroke]);
    ++stroke;
  }
  return text;
}

}  // namespace

std::string verdict_text(const ModeVerdict& mode) {
  std::string text(name_of(mode.source));
  if (mode.tie == LawTie::kLeaves) {
    text += fmt::format(", leaves the law by {:+.3g} %", 100.0 * mode.departure);
  } else if (mode.source == ModeSource::kIdentified && mode.deviation < 0.5 * mode.data_deviation) {
    text += ", drawn to the law";
  }
  if (mode.reason != WeakReason::kNone) text += fmt::format(" ({})", name_of(mode.reason));
  return text;
}

std::string prior_lines(const PriorMisfit& misfit, std::string_view stage) {
  if (misfit.count == 0) return "";
  const std::string verdict = misfit.contradicted() ? "THE PRIORS ARE CONTRADICTED BY THE DATA"
                                                    : "the data do not contradict the priors";
  return fmt::format("{}: prior chi2 {:.4g} of {}: {}; farthest: {} by {:.3g} deviations\n", stage,
                     misfit.chi2, misfit.count, verdict, misfit.farthest, misfit.deviations);
}

// How the noise that the fit left is not that of two independent white ones.
std::string noise_text(const NoiseSpectrum& noise) {
  if (noise.white()) return "";
  double coherence = 0.0;
  for (const auto& [frequency, knot] : noise.knots) {
    coherence = std::max(coherence, std::abs(knot.mixed) / std::sqrt(knot.left * knot.right));
  }
  const NoiseCovariance &low = noise.knots.front().noise, &high = noise.knots.back().noise;
  return fmt::format(
      "\nnoise at x = 0 and x = L, by what the fit leaves: {:.3g} and {:.3g} times that read above "
      "the modes at {:.3g} Hz, {:.3g} and {:.3g} at {:.3g} Hz; coherence up to {:.2g}",
      std::sqrt(low.left), std::sqrt(low.right), noise.knots.front().frequency,
      std::sqrt(high.left), std::sqrt(high.right), noise.knots.back().frequency, coherence);
}

std::string chi2_text(const ContinuationResult& found) {
  std::string text = fmt::format(
      "reduced chi2 {:.4f} (sd {:.4f}): {}; law alone {:.4f}: {}", found.chi2, found.chi2_deviation,
      found.fits ? "the data do not contradict the fit" : "THE FIT IS WRONG", found.law.chi2,
      found.law_holds()                 ? "all modes follow it"
      : found.law.priors.contradicted() ? "its sensors contradict the priors"
                                        : "some modes leave it");
  text += noise_text(found.noise_spectrum);
  if (found.chi2 < 1.0 - 3.0 * found.chi2_deviation) {
    text += fmt::format(
        "\nnoise overstated: the data scatter less than the noise levels say; standard deviations "
        "are too wide by a factor of {:.3g}",
        1.0 / std::sqrt(found.chi2));
  }
  return text;
}

std::vector<CorrelatedPair> tightest_pairs(const ContinuationResult& found) {
  std::vector<bool> told(found.covariance.size(), true);
  for (std::size_t n = 0; found.frequencies_free && n < found.modes.size(); ++n) {
    const auto place = found.covariance.find(fmt::format("f_{}", n + 1));
    if (place) told[*place] = found.modes[n].source == ModeSource::kIdentified;
  }
  return strongest_correlations(found.covariance, told, kPairsShown);
}

std::string covariance_text(const ContinuationResult& found) {
  std::string text;
  if (found.tells_of_law()) {
    text = fmt::format("stiff-string law{}:\n", found.frequencies_free ? ", fitted alone" : "") +
           correlation_lines(found.law.covariance) + "  " + condition_text(found.law.covariance);
  }
  if (!found.frequencies_free) return text;
  text += "every frequency free, strongest correlations:";
  for (const CorrelatedPair& pair : tightest_pairs(found)) {
    const auto& names = found.covariance.names;
    text += fmt::format("{}{} with {}", text.back() == ':' ? " " : ", ", names[pair.second],
                        names[pair.first]);
    text += fmt::format(" {:+.2f}", pair.correlation);
  }
  return text + "\n  " + condition_text(found.covariance);
}

std::vector<double> frequency_errors(const CalibrationOutcome& outcome, bool initial) {
  std::vector<double> errors;
  for (const CalibratedMode& mode : outcome.result.modes) {
    if (!mode.excited || outcome.true_frequencies.empty()) continue;
    const double truth = outcome.true_frequencies[mode.number - 1];
    errors.push_back(std::abs((initial ? mode.initial_frequency : mode.frequency) / truth - 1.0));
  }
  return errors;
}

double median_relative_error(const CalibrationOutcome& outcome) {
  return quantile(frequency_errors(outcome), 0.5);
}

void add_calibration_summary(const CalibrationOutcome& outcome, StudyResult& result) {
  const OptimizationResult& search = outcome.result.search;
  // A continuation starts on another record than it ends on: its first value says nothing.
  const std::string values =
      outcome.result.continuation
          ? fmt::format("reduced chi2 {:.6g}", search.value)
          : fmt::format("objective {:.6g} -> {:.6g}", search.initial_value, search.value);
  result.summary += fmt::format("{} evaluations, {} loops, {:.3f} s; {}; {}\n", search.evaluations,
                                search.loops, search.seconds, values, explain(search.stop));
  if (search.left_out() > 0) {
    result.summary += fmt::format("{} of {} searches of a parameter left out, it had settled\n",
                                  search.left_out(), search.loops * search.searched.front());
  }
  if (!outcome.true_frequencies.empty()) {
    result.summary += fmt::format("median relative frequency error of the excited modes: {:.3g}\n",
                                  median_relative_error(outcome));
  }
  for (const CalibratedParameter& parameter : outcome.result.parameters) {
    result.parameters.push_back(
        {parameter.name, parameter.final, parameter.deviation, parameter.unit, parameter.initial});
    // Of every mode: those stand in the tables.
    if (parameter.name.starts_with("f_") || parameter.name.starts_with("zeta_")) continue;
    result.summary += fmt::format(
        "{}: {} -> {}{}", parameter.name, value_text(parameter.unit, parameter.initial),
        std::isnan(parameter.deviation) ? value_text(parameter.unit, parameter.final)
                                        : to_deviation(parameter.final, 0.1 * parameter.deviation),
        parameter.unit == "1" ? "" : " " + parameter.unit);
    result.summary +=
        std::isnan(parameter.deviation) ? "\n" : fmt::format(", sd {:.3g}\n", parameter.deviation);
  }
  if (outcome.result.continuation) {
    result.summary += verdict_lines(*outcome.result.continuation) + cause_lines(outcome.result);
  }
  result.summary += stroke_lines(outcome);
  if (outcome.law) {
    result.summary += fmt::format(
        "stiff-string law: f0 = {:.6g} Hz, B = {}\n", outcome.law->fundamental,
        inharmonicity_text(outcome.law->inharmonicity, outcome.law->inharmonicity_deviation));
  }
}

std::string unknown_values(const ContinuationResult& found) {
  constexpr std::size_t kNamed = 3;
  std::vector<std::string> names = found.covariance.unknown();
  const auto add = [&names](const char* name, double deviation) {
    if (std::isnan(deviation) && !std::ranges::count(names, name)) names.emplace_back(name);
  };
  add("f0", found.found_law.deviation[0]);
  add("B", found.found_law.deviation[1]);
  add("x_c", found.contact_deviation);
  if (names.size() > kNamed) {
    names[kNamed - 1] = fmt::format("{} more", names.size() - kNamed + 1);
    names.resize(kNamed);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

void reject_calibration(const std::string& reason, StudyResult& result) {
  if (result.answer.empty()) result.answer = reason;
  result.warn(reason);
  result.failed_tasks = 1;
  result.status = report::Status::kFailed;
}

void add_calibration_warnings(const CalibrationOutcome& outcome, StudyResult& result) {
  std::vector<std::string> bound;
  for (const CalibratedParameter& parameter : outcome.result.parameters) {
    if (parameter.at_bound) bound.push_back(parameter.name);
  }
  if (!bound.empty()) {
    result.warn(
        fmt::format("{} ended on a bound: the optimum may lie beyond", fmt::join(bound, ", ")));
  }
  if (!outcome.result.blind.empty()) {
    result.warn(fmt::format(
        "{} cannot be seen from this contact point and {}", fmt::join(outcome.result.blind, ", "),
        outcome.law ? "come from the stiff-string law" : "keep their initial values"));
  }
  const auto fail = [&result](const std::string& text) { reject_calibration(text, result); };
  if (const auto& found = outcome.result.continuation) {
    if (!found->right) fail(contradiction(outcome.result));
    if (const std::string held = held_back(outcome.result); !held.empty()) fail(held);
    if (const auto unknown = unknown_values(*found); !unknown.empty()) {
      fail(fmt::format(
          "what the record tells of {} is not known: record for longer, or with less noise",
          unknown));
    }
    return;
  }
  const StopReason stop = outcome.result.search.stop;
  if (stop == StopReason::kEvaluationBudget || stop == StopReason::kTimeBudget) {
    constexpr std::string_view kRemedy = "raise calibration.budget";
    const OptimizationResult& search = outcome.result.search;
    // Stages have records of their own: before the last one a value tells nothing of the whole.
    if (std::isnan(search.initial_value) || !std::isfinite(search.value)) {
      return fail(
          fmt::format("the search was cut by its budget before it found anything: {}", kRemedy));
    }
    result.warn(
        fmt::format("the search was cut by its budget: a better point may lie beyond; {}, or take "
                    "another optimizer",
                    kRemedy));
    result.answer = "Cut by its budget: " + calibration_answer(outcome);
  }
  if (stop == StopReason::kNotFinite || stop == StopReason::kNoProgress ||
      stop == StopReason::kNotRun) {
    fail("the search failed: " + std::string(explain(stop)));
  }
}

std::string shown_unit(const std::string& parameter) {
  const std::optional<ParameterName> name = parse_parameter(parameter);
  if (name == ParameterName{.kind = ParameterKind::kDampingFactor}) return "(factor)";
  const std::string unit(unit_of_parameter(parameter));
  return unit == "1" ? "" : unit;
}

std::string correlations_with(const std::vector<std::string>& names,
                              const std::vector<double>& correlations) {
  std::string text = "correlations";
  for (std::size_t j = 0; j < correlations.size(); ++j) {
    text += fmt::format(" {} {:+.2f}", names[j], correlations[j]);
  }
  return text;
}

std::string correlation_lines(const NamedCovariance& covariance) {
  std::size_t width = 8;
  for (const std::string& name : covariance.names) width = std::max(width, name.size());
  const Eigen::MatrixXd correlations = covariance.correlations();
  std::string text;
  for (std::size_t i = 0; i < covariance.size(); ++i) {
    std::vector<double> before;
    for (std::size_t j = 0; j < i; ++j) {
      before.push_back(correlations(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
    }
    text += fmt::format("  {:<{}} sd {:<9.3g} {:<9} {}\n", covariance.names[i], width,
                        covariance.deviation(i), shown_unit(covariance.names[i]),
                        correlations_with(covariance.names, before));
  }
  return text;
}

}  // namespace modcal
