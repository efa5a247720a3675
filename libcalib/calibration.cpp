#include "libcalib/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/problem/covariance.hpp"
#include "libcalib/parameters/stiff_string_fit.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

struct Names {
  std::vector<std::string> free;
  std::vector<std::string> blind;
};

Names split_names(const CalibrationOptions& options, const std::vector<bool>& excited) {
  Names names;
  names.free = options.parameters.names(excited.size());
  for (std::size_t i = 0; i < excited.size(); ++i) {
    if (excited[i]) continue;
    const std::string name = fmt::format("f_{}", i + 1);
    if (std::erase(names.free, name) > 0) names.blind.push_back(name);
  }
  MODCAL_REQUIRE(!names.free.empty(),
                 "every parameter asked for is the frequency of a mode the contact does not excite "
                 "({}): nothing can be calibrated",
                 fmt::join(names.blind, ", "));
  return names;
}

std::vector<CalibratedParameter> report_parameters(const std::vector<Variable>& variables,
                                                   const std::vector<double>& x) {
  std::vector<CalibratedParameter> result;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Variable& variable = variables[i];
    result.push_back({.name = variable.name,
                      .unit = variable.unit,
                      .initial = variable.initial,
                      .final = x[i],
                      .at_bound = x[i] <= variable.lower || x[i] >= variable.upper});
  }
  return result;
}

bool at_optimum(StopReason stop) {
  return stop == StopReason::kConverged || stop == StopReason::kSmallStep ||
         stop == StopReason::kSmallDecrease || stop == StopReason::kRoundoff;
}

// Standard deviations of what was searched, where (JᵀJ)⁻¹ is the covariance.
void add_deviations(const Objective& objective, const ObjectiveFunction& function,
                    const std::vector<Variable>& variables, CalibrationResult& result) {
  const bool bounded =
      std::any_of(result.parameters.begin(), result.parameters.end(),
                  [](const CalibratedParameter& parameter) { return parameter.at_bound; });
  const bool known = objective.whitened() && function.capabilities().least_squares;
  if (!known || bounded || !at_optimum(result.search.stop)) return;
  const Covariance covariance = covariance_at(function, variables, result.search.x);
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    result.parameters[i].deviation = covariance.standard_deviation(i);
  }
}

std::vector<CalibratedMode> report_modes(const ParameterSet& parameters, const ModelPoint& model,
                                         const std::vector<bool>& excited) {
  const ModelPoint& initial = parameters.initial();
  const std::vector<double> shape = initial.basis.shape_at(initial.contact);
  std::vector<CalibratedMode> modes(excited.size());
  for (std::size_t i = 0; i < modes.size(); ++i) {
    modes[i] = {.number = i + 1,
                .initial_frequency = initial.basis.frequency(i),
                .frequency = model.basis.frequency(i),
                .shape = shape[i],
                .excited = excited[i]};
  }
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].kind == ParameterKind::kFrequency) modes[parameters[i].mode].searched = true;
  }
  return modes;
}

std::vector<double> frequencies_of(const ModalBasis& basis) {
  std::vector<double> frequencies;
  for (std::size_t n = 0; n < basis.size(); ++n) frequencies.push_back(basis.frequency(n));
  return frequencies;
}

// Sensors and damping of one record, `number` behind their names; damping: whether it is wanted.
void add_values(const RecordValues& values, const UnknownsOptions& unknowns,
                const std::string& number, bool all, std::vector<CalibratedParameter>& parameters) {
  const auto wanted = [&](bool free, UnknownKind kind) {
    return free && (all || unknowns.own(kind));
  };
  const auto add = [&](const char* name, const char* unit, double initial, double found,
                       double deviation) {
    parameters.push_back({.name = name + number,
                          .unit = unit,
                          .initial = initial,
                          .final = found,
                          .deviation = deviation});
  };
  const auto& sd = values.sensor_deviation;
  if (wanted(unknowns.damping != "fixed", UnknownKind::kDampingFactor)) {
    add("damping", "1", 1.0, values.damping, values.damping_deviation);
  }
  if (wanted(unknowns.gain.free, UnknownKind::kGain)) {
    add("gain", "1", unknowns.gain.value, values.sensors.gain, sd[0]);
  }
  if (wanted(unknowns.delay.free, UnknownKind::kDelay)) {
    add("delay", "s", unknowns.delay.value, values.sensors.delay, sd[1]);
  }
  if (wanted(unknowns.corner.free, UnknownKind::kCorner)) {
    add("corner", "Hz", unknowns.corner.value, 0.5 * values.sensors.corner / std::numbers::pi,
        sd[2]);
  }
}

