#include <nlohmann/json.hpp>

#include "experiments/kinds/limit/limit.hpp"
#include "libcalib/likelihood/records/noise_level.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

ExpectedLimit limit_at(const LimitQuestion& question, double contact, TruthCache& truths) {
  LimitQuestion there = question;
  there.observation.truth.scene.bow.position = contact;
  return expected_limit(limit_case(there, truths));
}

// Of the column of names.
std::size_t name_width(const ExpectedLimit& limit) {
  std::size_t width = 8;
  for (const ParameterLimit& row : limit.parameters) {
    width = std::max(width, row.parameter.size());
  }
  return width;
}

std::string law_lines(const ExpectedLimit& limit) {
  std::string text =
      "stiff-string law, all modes on it (in brackets: what an unknown force leaves):\n";
  std::vector<std::string> names;
  for (const ParameterLimit& row : limit.parameters) {
    if (std::isnan(row.law)) continue;
    text += fmt::format("  {:<{}} sd {:.3g} ({:.3g}) {:<9} {}\n", row.parameter, name_width(limit),
                        row.law, row.attainable, shown_unit(row.parameter),
                        correlations_with(names, row.correlations));
    names.push_back(row.parameter);
  }
  return text;
}

// All but x_c of the first stroke and the damping factor, and the damping ratios, which stand with
// their modes.
std::string free_lines(const ExpectedLimit& limit) {
  std::string text;
  for (const ParameterLimit& row : limit.parameters) {
    const std::optional<ParameterName> name = parse_parameter(row.parameter);
    const bool elsewhere = name == ParameterName{.kind = ParameterKind::kContact} ||
                           name == ParameterName{.kind = ParameterKind::kDampingFactor} ||
                           (name && name->kind == ParameterKind::kDampingRatio);
    if (elsewhere || std::isnan(row.free)) continue;
    const std::string unit = shown_unit(row.parameter);
    text += fmt::format("  {:<{}} sd {:.3g}{}{}\n", row.parameter, name_width(limit), row.free,
                        unit.empty() ? "" : " ", unit);
  }
  return text;
}

std::string singular_values(const ExpectedLimit& limit) {
  std::string text = "singular values of the frequencies' information:";
  for (std::size_t i = 0; i < limit.singular_values.size(); ++i) {
    text += fmt::format("{}{:<9.3g}", i % 10 == 0 ? "\n  " : " ", limit.singular_values[i]);
  }
  return text + "\n";
}

std::string mode_lines(const ExpectedLimit& limit) {
  std::vector<std::string> known;
  if (limit.find("x_c")) known.push_back(fmt::format("of x_c {:.3g} m", limit.contact));
  if (limit.find("damping")) {
    known.push_back(fmt::format("of the damping factor {:.3g}", limit.damping));
  }
  std::string text = "every frequency free";
  if (!known.empty()) text += fmt::format(": sd {}", fmt::join(known, ", "));
  const bool ratios =
      std::any_of(limit.parameters.begin(), limit.parameters.end(),
                  [](const ParameterLimit& row) { return row.parameter.starts_with("zeta_"); });
  text += fmt::format("\n{}{}", free_lines(limit), singular_values(limit));
  text += fmt::format("  n  f [Hz]      relative sd  {}verdict\n", ratios ? "sd of zeta  " : "");
  for (std::size_t n = 0; n < limit.modes.size(); ++n) {
    const ModeVerdict& mode = limit.modes[n];
    text += fmt::format("{:>3}  {:<10.3f}  {:<11.2e}  ", n + 1, mode.frequency, mode.deviation);
    const ParameterLimit* ratio = limit.find(fmt::format("zeta_{}", n + 1));
    if (ratios) text += fmt::format("{:<10.2e}  ", ratio ? ratio->free : 0.0);
    text += name_of(mode.source);
    if (mode.reason != WeakReason::kNone) text += fmt::format(" ({})", name_of(mode.reason));
    text += "\n";
  }
  return text;
}

std::string record_lines(const LimitQuestion& question, const LimitCase& records) {
  const auto length = [](const NoisyRecords& record) {
    return fmt::format("{:g} s at {:g} Hz",
                       static_cast<double>(record.samples()) / record.sample_rate,
                       record.sample_rate);
  };
  std::string text =
      fmt::format("noise {:g} % of each reaction, {}, x_c = {:g} m\n", 100.0 * question.noise_level,
                  length(records.strokes[0]), records.contacts[0]);
  for (std::size_t r = 1; r < records.strokes.size(); ++r) {
    text += fmt::format("stroke {}: x_c = {:g} m\n", r + 1, records.contacts[r]);
  }
  for (std::size_t r = 0; r < records.plucks.size(); ++r) {
    text +=
        fmt::format("pluck {}: noise {:g} % of each reaction, {}\n", r + 1,
                    100.0 * question.plucks[r].measurement.noise_level, length(records.plucks[r]));
  }
  return text;
}

