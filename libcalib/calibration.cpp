#include "libcalib/calibration.hpp"

#include <algorithm>

#include "libcalib/likelihood/records/likelihood_band.hpp"
#include "libcalib/optimizers/staged/continuation.hpp"
#include "libcalib/parameters/damping_choice.hpp"
#include "libcalib/parameters/stiff_string_fit.hpp"
#include "libcalib/problem/covariance.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

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
  const bool bounded = std::ranges::any_of(result.parameters, &CalibratedParameter::at_bound);
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
    if (parameters[i].kind == ParameterKind::kFrequency) modes[parameters[i].index].searched = true;
  }
  return modes;
}

// Sensors and damping of one record, `number` behind their names; damping: whether it is wanted.
void add_values(const RecordValues& values, const UnknownsOptions& unknowns,
                const std::string& number, bool all, std::vector<CalibratedParameter>& parameters) {
  const auto add = [&](const ParameterName& name, bool free, double initial, double found,
                       double deviation) {
    if (!free || !(all || unknowns.own(name))) return;
    parameters.push_back({.name = text_of(name) + number,
                          .unit = std::string(type_of(name).unit),
                          .initial = initial,
                          .final = found,
                          .deviation = deviation});
  };
  add({ParameterKind::kDampingFactor}, damping_choice(unknowns.damping) != DampingChoice::kFixed,
      1.0, values.damping, values.damping_deviation);
  for (std::size_t i = 0; i < Sensor::kCount; ++i) {
    const ParameterName name{ParameterKind::kSensor, i};
    add(name, unknowns.sensor[i].free, unknowns.sensor[i].value, sensor_value(i, values.sensors),
        values.sensor_deviation[i]);
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

// Law, contacts, damping and sensors before and after; those of further records with their number.
std::vector<CalibratedParameter> found_parameters(const ModelPoint& initial,
                                                  const ContinuationResult& found,
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
      parameter("f0", "Hz", start.fundamental, found.found_law.fundamental,
                found.found_law.deviation[0]),
      parameter("B", "1", start.inharmonicity, found.found_law.inharmonicity,
                found.found_law.deviation[1]),
      parameter("x_c", "m", initial.contact, found.model.contact, found.contact_deviation)};
  add_values(found.values.front(), unknowns, "", true, parameters);
  if (!found.ratio_deviations.empty()) {
    const std::string factor = text_of({ParameterKind::kDampingFactor});
    std::erase_if(parameters, [&](const CalibratedParameter& p) { return p.name == factor; });
  }
  add_damping(initial, found, parameters);
  for (std::size_t r = 1; r < found.values.size(); ++r) {
    const std::string number = fmt::format(" {}", r + 1);
    if (r < found.contacts.size() && unknowns.own({ParameterKind::kContact})) {
      parameters.push_back(parameter("x_c" + number, "m", initial.contact, found.contacts[r],
                                     found.contact_deviations[r]));
    }
    add_values(found.values[r], unknowns, number, false, parameters);
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

// What the search of a schedule found.
void report_estimate(const Problem& problem, const std::vector<Variable>& variables,
                     CalibrationResult& result) {
  result.continuation = result.search.estimate;
  const ContinuationResult& found = *result.continuation;
  result.model = found.model;
  result.parameters = found_parameters(problem.model, found, problem.parameters.unknowns);
  ParameterRanges ranges = problem.parameters.ranges;
  for (CalibratedParameter& parameter : result.parameters) {
    const auto name = parse_parameter(parameter.name);
    const auto of = std::ranges::find(variables, parameter.name, &Variable::name);
    const bool is_variable = of != variables.end();
    // The factor of all ratios is none where every ratio is, but what the law's stage searches.
    if (!is_variable && (!name || name->kind != ParameterKind::kDampingFactor)) continue;
    // A damping ratio may be as many times larger as smaller, and nothing lies below the 0 of what
    // can only rise; bounds of logarithms come back with their rounding.
    const ParameterType& type = type_of(*name);
    const bool ratio = type.moves == Moves::kDamping && type.range_kind == RangeKind::kShare;
    const double lower = is_variable ? of->lower : parameter.initial * (1.0 - type.range(ranges));
    const double upper = ratio ? parameter.initial * parameter.initial / lower : of->upper;
    const double margin = 1e-9 * (upper - lower);
    const bool low = type.range_kind != RangeKind::kRise && parameter.final <= lower + margin;
    parameter.at_bound = low || parameter.final >= upper - margin;
  }
  result.modes = found_modes(problem.model, found, problem.excitation_threshold);
}

}  // namespace

CalibrationResult calibrate(const Problem& stated_problem, const Optimizer& optimizer,
                            const Budget& budget, SecondsClock clock) {
  BoundProblem bound = bind(stated_problem, optimizer);
  const Problem& problem = bound.problem;
  const std::vector<Variable> variables = bound.parameters.variables();
  CalibrationResult result;
  result.search = optimizer.minimize(*bound.function, variables, budget, std::move(clock));
  if (result.search.estimate) {
    report_estimate(problem, variables, result);
    return result;
  }
  result.blind = std::move(bound.blind);
  result.model = bound.parameters.model(result.search.x);
  result.parameters = report_parameters(variables, result.search.x);
  result.modes =
      report_modes(bound.parameters, result.model,
                   excited_modes(bound.parameters.initial(), problem.excitation_threshold));
  add_deviations(*problem.objective, *bound.function, variables, result);
  return result;
}

CalibrationResult calibrate(const ModelPoint& initial, std::vector<CalibrationRecord> records,
                            const CalibrationOptions& options, SecondsClock clock) {
  const auto plucks = static_cast<std::size_t>(
      std::count_if(records.begin(), records.end(),
                    [](const CalibrationRecord& record) { return record.pluck; }));
  MODCAL_REQUIRE(plucks < records.size(), "a calibration needs at least {} stroke", 1);
  options.require_read(records.size() - plucks, plucks);
  return calibrate(options.problem(initial, std::move(records)), *options.optimizer.make(),
                   options.budget, std::move(clock));
}

CalibrationResult calibrate(const ModelPoint& initial, const CalibrationData& data,
                            const CalibrationOptions& options, SecondsClock clock) {
  return calibrate(initial, std::vector<CalibrationRecord>{{.data = data}}, options,
                   std::move(clock));
}

}  // namespace modcal