// Every ζ_n that is free by itself, in the place of one factor; or the power of n.
void add_damping(const ModelPoint& initial, const ContinuationResult& found,
                 std::vector<CalibratedParameter>& parameters) {
  for (std::size_t n = 0; n < found.ratio_deviations.size(); ++n) {
    const double ratio = found.model.basis.zeta[n];
    if (found.ratio_deviations[n] == 0.0) continue;
    parameters.push_back({.name = fmt::format("zeta_{}", n + 1),
                          .unit = "1",
                          .initial = initial.basis.zeta[n],
                          .final = ratio,
                          .deviation = ratio * found.ratio_deviations[n]});
  }
  if (found.damping_power_deviation == 0.0) return;
  parameters.push_back({.name = "damping_power",
                        .unit = "1",
                        .initial = 0.0,
                        .final = found.damping_power,
                        .deviation = found.damping_power_deviation});
}

// Law, contacts, damping and sensors before and after; `records`: null for one stroke.
std::vector<CalibratedParameter> found_parameters(const ModelPoint& initial,
                                                  const ContinuationResult& found,
                                                  const RecordsFit* records,
                                                  const UnknownsOptions& unknowns) {
  const StiffStringFit start = fit_stiff_string(frequencies_of(initial.basis));
  const auto parameter = [](std::string name, const char* unit, double from, double to,
                            double deviation) {
    return CalibratedParameter{.name = std::move(name),
                               .unit = unit,
                               .initial = from,
                               .final = to,
                               .deviation = deviation};
  };
  std::vector<CalibratedParameter> parameters = {
      parameter("f0", "Hz", start.fundamental, found.law.fundamental, found.law.deviation[0]),
      parameter("B", "1", start.inharmonicity, found.law.inharmonicity, found.law.deviation[1]),
      parameter("x_c", "m", initial.contact, found.model.contact, found.contact_deviation)};
  add_values({.sensors = found.model.sensors,
              .sensor_deviation = found.sensor_deviation,
              .damping = found.damping,
              .damping_deviation = found.damping_deviation},
             unknowns, "", true, parameters);
  if (!found.ratio_deviations.empty()) {
    std::erase_if(parameters, [](const CalibratedParameter& p) { return p.name == "damping"; });
  }
  add_damping(initial, found, parameters);
  for (std::size_t r = 1; records && r < records->values.size(); ++r) {
    const std::string number = fmt::format(" {}", r + 1);
    if (r < records->contacts.size() && unknowns.own(UnknownKind::kContact)) {
      parameters.push_back(parameter("x_c" + number, "m", initial.contact, records->contacts[r],
                                     records->contact_deviations[r]));
    }
    add_values(records->values[r], unknowns, number, false, parameters);
  }
  return parameters;
}

std::vector<CalibratedMode> found_modes(const ModelPoint& initial, const ContinuationResult& found,
                                        double excitation_threshold) {
  const std::vector<bool> excited = excited_modes(found.model, excitation_threshold);
  const std::vector<double> shape = found.model.basis.shape_at(found.model.contact);
  std::vector<CalibratedMode> modes;
  for (std::size_t i = 0; i < found.modes.size(); ++i) {
    modes.push_back({.number = i + 1,
                     .initial_frequency = initial.basis.frequency(i),
                     .frequency = found.modes[i].frequency,
                     .shape = shape[i],
                     .excited = excited[i],
                     .searched = found.modes[i].source == ModeSource::kIdentified});
  }
  return modes;
}

// What the continuation found, in the form of a search.
CalibrationResult calibrate_to_the_bound(const ModelPoint& initial,
                                         std::span<const CalibrationData> records,
                                         std::span<const PluckRecord> plucks,
                                         const CalibrationOptions& options,
                                         const SecondsClock& clock) {
  require_continuation_parameters(options.parameters, records.size());
  const ParameterOptions& free = options.parameters;
  ContinuationOptions continuation = options.continuation;
  continuation.frequencies = free.frequencies == "all";
  if (!free.contact) continuation.unknowns.fixed.push_back({.parameter = "x_c"});
  const FitPoll poll = [&clock] { clock(); };
  const double begin = clock();
  CalibrationResult result;
  std::optional<RecordsFit> fit;
  if (records.size() == 1 && plucks.empty()) {
    result.continuation = calibrate_by_continuation(initial, records.front(), continuation, poll);
    result.contact_deviations = {result.continuation->contact_deviation};
  } else {
    fit = calibrate_records(initial, records, continuation, plucks, poll);
    result.continuation = as_continuation(*fit);
    result.contact_deviations = fit->contact_deviations;
  }
  const ContinuationResult& found = *result.continuation;
  result.search.seconds = clock() - begin;
  result.search.evaluations = static_cast<std::int64_t>(found.evaluations);
  result.search.value = found.chi2;
  result.search.stop = found.fits ? StopReason::kConverged : StopReason::kNoProgress;
  result.model = found.model;
  result.parameters =
      found_parameters(initial, found, fit ? &*fit : nullptr, continuation.unknowns);
  result.modes = found_modes(initial, found, options.excitation_threshold);
  return result;
}

}  // namespace

