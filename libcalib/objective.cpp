#include "libcalib/objective.hpp"

#include <optional>
#include <vector>

#include "libcalib/problem.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

// Frequencies and contact are what every objective was made for.
Response Objective::response(Moves what) const {
  if (what == Moves::kDamping) return Response::kRefused;
  return what == Moves::kSensor ? Response::kNone : Response::kMoves;
}

void Objective::require_record(const ModalBasis& /*basis*/, double /*sample_rate*/,
                               std::size_t /*samples*/) const {}

void Objective::require_moved_by(std::span<const std::string> names) const {
  for (const std::string& name : names) {
    const std::optional<ParameterName> parsed = parse_parameter(name);
    if (!parsed) continue;
    const Response response = this->response(type_of(*parsed).moves);
    MODCAL_REQUIRE(response != Response::kNone,
                   "the objective does not depend on {}: fix it, or add an objective that does "
                   "(joint_likelihood sees every parameter) in a weighted_sum",
                   name);
    MODCAL_REQUIRE(
        response != Response::kRefused,
        "the objective takes damping as it is stated and cannot find {}: fix it, or take "
        "joint_likelihood",
        name);
  }
}

std::unique_ptr<const ObjectiveFunction> Objective::bind(const CalibrationData& data,
                                                         const ParameterSet& parameters) const {
  std::vector<std::string> names;
  for (const Variable& variable : parameters.variables()) names.push_back(variable.name);
  require_moved_by(names);
  return bind_term(data, parameters);
}

std::unique_ptr<const ObjectiveFunction> Objective::bind(const Problem& problem,
                                                         const ParameterSet& parameters) const {
  MODCAL_REQUIRE(!problem.records.empty(), "a calibration needs at least {} stroke", 1);
  return bind_problem(problem, parameters);
}

std::unique_ptr<const ObjectiveFunction> Objective::bind_problem(
    const Problem& problem, const ParameterSet& parameters) const {
  MODCAL_REQUIRE(problem.records.size() == 1 && !problem.records.front().pluck,
                 "{} records are fitted together by the joint likelihood alone: state objective: "
                 "joint_likelihood, optimizer: staged",
                 problem.records.size());
  return bind(problem.records.front().data, parameters);
}

std::unique_ptr<const ObjectiveFunction> Objective::bind_term(
    const CalibrationData& data, const ParameterSet& parameters) const {
  data.require_valid();
  data.require_motion();
  const ModalBasis& basis = parameters.initial().basis;
  for (std::size_t n = 0; n < basis.size(); ++n) {
    MODCAL_REQUIRE(basis.zeta[n] > 0.0,
                   "mode {} has damping ratio {:g}: without damping its response has no bound on "
                   "the frequency axis; give it a ratio > 0",
                   n + 1, basis.zeta[n]);
    MODCAL_REQUIRE(basis.frequency(n) < 0.5 * data.sample_rate,
                   "mode {} at {:g} Hz lies above the Nyquist frequency {:g} Hz of the data: take "
                   "fewer modes",
                   n + 1, basis.frequency(n), 0.5 * data.sample_rate);
  }
  return do_bind(data, parameters);
}

}  // namespace modcal
