#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/calibration.hpp"
#include "libcalib/likelihood/records/likelihood_band.hpp"
#include "libcalib/parameters/stated_priors.hpp"
#include "libcalib/parameters/stiff_string_fit.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// What a search is free to change of all records, and what of it is held or not seen.
struct Names {
  std::vector<std::string> free;
  std::vector<std::string> blind;
  std::vector<HeldParameter> held;
};

// What is held of what was asked for. Of these the stages of a schedule alone know.
std::vector<HeldParameter> held_of(const Problem& problem, const ModelPoint& initial) {
  const UnknownsOptions& unknowns = problem.parameters.unknowns;
  if (unknowns.fixed.empty()) return {};
  const StatedPriors stated(unknowns, initial, problem.records.size());
  std::vector<HeldParameter> held;
  for (const FixedParameter& fixed : unknowns.fixed) {
    const ParameterName name = require_parameter(fixed.parameter, initial.basis.size());
    held.push_back({name, *stated.fixed(name)});
  }
  return held;
}

// Names of what further records have for themselves.
void add_own(const Problem& problem, const std::vector<std::string>& first,
             std::vector<std::string>& names) {
  for (std::size_t r = 1; r < problem.records.size(); ++r) {
    for (const std::string& text : first) {
      ParameterName name = *parse_parameter(text);
      const bool contact = name.kind == ParameterKind::kContact;
      if (!problem.parameters.unknowns.own(name)) continue;
      if (contact && problem.records[r].pluck) continue;
      name.record = r;
      names.push_back(text_of(name));
    }
  }
}

Names names_of(const Problem& problem, const ModelPoint& initial) {
  Names names{problem.parameters.names(initial.basis.size()), {}, held_of(problem, initial)};
  const std::vector<bool> excited = excited_modes(initial, problem.excitation_threshold);
  // What one record is blind to another may tell.
  for (std::size_t i = 0; problem.records.size() == 1 && i < excited.size(); ++i) {
    if (excited[i]) continue;
    const std::string name = fmt::format("f_{}", i + 1);
    if (std::erase(names.free, name) > 0) names.blind.push_back(name);
  }
  MODCAL_REQUIRE(!names.free.empty(),
                 "every parameter asked for is the frequency of a mode the contact does not excite "
                 "({}): nothing can be calibrated",
                 fmt::join(names.blind, ", "));
  add_own(problem, std::vector(names.free), names.free);
  for (const HeldParameter& held : names.held) {
    std::erase(names.free, text_of(held));
    std::erase(names.blind, text_of(held));
  }
  MODCAL_REQUIRE(!names.free.empty(),
                 "every parameter asked for is fixed: nothing can be calibrated; leave one of {} "
                 "fixed parameters free",
                 names.held.size());
  return names;
}

bool any_recorded(const Problem& problem) {
  return std::ranges::any_of(problem.records, &CalibrationRecord::recorded);
}

// What the sensors feel of the modes above the stated ones, where it belongs to the model.
void add_higher_modes(const Problem& problem, ModelPoint& initial) {
  const StringSupport support = problem.support.support(any_recorded(problem));
  if (!support.remainder) return;
  const StiffStringFit law = fit_stiff_string(frequencies_of(initial.basis));
  double highest = problem.objective->highest_frequency();
  if (std::isnan(highest)) highest = band_of_modes(initial.basis);
  initial.higher = HigherModeLaw::above(initial.basis, law.fundamental, law.inharmonicity, highest,
                                        support.bending);
  double widest = 0.0;
  for (const CalibrationRecord& record : problem.records) {
    widest = std::max(widest, likelihood_band(initial, problem.objective->highest_frequency(),
                                              record.data.sample_rate) /
                                  (2.0 * std::numbers::pi));
  }
  initial.higher->ringing = ringing_modes(initial.basis, widest);
}

// The problem with what is meant where nothing is stated of damping and sensors.
Problem with_defaults(Problem problem, const Optimizer& optimizer) {
  UnknownsOptions& unknowns = problem.parameters.unknowns;
  const bool to_the_bound = optimizer.needs().schedule && any_recorded(problem);
  if (!to_the_bound) {
    unknowns.require_found_by(optimizer.name(), optimizer.needs().schedule);
    unknowns = unknowns.of_simulations(problem.model.basis);
    return problem;
  }
  // What is stated of a record's ζ_n is seldom more than their order of magnitude.
  const ParameterOptions plain;
  double& range = problem.parameters.ranges.damping;
  const bool ratios = unknowns.damping == plain.unknowns.damping;
  if (ratios && range == plain.ranges.damping) range = 0.9;
  unknowns = unknowns.of_records(problem.records.front().data.sample_rate, problem.model.basis);
  return problem;
}

}  // namespace

std::vector<bool> excited_modes(const ModelPoint& point, double threshold) {
  std::vector<bool> excited;
  for (const double shape : point.basis.shape_at(point.contact)) {
    excited.push_back(std::abs(shape) >= threshold);
  }
  return excited;
}

BoundProblem bind(const Problem& stated, const Optimizer& optimizer) {
  Problem problem = with_defaults(stated, optimizer);
  ModelPoint initial = problem.model;
  const Sensor sensors = problem.parameters.unknowns.sensors();
  if (!sensors.alike()) initial.sensors = sensors;
  add_higher_modes(problem, initial);
  Names names = names_of(problem, initial);
  problem.model = initial;
  ParameterSet parameters(std::move(initial), names.free, problem.parameters.ranges,
                          problem.records.size(), names.held);
  auto function = problem.objective->bind(problem, parameters);
  return {std::move(problem), std::move(parameters), std::move(function), std::move(names.blind),
          std::move(names.held)};
}

}  // namespace modcal