void CalibrationOptions::visit(OptionVisitor& visitor) {
  visitor.section({.key = "parameters", .meaning = "what is free", .required = true}, parameters);
  visitor.plugin({.key = "objective", .meaning = "what is minimized"}, objective);
  visitor.plugin({.key = "optimizer", .meaning = "how it is minimized"}, optimizer);
  visitor.section({.key = "budget", .meaning = "what the search may spend"}, budget);
  visitor.optional_group(
      {.key = "continuation",
       .meaning = "calibrate to the bound by the joint likelihood, in the place of objective, "
                  "optimizer and budget"},
      has_continuation, [this](OptionVisitor& members) { continuation.visit(members); });
  visitor.number({.key = "excitation_threshold",
                  .meaning = "modes with a smaller |phi_n(x_c)| are blind and keep their frequency",
                  .unit = "1",
                  .range = Range::closed(0.0, 1.0)},
                 excitation_threshold);
}

void require_continuation_parameters(const ParameterOptions& free, std::size_t strokes) {
  MODCAL_REQUIRE(free.law && free.frequencies != "listed",
                 "a continuation frees the law and no frequency or all of them: state parameters: "
                 "{{frequencies: all, law: true, contact: true}}, and what is known of single ones "
                 "under continuation: {{unknowns: {{fixed: ...}}}}");
  MODCAL_REQUIRE(free.contact || strokes == 1,
                 "contact: false holds the contact of one stroke, and there are {}: state contact: "
                 "true and the contacts that are known under continuation: {{unknowns: {{fixed: "
                 "...}}}}",
                 strokes);
  MODCAL_REQUIRE(free.damping == "fixed",
                 "a continuation does not read damping: {} here: state it under continuation: "
                 "{{unknowns: {{damping: {}}}}}",
                 free.damping, free.damping);
  MODCAL_REQUIRE(free.sensors.empty(),
                 "a continuation does not read sensors: [{}] here: state {}: {{free: true}} under "
                 "continuation: {{unknowns: ...}}",
                 fmt::join(free.sensors, ", "), free.sensors.front());
}

std::vector<bool> excited_modes(const ModelPoint& point, double threshold) {
  std::vector<bool> excited;
  for (const double shape : point.basis.shape_at(point.contact)) {
    excited.push_back(std::abs(shape) >= threshold);
  }
  return excited;
}

CalibrationResult calibrate(const ModelPoint& initial, const CalibrationData& data,
                            const CalibrationOptions& options, SecondsClock clock) {
  if (options.has_continuation) {
    return calibrate_to_the_bound(initial, std::span(&data, 1), {}, options, clock);
  }
  const std::vector<bool> excited = excited_modes(initial, options.excitation_threshold);
  Names names = split_names(options, excited);
  const ParameterSet parameters(initial, names.free, options.parameters.ranges);
  const auto objective = options.objective.make();
  const auto function = objective->bind(data, parameters);
  const std::vector<Variable> variables = parameters.variables();
  CalibrationResult result;
  result.search =
      options.optimizer.make()->minimize(*function, variables, options.budget, std::move(clock));
  result.blind = std::move(names.blind);
  result.model = parameters.model(result.search.x);
  result.parameters = report_parameters(variables, result.search.x);
  result.modes = report_modes(parameters, result.model, excited);
  add_deviations(*objective, *function, variables, result);
  return result;
}

CalibrationResult calibrate(const ModelPoint& initial, std::span<const CalibrationData> records,
                            const CalibrationOptions& options, SecondsClock clock) {
  return calibrate(initial, records, {}, options, std::move(clock));
}

CalibrationResult calibrate(const ModelPoint& initial, std::span<const CalibrationData> strokes,
                            std::span<const PluckRecord> plucks, const CalibrationOptions& options,
                            SecondsClock clock) {
  MODCAL_REQUIRE(!strokes.empty(), "a calibration needs at least {} stroke", 1);
  if (strokes.size() == 1 && plucks.empty()) {
    return calibrate(initial, strokes.front(), options, std::move(clock));
  }
  MODCAL_REQUIRE(options.has_continuation,
                 "{} records are fitted together by the joint likelihood alone: state "
                 "calibration.continuation",
                 strokes.size() + plucks.size());
  return calibrate_to_the_bound(initial, strokes, plucks, options, clock);
}

}  // namespace modcal
