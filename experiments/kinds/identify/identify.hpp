// Kind "identify": a plucked string, its modes with error bars.
#pragma once

#include "experiments/experiment.hpp"
#include "libcalib/parameters/stiff_string_fit.hpp"
#include "libinverse/modes/pluck_identification.hpp"

namespace modcal {

struct IdentifyOptions {
  static constexpr std::string_view kForStructures =
      "identify finds the modes of a plucked string from the reactions at its ends; for those of "
      "any other structure state kind: fit_modes with a record of responses and force";
  TruthOptions truth;
  Measurement measurement;
  PluckOptions identification;
  std::int64_t seed = 1;
  void visit(OptionVisitor& visitor);

  std::vector<Finding> lint() const;
  std::vector<PlanLine> plan() const;
  std::optional<PlannedSimulations> planned_simulations() const;
  StudyResult run(const StudyContext& context) const;
};

struct IdentifyOutcome {
  PluckIdentification found;
  std::shared_ptr<const Truth> truth;
  /// Law through the frequencies, weighted by their deviations where they have some; empty with
  /// fewer than two modes.
  std::optional<StiffStringFit> law;
  /// Modes, law and noise.
  void visit(ResultVisitor& visitor) const;
};

/// Simulates, measures and identifies.
IdentifyOutcome identify_outcome(const IdentifyOptions& options, const StudyContext& context);

/// Poles over the order of the realization, stable ones apart.
report::Figure stabilization_figure(const IdentifyOutcome& outcome);

}  // namespace modcal
