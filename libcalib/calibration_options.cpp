// Section "calibration": what it holds and which of its parts fit together.
#include <fmt/format.h>

#include <cmath>

#include "libcalib/calibration.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// Not under the schedule: these say nothing to a search over the parameters alone.
void require_nothing_known(const ParameterOptions& parameters) {
  const ParameterOptions plain;
  const UnknownsOptions& unknowns = parameters.unknowns;
  const auto require = [](bool unread, const char* key) {
    MODCAL_REQUIRE(!unread,
                   "{} is read by the joint likelihood's own stages alone: leave it out, or state "
                   "objective: joint_likelihood, optimizer: staged",
                   key);
  };
  require(!unknowns.fixed.empty(), "fixed");
  require(!unknowns.priors.empty(), "priors");
  require(!unknowns.correlations.empty(), "correlations");
  require(unknowns.per_record != plain.unknowns.per_record, "per_record");
  require(unknowns.damping_width != plain.unknowns.damping_width, "damping_width");
  require(!std::isnan(unknowns.damping_scatter), "damping_scatter");
  require(!std::isnan(parameters.law_width), "law_width");
}

}  // namespace

void CalibrationOptions::visit(OptionVisitor& visitor) {
  visitor("parameters", "what is free", parameters);
  visitor("objective", "what is minimized", objective);
  visitor("optimizer", "how it is minimized", optimizer);
  visitor("budget", "what the search may spend", budget);
  visitor("excitation_threshold",
          "modes with a smaller |phi_n(x_c)| are blind and keep their frequency",
          {.range = Range::closed(0.0, 1.0)}, excitation_threshold);
  support.visit(visitor);
}

Problem CalibrationOptions::problem(const ModelPoint& initial,
                                    std::vector<CalibrationRecord> records) const {
  return {initial, std::move(records), parameters, objective.make(), support, excitation_threshold};
}

bool CalibrationOptions::by_schedule() const {
  try {
    return optimizer.make()->needs().schedule;
  } catch (const InvalidInput&) {
    return false;  // whoever makes the optimizer is told why
  }
}

void CalibrationOptions::require_schedule() const {
  const std::string mismatch =
      optimizer.make()->explain_unsatisfied(objective.selected(), objective.make()->capabilities());
  MODCAL_REQUIRE(mismatch.empty(), "{}", mismatch);
  MODCAL_REQUIRE(by_schedule(),
                 "standard deviations are wanted, which the joint likelihood's own stages find: "
                 "state objective: joint_likelihood, optimizer: {{type: {}}}",
                 "staged");
  require_read(1);
}

void CalibrationOptions::require_read(std::size_t strokes, std::size_t plucks) const {
  if (!by_schedule()) {
    MODCAL_REQUIRE(strokes + plucks == 1,
                   "{} records are fitted together by the joint likelihood's own stages alone: "
                   "state objective: joint_likelihood, optimizer: staged",
                   strokes + plucks);
    require_nothing_known(parameters);
    return;
  }
  MODCAL_REQUIRE(parameters.law && parameters.modes.empty(),
                 "the stages of the joint likelihood free the law and no frequency or all of them: "
                 "state parameters: {{frequencies: all, law: true, contact: true}}, and what is "
                 "known of single ones as fixed: [{{parameter: {}, value: ...}}]",
                 parameters.modes.empty() ? "f_1" : fmt::format("f_{}", parameters.modes.front()));
  MODCAL_REQUIRE(parameters.contact || strokes == 1,
                 "contact: false holds the contact of one stroke, and there are {}: state contact: "
                 "true and the contacts that are known as fixed: [{{parameter: x_c 2, value: "
                 "...}}]",
                 strokes);
  parameters.unknowns.require_contacts(strokes);
}

CalibrationOptions calibration_to_the_bound() {
  CalibrationOptions options;
  options.parameters.unknowns.damping = "factor";
  return options;
}

CalibrationOptions calibration_of_the_paper() {
  return {.parameters = {.frequencies = "all"},
          .objective = Choice<Objective>("spectral_peak"),
          .optimizer = Choice<Optimizer>("mode_by_mode")};
}

}  // namespace modcal