std::string proposals(const LimitQuestion& question, const ExpectedLimit& limit,
                      const ModelPoint& point, TruthCache& truths) {
  if (limit.blind_modes == 0) {
    const bool one = question.further_contacts.empty() && question.plucks.empty();
    return one ? "no mode is blind at this contact point\n" : "no mode is blind to all records\n";
  }
  const bool one = question.further_contacts.empty();
  std::string text = fmt::format("{} modes are not identified; contact points nearby{}:\n",
                                 limit.blind_modes, one ? "" : " for the first stroke");
  bool any = false;
  for (const double contact :
       contacts_without_blind_modes(point, 0.02 * point.basis.length, 0.1, 4)) {
    try {
      const ExpectedLimit there = limit_at(question, contact, truths);
      if (there.blind_modes >= limit.blind_modes) continue;
      text += fmt::format("  x_c = {:.5g} m (L/{:.2f}): {} not identified, sd of x_c {:.3g} m\n",
                          contact, point.basis.length / contact, there.blind_modes, there.contact);
      any = true;
    } catch (const InvalidInput& error) {
      text += fmt::format("  x_c = {:.5g} m: cannot be simulated ({})\n", contact, error.what());
    }
  }
  if (!any) text += "  none within 2 % of the length is better: less noise is what helps\n";
  return text;
}

}  // namespace

LimitTruth limit_truth(const ObservationOptions& observation, double noise_level,
                       TruthCache& truths, OutputRequest outputs) {
  MODCAL_REQUIRE(observation.has_scene,
                 "a limit is computed from a simulated truth: state a scene, not a record");
  const double rate = observation.measurement.sample_rate;
  outputs.left_reaction = outputs.right_reaction = true;
  const auto truth = truths.get(observation.truth, rate, outputs);
  LimitTruth result{.point = {truth->basis, truth->contact}, .simulated = truth};
  result.records.sample_rate = rate;
  result.records.reactions = {truth->simulation.left_reaction.samples,
                              truth->simulation.right_reaction.samples};
  for (std::size_t r = 0; r < 2; ++r) {
    remove_mean(result.records.reactions[r]);
    MODCAL_REQUIRE(standard_deviation(result.records.reactions[r]) > 0.0,
                   "reaction {} of the scene is constant: nothing moves the string and no record "
                   "tells of it; bow it with a normal force > 0 or pluck it",
                   r + 1);
    result.records.deviation[r] =
        noise_level > 0.0
            ? noise_level * standard_deviation(result.records.reactions[r])
            : noise_deviation(result.records.reactions[r],
                              NoiseBand::above(truth->basis, rate, result.records.samples()));
  }
  return result;
}

void LimitQuestion::calibrate_by(const CalibrationOptions& calibration) {
  const ParameterOptions& parameters = calibration.parameters;
  highest_frequency = calibration.objective.make()->highest_frequency();
  law_width = std::isnan(parameters.law_width) ? kLawWidth : parameters.law_width;
  unknowns = parameters.unknowns;
}

LimitCase limit_case(const LimitQuestion& question, TruthCache& truths, OutputRequest outputs) {
  LimitTruth first = limit_truth(question.observation, question.noise_level, truths, outputs);
  LimitCase result{.truth = first.point,
                   .strokes = {std::move(first.records)},
                   .contacts = {first.point.contact},
                   .plucks = {},
                   .highest_frequency = question.highest_frequency,
                   .law_width = question.law_width,
                   .unknowns = question.unknowns.of_simulations(first.point.basis)};
  result.truth.sensors.smooth = result.unknowns.sensors().smooth;
  for (const double contact : question.further_contacts) {
    ObservationOptions stroke = question.observation;
    stroke.truth.scene.bow.position = contact;
    result.strokes.push_back(limit_truth(stroke, question.noise_level, truths).records);
    result.contacts.push_back(contact);
  }
  for (const ObservationOptions& pluck : question.plucks) {
    result.plucks.push_back(limit_truth(pluck, pluck.measurement.noise_level, truths).records);
  }
  return result;
}

namespace {

LimitCase stated_case(const LimitQuestion& question, TruthCache& truths) {
  MODCAL_REQUIRE(question.observation.has_scene,
                 "a limit is computed from a simulated truth: state a scene, not a record");
  MODCAL_REQUIRE(
      question.noise_level > 0.0,
      "without noise there is no limit: state measurement.noise_level (noise_levels of a "
      "calibration_limit) > 0");
  return limit_case(question, truths);
}

}  // namespace

std::string limit_text(const LimitQuestion& question, TruthCache& truths) {
  const LimitCase records = stated_case(question, truths);
  const ExpectedLimit limit = expected_limit(records);
  return record_lines(question, records) + law_lines(limit) + mode_lines(limit) +
         proposals(question, limit, records.truth, truths);
}

nlohmann::ordered_json limit_json(const LimitQuestion& question, TruthCache& truths) {
  const ExpectedLimit limit = expected_limit(stated_case(question, truths));
  auto parameters = nlohmann::ordered_json::array(), modes = nlohmann::ordered_json::array();
  for (const ParameterLimit& row : limit.parameters) {
    parameters.push_back({{"name", row.parameter},
                          {"sd", row.law},
                          {"attainable_sd", row.attainable},
                          {"sd_with_free_frequencies", row.free},
                          {"correlations", row.correlations}});
  }
  for (const ModeVerdict& mode : limit.modes) {
    modes.push_back({{"frequency", mode.frequency},
                     {"relative_sd", mode.deviation},
                     {"verdict", name_of(mode.source)},
                     {"reason", name_of(mode.reason)}});
  }
  return {{"noise_level", question.noise_level},
          {"parameters", std::move(parameters)},
          {"modes", std::move(modes)},
          {"blind_modes", limit.blind_modes}};
}

}  // namespace modcal
